//! A torus that turns inside a box of tetrahedra. The volume is independent of the position; a thin torus divides cells
//! into several parts.
//! `cargo run --release -p cutcell --example torus`

// The example prints its results.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use cutcell::{CutMesh, OverlayOptions};
use mesh::generate::structured_box;
use mesh::nalgebra::Rotation3;
use mesh::{BoundaryMesh, Placed, Point, VertexId};

/// Returns a torus around the third axis, `2 n_around n_across` triangles with normals outwards.
fn torus(radius: f64, tube: f64, n_around: usize, n_across: usize) -> (BoundaryMesh<3>, Vec<Point<3>>) {
    let mut positions = Vec::with_capacity(n_around * n_across);
    let mut facets = Vec::with_capacity(6 * n_around * n_across);
    let vertex = |i: usize, j: usize| VertexId::new(i % n_around * n_across + j % n_across);
    for i in 0..n_around {
        let (sin, cos) = (TAU * i as f64 / n_around as f64).sin_cos();
        for j in 0..n_across {
            let (up, out) = (TAU * j as f64 / n_across as f64).sin_cos();
            let r = radius + tube * out;
            positions.push(Point::<3>::new(r * cos, r * sin, tube * up));
            facets.extend([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
            facets.extend([vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
        }
    }
    (BoundaryMesh::from_facets(facets), positions)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let background = structured_box::<3>([-1.0; 3], [1.0; 3], [12; 3])?;
    for (name, tube) in [("thick", 0.25), ("thin", 0.04)] {
        let (surface, reference) = torus(0.65, tube, 48, 16);
        let exact = Placed::new(&surface, &reference).enclosed().volume;
        println!("{name} torus of {} triangles, volume {exact:.12}", surface.n_facets());
        println!("  angle   cut cells   parts in a cell   smallest part   volume error   wet area");
        for angle in [0.0, 1e-9, 0.3, 0.9] {
            let turn = Rotation3::from_euler_angles(angle, 0.6 * angle, 0.0);
            let positions: Vec<Point<3>> = reference.iter().map(|x| turn * x).collect();
            let cut = CutMesh::overlay(&background, &[Placed::new(&surface, &positions)], &OverlayOptions::new())?;
            let report = cut.report();
            let error = (8.0 - cut.fluid_volume() - exact).abs() / 8.0;
            let area: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
            println!(
                "  {angle:<5e} {:11} {:17} {:15.2e} {error:14.1e} {area:10.6}",
                report.n_cut_cells, report.max_parts, report.smallest_fraction
            );
        }
    }
    Ok(())
}
