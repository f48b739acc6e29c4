//! Output, files and exit codes of `cutwater cut`.

use std::process::Output;

use crate::setting::{cutwater, file, fresh, succeeded, text};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn cut(arguments: &[&str]) -> Output {
    cutwater(&[&["cut"], arguments].concat())
}

fn surface(name: &str, content: &str) -> String {
    file("cut", name, content)
}

#[test]
fn json_is_one_object_with_the_promised_keys() {
    let path = surface("json.obj", TETRAHEDRON);
    let printed = succeeded(&cut(&[&path, "--grid", "5", "--rotate", "1", "--shift", "2", "--json"]));
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
    let directory = fresh("cut", "files");
    let printed = succeeded(&cut(&[&path, "--grid", "3", "--out", &directory.display().to_string()]));
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
        (vec!["no-such.stl", "--grid", "3"], "no-such.stl"),
        (vec![&sound, "--grid", "151"], "`--grid` from 1 to 150"),
        (vec![&sound, "--background", &sound], "sound.obj: its name must end in"),
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

/// Returns the summary of a cut, as text.
fn summary(path: &str, more: &[&str]) -> String {
    let output = cut(&[&[path, "--json"], more].concat());
    succeeded(&output)
}

fn number(summary: &str, key: &str) -> f64 {
    let (_, rest) = summary.split_once(&format!("\"{key}\":")).expect("the key");
    rest.split([',', '}']).next().and_then(|number| number.parse().ok()).expect("a number")
}

fn scaled(factor: f64, shift: f64) -> String {
    let vertex = |x: [f64; 3]| {
        let [a, b, c] = x.map(|x| factor * x + shift);
        format!("v {a:e} {b:e} {c:e}\n")
    };
    let vertices: String =
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().map(vertex).collect();
    vertices + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
}

#[test]
fn the_volume_of_a_small_body_in_a_large_box_is_accurate() {
    // One cube of six tetrahedra, from -10 to 140 along each axis.
    let corners: Vec<String> = (0..8)
        .map(|k| (0..3).map(|axis| if k >> axis & 1 == 0 { "-10" } else { "140" }).collect::<Vec<_>>().join(" "))
        .collect();
    let cells = ["0 1 3 7", "0 1 7 5", "0 5 7 4", "0 3 2 7", "0 2 6 7", "0 6 4 7"];
    let lines: String = cells.iter().map(|cell| format!("4 {cell}\n")).collect();
    let vtk = format!(
        "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{}\nCELLS 6 30\n{lines}CELL_TYPES 6\n{}",
        corners.join("\n"),
        "10\n".repeat(6),
    );
    let box_mesh = file("cut", "large-box.vtk", &vtk);
    for size in [1.0, 1e-3, 3e-4] {
        let path = surface("small.obj", &scaled(size, 37.0));
        let found = number(&summary(&path, &["--background", &box_mesh]), "solid_volume");
        let exact = size.powi(3) / 6.0;
        // Coordinates have round-off relative to 37.
        let room = 20.0 * 37.0 * f64::EPSILON / size;
        assert!((found - exact).abs() <= room.max(1e-12) * exact, "{size}: {found:e}, exact {exact:e}");
    }
}

#[test]
fn volumes_of_very_large_and_very_small_surfaces_are_right_or_refused() {
    let is_right_or_refused = |content: &str, volume: f64, room: f64| {
        let output = cut(&[&surface("scaled.obj", content), "--grid", "3", "--json"]);
        if output.status.code() == Some(0) {
            let found = number(&text(&output.stdout), "solid_volume");
            assert!((found / volume - 1.0).abs() < room, "{volume:e}: {found:e}\n{content}");
        } else {
            let printed = text(&output.stderr);
            let is_other = printed.contains("panicked") || printed.contains("report");
            assert!(printed.starts_with("error: ") && !is_other, "{printed}\n{content}");
        }
    };
    for exponent in [-110, -80, -20, 20, 80, 101, 110, 200, 300] {
        let factor = 10_f64.powi(exponent);
        is_right_or_refused(&scaled(factor, 0.0), factor * factor * factor / 6.0, 1e-9);
    }
    for shift in [1e6, 1e8, 1e11, 1e13, 1e14, 1e17] {
        is_right_or_refused(&scaled(1.0, shift), 1.0 / 6.0, 1e-9_f64.max(10.0 * shift * f64::EPSILON));
    }
}

#[test]
fn shells_that_cross_are_refused_in_every_position() {
    let vertices = |shift: f64| scaled(1.0, shift).split_inclusive('\n').take(4).collect::<String>();
    let faces = |first: usize| {
        let numbers = [[1, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]];
        numbers.map(|f| format!("f {} {} {}\n", f[0] + first, f[1] + first, f[2] + first)).concat()
    };
    let path = surface("shells.obj", &(vertices(0.0) + &vertices(0.1) + &faces(0) + &faces(4)));
    for seed in 0..20 {
        let output = cut(&[&path, "--grid", "4", "--rotate", &seed.to_string()]);
        let printed = text(&output.stderr);
        assert!(output.status.code() == Some(2) && printed.contains("shells.obj"), "{seed}: {printed}");
    }
}
