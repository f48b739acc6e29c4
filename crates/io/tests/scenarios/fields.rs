//! Field files with the fields that a scenario chooses, compared with values that are known.

use crate::setting::*;
use vtkio::model::{Attribute, UnstructuredGridPiece};

/// An elastic block of unit size on rollers, in equilibrium at every step.
const BLOCK: &str = r#"
name      = "block"
dimension = 2
units     = "si"

[time]
step   = 0.5
end    = 1.0
scheme = "quasi-static"

[[body]]
name     = "block"
shape    = { kind = "box", min = [0.0, 0.0], max = [1.0, 1.0], n = [3, 2] }
material = { kind = "saint-venant-kirchhoff", mu = 4.0e5, lambda = 1.6e6 }
density  = 1000.0
gravity  = [0.0, 0.0]
boundary = { left = "symmetry" }

[output]
vtk_every = 2

[solver]
newton = { tolerance = 1.0e-10 }
linear = "direct"
"#;

fn field(attributes: &[Attribute], name: &str) -> Option<Vec<f64>> {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    })?;
    Some(array.data.clone().cast_into().expect("numbers"))
}

fn cell_field(grid: &UnstructuredGridPiece, name: &str) -> Vec<f64> {
    field(&grid.data.cell, name).unwrap_or_else(|| panic!("no field {name}"))
}

fn points(grid: &UnstructuredGridPiece) -> Vec<f64> {
    grid.points.cast_into().expect("numbers")
}

/// Returns the vertices of each cell with two of them.
fn edges(grid: &UnstructuredGridPiece) -> Vec<[usize; 2]> {
    let (connectivity, _) = grid.cells.cell_verts.clone().into_xml();
    connectivity.chunks_exact(2).map(|edge| [edge[0] as usize, edge[1] as usize]).collect()
}

fn assert_close(found: f64, expected: f64, tolerance: f64, name: &str) {
    assert!((found - expected).abs() <= tolerance, "{name}: {found}, expected {expected}");
}

#[test]
fn principal_stresses_of_a_stretched_block() {
    let directory = fresh_directory("stretched");
    // A dead load on the undeformed surface, which stretches the block by more than a tenth.
    let (mu, lambda, load) = (4e5, 1.6e6, 2e5);
    let boundary = "body.0.boundary={ left = \"symmetry\", bottom = \"symmetry\", right = { kind = \"traction\", value = [\"2.0e5*t\", 0.0] } }";
    results(&legal(BLOCK, &[&[boundary]]), &directory);
    let grid = read_grid(&directory.join("vtk/solid_000002.vtu"));
    let (x, displacement) = (points(&grid), field(&grid.data.point, "displacement").expect("a displacement"));
    let corner =
        x.chunks_exact(3).zip(displacement.chunks_exact(3)).map(|(x, d)| [x[0] - d[0], x[1] - d[1], d[0], d[1]]);
    let corner = corner.into_iter().find(|c| (c[0] - 1.0).abs() + (c[1] - 1.0).abs() < 1e-12).expect("the corner");
    let (along, across) = (1.0 + corner[2], 1.0 + corner[3]);
    assert!(along > 1.1 && across < 1.0, "{along} {across}");
    // The first Piola-Kirchhoff stress is the load; the Cauchy stress is `P Fᵀ / det F`. The stress across the plane
    // follows from `S = λ tr(E) I`.
    let volume = along * across;
    let out_of_plane = lambda * 0.5 * (along * along + across * across - 2.0) / volume;
    let expected = [load / across, out_of_plane, 0.0];
    assert_close(
        (2.0 * mu + lambda) * 0.5 * (along * along - 1.0) * along + lambda * 0.5 * (across * across - 1.0) * along,
        load,
        1e-4,
        "load",
    );
    for principal in cell_field(&grid, "principal_stress").chunks_exact(3) {
        principal
            .iter()
            .zip(expected)
            .for_each(|(found, expected)| assert_close(*found, expected, 1e-8 * load, "stress"));
    }
}

