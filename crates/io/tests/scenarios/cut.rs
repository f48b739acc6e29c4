//! Surfaces from files laid over grids and meshes: exact volumes and areas, and errors.

use std::path::Path;

use crate::setting::write;
use io::Error;
use io::cut::{BackgroundSource, CutErrors, CutSettings, CutSummary, cut_files, read_tetrahedra};

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
/// The unit cube in six tetrahedra, the last one inside out, with a triangle that does not count.
const MESH: &str = "# vtk DataFile Version 3.0\na cube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n\
    0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    CELLS 7 34\n3 0 1 3\n4 0 1 3 7\n4 0 5 1 7\n4 0 3 2 7\n4 0 2 6 7\n4 0 4 5 7\n4 0 4 6 7\n\
    CELL_TYPES 7\n5\n10\n10\n10\n10\n10\n10\n";

fn grid(n: usize) -> CutSettings {
    CutSettings::new(BackgroundSource::Grid(n))
}

fn check_errors(errors: &CutErrors) {
    let CutErrors { partition, normals, divergence, adjacency, .. } = *errors;
    assert!([partition, normals, divergence, adjacency].iter().all(|&e| (0.0..1e-12).contains(&e)), "{errors:?}");
}

/// Checks volumes and areas of a cut, and that all identities hold.
fn check(summary: &CutSummary, domain: f64, solid: f64, area: f64) {
    assert!((summary.domain_volume - domain).abs() < 1e-13 * domain, "{summary:?}");
    assert!((summary.solid_volume - solid).abs() < 1e-12 * domain, "{summary:?}");
    assert!((summary.surface_area - area).abs() < 1e-12 * area, "{summary:?}");
    check_errors(&summary.max_relative_error);
}

#[test]
fn a_cube_and_a_tetrahedron_have_their_volumes_and_areas_wherever_they_lie() {
    let (cube, tetrahedron) = (write("cube.obj", CUBE), write("tetrahedron-to-cut.obj", TETRAHEDRON));
    for (path, volume, area) in [(&cube, 1.0, 6.0), (&tetrahedron, 1.0 / 6.0, 1.5 + 0.75_f64.sqrt())] {
        // A cube in a grid of twelve lies on its faces; in seven it does not.
        for n in [7, 12] {
            for (rotate, shift) in [(None, None), (Some(1), None), (None, Some(2)), (Some(3), Some(4))] {
                let settings = CutSettings { rotate, shift, ..grid(n) };
                let result = cut_files(&[path], &settings).expect("a cut");
                assert_eq!(result.summary.cells, 6 * n.pow(3));
                let domain = result.summary.domain_volume;
                check(&result.summary, domain, volume, area);
                if rotate.is_none() {
                    assert!((domain - 1.2_f64.powi(3)).abs() < 1e-12, "{domain}");
                }
            }
        }
    }
}

#[test]
fn seeds_place_the_surface_and_nothing_else_does() {
    let cube = write("seeds.obj", CUBE);
    let at = |rotate, shift| {
        let settings = CutSettings { rotate: Some(rotate), shift: Some(shift), ..grid(6) };
        cut_files(&[&cube], &settings).expect("a cut").surfaces[0].positions().to_vec()
    };
    assert_eq!(at(1, 1), at(1, 1));
    assert_ne!(at(1, 1), at(2, 1));
    assert_ne!(at(1, 1), at(1, 2));
}

#[test]
fn a_background_may_be_a_file_and_bodies_may_overlap_and_stick_out() {
    let mesh = write("cube.vtk", MESH);
    let background = read_tetrahedra(&mesh).expect("a mesh");
    assert_eq!((background.n_cells(), background.n_vertices()), (6, 8));
    let settings = CutSettings::new(BackgroundSource::File(mesh));
    let moved = |name: &str, factor: f64, shift: f64| {
        let mut text = String::new();
        for line in CUBE.lines() {
            match line.strip_prefix("v ") {
                Some(x) => {
                    let x = x.split(' ').map(|c| factor * c.parse::<f64>().expect("a number") + shift);
                    text.push_str(&format!("v {}\n", x.map(|c| c.to_string()).collect::<Vec<_>>().join(" ")));
                }
                None => text.push_str(&format!("{line}\n")),
            }
        }
        write(name, &text)
    };
    let (inside, sticking, across) = (moved("a.obj", 0.5, 0.25), moved("b.obj", 0.5, 0.75), moved("c.obj", 0.5, 0.5));
    check(&cut_files(&[&inside], &settings).expect("a cut").summary, 1.0, 0.125, 1.5);
    let corner = 0.25_f64;
    check(&cut_files(&[&sticking], &settings).expect("a cut").summary, 1.0, corner.powi(3), 3.0 * corner.powi(2));
    // One in the other, twice the same, and two that overlap in a corner of the first.
    check(&cut_files(&[&inside, &inside], &settings).expect("a cut").summary, 1.0, 0.125, 1.5);
    let union = cut_files(&[&inside, &across], &settings).expect("a cut");
    check(&union.summary, 1.0, 0.25 - corner.powi(3), 1.5 - 3.0 * corner.powi(2) + 0.75 - 3.0 * corner.powi(2));
    let bodies: Vec<u32> = union.cut.interface().iter().map(|piece| piece.body.0).collect();
    assert!(bodies.contains(&0) && bodies.contains(&1));
    // Everything is covered, or nothing.
    let all = cut_files(&[moved("d.obj", 4.0, -1.0)], &settings).expect("a cut").summary;
    assert_eq!((all.covered_cells, all.fluid_volume, all.surface_area), (6, 0.0, 0.0));
    check_errors(&all.max_relative_error);
    let nothing = cut_files(&[moved("e.obj", 1.0, 7.0)], &settings).expect("a cut").summary;
    assert_eq!((nothing.cut_cells, nothing.solid_volume, nothing.smallest_fraction), (0, 0.0, 1.0));
    check_errors(&nothing.max_relative_error);
}

