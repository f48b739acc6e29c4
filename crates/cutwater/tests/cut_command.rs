//! Output, files and exit codes of `cutwater cut`.

use std::path::PathBuf;
use std::process::{Command, Output};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn cut(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cutwater")).arg("cut").args(arguments).output().expect("the binary starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn surface(name: &str, content: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).expect("a file");
    path.display().to_string()
}

#[test]
fn json_is_one_object_with_the_promised_keys() {
    let path = surface("json.obj", TETRAHEDRON);
    let output = cut(&[&path, "--grid", "5", "--rotate", "1", "--shift", "2", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let mut rest = printed.as_str();
    let keys = "cells cut_cells covered_cells parts_max domain_volume fluid_volume solid_volume surface_area \
                smallest_fraction seconds classify clip quadrature total max_relative_error partition normals divergence \
                adjacency";
    for key in keys.split(' ') {
        let quoted = format!("\"{key}\":");
        let at = rest.find(&quoted).unwrap_or_else(|| panic!("{key} in {printed}"));
        rest = &rest[at + quoted.len()..];
    }
    assert!(printed.starts_with("{\"cells\":750,") && printed.trim_end().ends_with("}}"), "{printed}");
}

#[test]
fn the_table_has_volumes_and_files_are_written() {
    let path = surface("table.obj", TETRAHEDRON);
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cut-files");
    let output = cut(&[&path, "--grid", "3", "--out", &directory.display().to_string()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    assert!(printed.contains("solid 0.1666") && printed.contains("partition"), "{printed}");
    assert!(["fluid.vtu", "body.vtu", "interface.vtu"].iter().all(|name| directory.join(name).exists()));
}

#[test]
fn what_cannot_be_cut_exits_with_2_and_names_the_place() {
    let sound = surface("sound.obj", TETRAHEDRON);
    let open = surface("open.obj", &TETRAHEDRON.replace("f 2 3 4\n", ""));
    let nan = surface("nan.obj", &TETRAHEDRON.replace("v 1 0 0", "v nan 0 0"));
    let inward = surface("inward.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    for (arguments, part) in [
        (vec![open.as_str(), "--grid", "3"], "open.obj: body 0: the surface is open at facet"),
        (vec![&sound, &open, "--grid", "3"], "open.obj (body 1)"),
        (vec![&nan, "--grid", "3"], "nan.obj: line 2"),
        (vec![&inward, "--grid", "3"], "inwards"),
        (vec!["no-such.stl", "--grid", "3"], "no-such.stl"),
        (vec![&sound, "--grid", "0"], "`--grid` from 1 to 150"),
        (vec![&sound, "--grid", "151"], "`--grid` from 1 to 150"),
        (vec![&sound, "--background", &sound], "sound.obj: its name must end in"),
        (vec![&sound, "--grid", "three"], "three"),
        (vec![&sound], "--grid"),
        (vec![&sound, "--grid", "3", "--background", "m.vtu"], "cannot be used with"),
        (vec!["--grid", "3"], "SURFACE"),
    ] {
        let output = cut(&arguments);
        let printed = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
        assert!(printed.contains(part) && !printed.contains("panicked"), "{arguments:?}: {printed}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(cut(&[&inward, "--grid", "3", "--flip"]).status.code(), Some(0));
}
