//! Output, files and exit codes of `cutwater mesh`.

use std::process::Output;

use crate::setting::{self, cutwater, fresh, succeeded, text};

/// A rectangle of two triangles, one of them turned, with groups; a third triangle apart from it.
const SQUARE: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "wall"
2 2 "soft"
$EndPhysicalNames
$Nodes
7
1 0 0 0
2 2 0 0
3 2 1 0
4 0 1 0
5 5 0 0
6 6 0 0
7 5 1 0
$EndNodes
$Elements
5
1 1 2 1 1 1 2
2 1 2 1 1 2 3
3 2 2 2 1 1 2 3
4 2 2 2 1 1 4 3
5 2 2 0 2 5 6 7
$EndElements
"#;

fn mesh(arguments: &[&str]) -> Output {
    cutwater(&[&["mesh"], arguments].concat())
}

fn path(name: &str) -> String {
    fresh("mesh", name).display().to_string()
}

fn file(name: &str, content: &str) -> String {
    setting::file("mesh", name, content)
}

#[test]
fn info_prints_counts_sizes_quality_and_groups() {
    let printed = succeeded(&mesh(&["info", &file("square.msh", SQUARE)]));
    let expected = "\
dimension   2
elements    3 triangles of order 1, in 2 connected parts
vertices    7
area        2.500000e0
x           0.000000e0 to 6.000000e0
y           0.000000e0 to 1.000000e0
edges       1.000e0 to 2.236e0, mean 1.543e0
quality     smallest 0.693, mean 0.751; 1 for regular cells, 0 for flat ones
cells       (no group): 1 elements, area 5.000000e-1
cells       `soft`: 2 elements, area 2.000000e0
boundary    (no group): 5 elements, length 6.414214e0
boundary    `wall`: 2 elements, length 3.000000e0
note        1 cells had a negative volume; the order of their nodes was reversed
";
    assert_eq!(printed, expected);
    let open = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    let output = mesh(&["info", &file("open.obj", open)]);
    let printed = text(&output.stdout);
    assert!(printed.contains("3 triangles of a surface") && printed.contains("3 sides of the surface"), "{printed}");
}

#[test]
fn convert_writes_the_same_mesh() {
    let square = file("convert.msh", SQUARE);
    for (name, options, begin) in [
        ("a.msh", &["--binary"][..], "$MeshFormat\n4.1 1 8\n"),
        ("b.msh", &["--version", "2.2"], "$MeshFormat\n2.2 0 8\n"),
        ("c.msh", &[], "$MeshFormat\n4.1 0 8\n"),
    ] {
        let converted = path(name);
        let output = mesh(&[&["convert", &square, &converted][..], options].concat());
        succeeded(&output);
        assert_eq!(text(&output.stdout), "");
        let [before, after] = [&square, &converted].map(|file| text(&mesh(&["info", file]).stdout));
        assert!(before.starts_with(&after) && !after.is_empty(), "{before}\n{after}");
        assert!(std::fs::read(converted).expect("a file").starts_with(begin.as_bytes()));
    }
    let tetrahedron = file("closed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    let surface = path("closed.stl");
    assert_eq!(mesh(&["convert", &tetrahedron, &surface]).status.code(), Some(0));
    assert!(text(&mesh(&["info", &surface]).stdout).contains("volume      1.666667e-1"));
    let vtu = path("square.vtu");
    let output = mesh(&["convert", &square, &vtu]);
    succeeded(&output);
    assert!(text(&output.stdout).contains("only .msh files contain groups"));
    let info = text(&mesh(&["info", &vtu]).stdout);
    assert!(info.contains("3 triangles of order 1") && info.contains("area        2.500000e0"), "{info}");
}

#[test]
fn files_that_cannot_be_used_are_refused() {
    let folded = file("folded.msh", &SQUARE.replace("4 0 1 0", "4 1.9 0.1 0"));
    for (name, words) in
        [("no-such-file.msh", "cannot read no-such-file.msh"), (&folded, "elements 3 and 4 lie on the same side")]
    {
        let output = mesh(&["info", name]);
        let error = text(&output.stderr);
        assert!(output.status.code() == Some(2) && error.contains(words), "{error}");
    }
}

/// A triangle of order 2 with straight edges, whose last node is the middle of the edge from the third corner to the
/// first.
const CURVED: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
6
1 0 0 0
2 2 0 0
3 0 2 0
4 1 0 0
5 1 1 0
6 0 1 0
$EndNodes
$Elements
1
1 9 2 0 1 1 2 3 4 5 6
$EndElements
"#;

#[test]
fn info_notes_cells_that_are_folded_by_their_edges() {
    for (node, is_folded) in [("1 0", false), ("1 0.3", false), ("1 1.2", true), ("1 -0.3", false), ("1.9 0", true)] {
        let moved = CURVED.replace("4 1 0 0", &format!("4 {node} 0"));
        let output = mesh(&["info", &file("curved.msh", &moved)]);
        let printed = text(&output.stdout);
        assert!(printed.contains("1 triangles of order 2"), "{printed}{}", text(&output.stderr));
        let note = "note        1 cells of order 2 are folded by their curved edges, the first one near [0.66";
        assert_eq!(printed.contains(note), is_folded, "{node}: {printed}");
    }
}