#[test]
fn field_files_are_read_back_as_meshes_of_the_same_volumes() {
    let result =
        cut_files(&[write("fields.obj", TETRAHEDRON)], &CutSettings { rotate: Some(5), ..grid(4) }).expect("a cut");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cut/fields");
    result.write_vtk(&folder).expect("files");
    let volume = |name: &str| {
        let piece = read_tetrahedra(&folder.join(name));
        piece.map(|mesh| mesh.cells().map(|cell| mesh.cell_volume(cell)).sum::<f64>())
    };
    let (fluid, body) = (volume("fluid.vtu").expect("tetrahedra"), volume("body.vtu").expect("tetrahedra"));
    assert!((fluid - result.summary.fluid_volume).abs() < 1e-12, "{fluid}");
    assert!((body - 1.0 / 6.0).abs() < 1e-12, "{body}");
    // An array that is shorter than it says.
    let text = std::fs::read_to_string(folder.join("fluid.vtu")).expect("text");
    let end = text.find("</DataArray>").expect("an array");
    let damaged = write("short.vtu", format!("{}{}", &text[..end - 8], &text[end..]));
    assert!(matches!(read_tetrahedra(&damaged), Err(Error::MeshFile { .. })));
    // Triangles only.
    assert!(matches!(volume("interface.vtu"), Err(Error::MeshFile { .. })));
}

#[test]
fn what_cannot_be_cut_is_refused_with_file_body_and_place() {
    let cube = write("sound.obj", CUBE);
    let inward = write(
        "inward.obj",
        TETRAHEDRON
            .replace("f 1 3 2", "f 1 2 3")
            .replace("f 1 2 4", "f 1 4 2")
            .replace("f 1 4 3", "f 1 3 4")
            .replace("f 2 3 4", "f 2 4 3"),
    );
    for (name, content, parts) in [
        ("open.obj", TETRAHEDRON.replace("f 2 3 4\n", ""), ["body 1", "open at facet", "0.0]"]),
        ("empty.obj", "v 0 0 0\n".to_owned(), ["body 1", "without facets", ""]),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n".to_owned(), ["body 1", "without facets", ""]),
        ("nan.obj", TETRAHEDRON.replace("v 1 0 0", "v 1 nan 0"), ["line 2", "not finite", ""]),
        ("huge.obj", TETRAHEDRON.replace("v 1 0 0", "v 1e400 0 0"), ["line 2", "not finite", ""]),
    ] {
        let path = write(name, &content);
        let message = cut_files(&[&cube, &path], &grid(3)).expect_err("refused").to_string();
        assert!(parts.iter().all(|part| message.contains(part)) && message.contains(name), "{message}");
    }
    let message = cut_files(&[&inward], &grid(3)).expect_err("inward").to_string();
    assert!(message.contains("inward.obj") && message.contains("inwards"), "{message}");
    let flipped = cut_files(&[&inward], &CutSettings { flip: true, ..grid(3) }).expect("a cut").summary;
    check(&flipped, 1.2_f64.powi(3), 1.0 / 6.0, 1.5 + 0.75_f64.sqrt());
    assert!(matches!(cut_files(&[&cube], &grid(0)), Err(Error::GridSize { n: 0, .. })));
    assert!(matches!(cut_files(&[&cube], &grid(1 << 40)), Err(Error::GridSize { .. })));
    let wide = write("wide.obj", CUBE.replace('1', "1e308"));
    assert!(cut_files(&[&wide], &grid(2)).is_err());
}

#[test]
fn malformed_meshes_are_refused_with_their_file() {
    for (name, content, part) in [
        ("a.msh", MESH.to_owned(), ".vtu or .vtk"),
        ("b.vtk", "hello".to_owned(), ""),
        ("c.vtk", MESH.replace("4 0 4 6 7", "4 0 4 6 8"), "contradict"),
        ("d.vtk", MESH.replace("4 0 4 6 7", "9 0 4 6 7"), "contradict"),
        ("e.vtk", MESH.replace("10\n", "12\n"), "no tetrahedron"),
        ("f.vtk", MESH.replace("10\n", "5\n"), "no tetrahedra"),
        ("g.vtk", MESH.replace("1 1 1\n", "0 0 0\n"), "volume"),
        ("h.vtk", MESH.replace("1 1 1\n", "nan 1 1\n"), ""),
        ("i.vtk", MESH.replace("UNSTRUCTURED_GRID", "POLYDATA"), ""),
        ("j.vtk", MESH[..MESH.len() / 2].to_owned(), ""),
        ("k.vtu", "<VTKFile>".to_owned(), ""),
        ("l.vtu", String::new(), ""),
    ] {
        let message = read_tetrahedra(&write(name, &content)).expect_err(name).to_string();
        assert!(message.contains(part) && message.contains(name), "{message}");
    }
    assert!(matches!(read_tetrahedra(Path::new("no/such.vtu")), Err(Error::Read { .. })));
}
