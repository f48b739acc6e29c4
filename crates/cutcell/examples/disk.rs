//! Two disks that overlap cut a box of triangles: volumes, parts, and an integral over the fluid.
//! `cargo run --release -p cutcell --example disk`

// The example prints its results.
#![allow(clippy::print_stdout)]

use std::f64::consts::PI;

use cutcell::{CellState, CutMesh, OverlayOptions};
use mesh::generate::{BallOptions, ball, structured_box};
use mesh::{Placed, QuadratureRule, SimplexRule, Vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let background = structured_box::<2>([0.0, 0.0], [4.0, 3.0], [40, 30])?;
    let options = BallOptions { area_preserving: true };
    let disks = [ball::<2>([1.6, 1.5], 0.8, 0.05, &options)?, ball::<2>([2.4, 1.5], 0.8, 0.05, &options)?];
    let surfaces = [disks[0].boundary(), disks[1].boundary()];

    for n_bodies in [1, 2] {
        let placed: Vec<Placed<'_, 2>> =
            surfaces.iter().zip(&disks).take(n_bodies).map(|(s, d)| Placed::new(s, d.vertices())).collect();
        let cut = CutMesh::overlay(&background, &placed, &OverlayOptions::new())?;
        let report = cut.report();
        println!("{n_bodies} bodies");
        println!(
            "  cells             {} fluid, {} cut, {} covered",
            report.n_fluid_cells, report.n_cut_cells, report.n_covered_cells
        );
        println!("  solid             {:.12}", 12.0 - cut.fluid_volume());
        println!("  one disk          {:.12}", PI * 0.64);
        println!("  fluid parts       {}, at most {} in a cell", cut.n_parts(), report.max_parts);
        println!("  smallest part     {:.2e} of its cell", report.smallest_fraction);

        // Second moment of the fluid, part by part.
        let mut points = QuadratureRule::default();
        for part in cut.all_parts() {
            cut.part_quadrature(&background, part, SimplexRule::of_degree(2, 2), &mut points);
        }
        println!("  ∫ y²              {:.12}", points.integrate(|x| x[1] * x[1]));

        // The interface is closed, also where surfaces overlap.
        let normals: Vector<2> = cut.interface().iter().map(|piece| piece.normal * piece.measure).sum();
        println!("  ∫ n               {:.1e} on {} pieces", normals.norm(), cut.interface().len());

        // In cut cells the parts alone are fluid.
        let cut_cells = background.cells().filter(|&cell| cut.cell_state(cell) == CellState::Cut);
        let fluid: f64 = cut_cells.flat_map(|cell| cut.parts(cell)).map(|part| cut.part_volume(part)).sum();
        println!("  in cut cells      {fluid:.6} of fluid, {} ghost faces", cut.ghost_faces().count());
    }
    Ok(())
}