#[test]
fn contact_pressure_of_a_pressed_block_is_the_load() {
    let directory = fresh_directory("pressed");
    let boundary = "body.0.boundary={ left = \"symmetry\", right = \"symmetry\", top = { kind = \"traction\", value = [0.0, \"-3.0e4*t\"] } }";
    let contact = r#"contact=[{ body = "block", law = { kind = "penalty", gamma_contact_0 = 1.0e6 }, size = 0.1, offset = 0.01, obstacle = { kind = "rigid-plane", point = [0.0, 0.0], normal = [0.0, -1.0] } }]"#;
    let fields = r#"output.fields=["contact_pressure"]"#;
    results(&legal(BLOCK, &[&[boundary, contact, fields]]), &directory);
    // Series without the field are not written.
    assert!(!directory.join("solid.pvd").exists() && directory.join("surface.pvd").exists());
    let grid = read_grid(&directory.join("vtk/surface_000002.vtu"));
    assert!(field(&grid.data.cell, "traction").is_none() && grid.data.point.is_empty());
    let (x, pressure) = (points(&grid), cell_field(&grid, "contact_pressure"));
    let mut n_pressed = 0;
    for (edge, pressure) in edges(&grid).into_iter().zip(pressure) {
        let is_bottom = edge.iter().all(|v| x[3 * v + 1].abs() < 0.1);
        assert_close(pressure, if is_bottom { 3e4 } else { 0.0 }, 1e-3, "pressure");
        n_pressed += usize::from(is_bottom);
    }
    assert_eq!(n_pressed, 3);
}

#[test]
fn two_blocks_press_with_the_same_pressure() {
    let directory = fresh_directory("stacked");
    let text = BLOCK.replace(
        "[output]",
        r#"
[[body]]
name     = "base"
shape    = { kind = "box", min = [0.0, -1.0], max = [1.0, 0.0], n = [3, 2] }
material = { kind = "saint-venant-kirchhoff", mu = 8.0e5, lambda = 1.6e6 }
density  = 1000.0
gravity  = [0.0, 0.0]
boundary = { left = "symmetry", right = "symmetry", bottom = "clamped" }

[[contact]]
body     = "block"
obstacle = { kind = "body", name = "base" }
law      = { kind = "penalty", gamma_contact_0 = 1.0e6 }
size     = 0.1
offset   = 0.01

[output]"#,
    );
    let boundary = "body.0.boundary={ left = \"symmetry\", right = \"symmetry\", top = { kind = \"traction\", value = [0.0, \"-3.0e4*t\"] } }";
    results(&legal(&text, &[&[boundary]]), &directory);
    let grid = read_grid(&directory.join("vtk/surface_000002.vtu"));
    let (pressure, body) = (cell_field(&grid, "contact_pressure"), cell_field(&grid, "body"));
    let pressed =
        |of: f64| pressure.iter().zip(&body).filter(move |(p, body)| **body == of && **p != 0.0).map(|(p, _)| *p);
    for of in [0.0, 1.0] {
        assert_eq!(pressed(of).count(), 3);
        pressed(of).for_each(|pressure| assert_close(pressure, 3e4, 1e-3, "pressure"));
    }
}

/// A fixed box in a fluid at rest, which has a weight.
const IMMERSED: &str = r#"
name      = "immersed"
dimension = 2
units     = "si"
time      = { step = 0.1, end = 0.2 }

[fluid]
density    = 1000.0
viscosity  = 1.0
body_force = [0.0, -9810.0]

[background]
kind     = "graded-box"
min      = [0.0, 0.0]
max      = [1.0, 1.0]
size     = 0.21
boundary = { left = "no-slip", right = "no-slip", bottom = "no-slip", top = "free" }

[[body]]
name   = "box"
shape  = { kind = "box", min = [0.31, 0.27], max = [0.67, 0.58], n = [2, 2] }
motion = "fixed"

[output]
vtk_every = 1

[solver]
newton = { tolerance = 1.0e-12 }
"#;

#[test]
fn traction_of_a_fluid_at_rest_is_its_pressure() {
    let directory = fresh_directory("immersed");
    results(&legal(IMMERSED, &[]), &directory);
    let grid = read_grid(&directory.join("vtk/surface_000002.vtu"));
    let (x, traction) = (points(&grid), cell_field(&grid, "traction"));
    let edges = edges(&grid);
    assert_eq!(edges.len(), 8);
    for ([a, b], traction) in edges.into_iter().zip(traction.chunks_exact(3)) {
        let side = [x[3 * b] - x[3 * a], x[3 * b + 1] - x[3 * a + 1]];
        let length = side[0].hypot(side[1]);
        let pressure = 9810.0 * (1.0 - 0.5 * (x[3 * a + 1] + x[3 * b + 1]));
        // The body is to the left of its surface.
        assert_close(traction[0], -pressure * side[1] / length, 1e-3, "along x");
        assert_close(traction[1], pressure * side[0] / length, 1e-3, "along y");
    }
}

#[test]
fn unknown_fields_are_refused() {
    refused(BLOCK, &[&["output.fields=[\"presure\"]"]], &["output.fields.0", "presure", "pressure"]);
}

#[test]
fn grids_without_points_are_valid_files() {
    let mut grid = io::vtk::Grid::default();
    grid.add_point_data("velocity", 3, Vec::new());
    grid.add_cell_data("pressure", 1, Vec::new());
    grid.add_cell_ids("body", Vec::new());
    let path = fresh_directory("empty-grid").join("empty.vtu");
    grid.write(&path, 0).unwrap_or_else(|error| panic!("{error}"));
    let text = std::fs::read_to_string(&path).expect("a file");
    assert!(text.contains("NumberOfPoints=\"0\" NumberOfCells=\"0\""), "{text}");
    let grid = read_grid(&path);
    assert_eq!((grid.num_points(), grid.cells.types.len()), (0, 0));
    assert_eq!((grid.data.point.len(), grid.data.cell.len()), (1, 2));
}

#[test]
fn a_table_stands_for_a_formula() {
    let directory = fresh_directory("tables");
    std::fs::write(directory.join("load.csv"), "# a ramp\nx,t,force\n0,0,0\n1,0.5,1.0e4\n2,1,2.0e3\n").expect("a file");
    let boundary = |value: &str| {
        format!(
            "body.0.boundary={{ left = \"symmetry\", bottom = \"symmetry\", right = {{ kind = \"traction\", value = [{value}, 0] }} }}"
        )
    };
    let run = |value: &str, name: &str| {
        let sets = [&*boundary(value), "time.step=0.1", "output.vtk_every=0"];
        let file = parse_at(&directory.join("case.toml"), BLOCK, &[&sets]).unwrap_or_else(|error| panic!("{error}"));
        let results_of = directory.join(name);
        results(&file, &results_of);
        (column(&results_of, "energy_elastic"), results_of)
    };
    let (table, of_table) = run(r#"{ kind = "table", file = "load.csv", column = "force" }"#, "table");
    let (formula, _) = run(r#""min(2e4*t, 1e4 - 1.6e4*(t - 0.5))""#, "formula");
    assert!(table[4] > 1.0 && table.len() == 10);
    table
        .iter()
        .zip(&formula)
        .for_each(|(table, formula)| assert_close(*table, *formula, 1e-9 * table.max(1e-3), "energy"));
    // The results have a copy of the table, and can be run again.
    let again = io::ScenarioFile::read(&of_table.join("scenario.toml"), &[]).unwrap_or_else(|error| panic!("{error}"));
    results(&again, &directory.join("again"));
    assert_eq!(column(&directory.join("again"), "energy_elastic"), table);
    let refused = |text: &str, words: &[&str]| {
        std::fs::write(directory.join("bad.csv"), text).expect("a file");
        let value = boundary(r#"{ kind = "table", file = "bad.csv", column = "force" }"#);
        check_words(&mistake(parse_at(&directory.join("case.toml"), BLOCK, &[&[&value]])).to_string(), words);
    };
    refused("t,load\n0,1\n", &["bad.csv:1", "no column `force`", "t,load"]);
    refused("t,force\n0,1\n0,2\n", &["bad.csv:3", "t 0 is not after 0", "sort"]);
    refused("t,force\n0,one\n", &["bad.csv:2", "`one` is not a finite number"]);
    refused("t,force\n0\n", &["bad.csv:2", "1 values", "2 columns"]);
    refused("t,force\n", &["no rows"]);
}
