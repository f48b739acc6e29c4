//! How fast: a disk and a sphere as explicit surfaces, with quadrature rules of order 2 on parts and pieces.
//!
//! `cargo run --release -p cutcell --example speed`

#![allow(clippy::print_stdout)]

use std::sync::LazyLock;
use std::time::Instant;

use cutcell::{CutMesh, OverlayOptions};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, QuadratureRule, SimplexMesh, SimplexRule, VertexId};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // One thread, this one, so that its clock counts everything.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()?;
    let centre = [(2.0_f64.sqrt() - 1.0) / 10.0, (3.0_f64.sqrt() - 1.0) / 10.0, (5.0_f64.sqrt() - 2.0) / 10.0];
    for (n, edges) in [(128, 256), (256, 256), (256, 4096), (512, 256)] {
        let background = structured_box::<2>([-0.5; 2], [0.5; 2], [n; 2])?;
        let positions: Vec<Point<2>> = (0..edges)
            .map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(edges))
            .map(|angle| Point::<2>::new(centre[0], centre[1]) + Point::<2>::new(angle.cos(), angle.sin()) * 0.4)
            .collect();
        let facets = (0..edges as u32).flat_map(|k| [VertexId(k), VertexId((k + 1) % edges as u32)]).collect();
        report(&format!("2D, N = {n}, {edges} edges"), &background, &BoundaryMesh::from_facets(facets), &positions)?;
    }
    for n in [16, 32, 64] {
        let background = structured_box::<3>([-0.5; 3], [0.5; 3], [n; 3])?;
        let (positions, boundary) = sphere(Point::<3>::from(centre), 0.4, (0.63 * n as f64) as u32);
        report(&format!("3D, N = {n}, {} triangles", boundary.n_facets()), &background, &boundary, &positions)?;
    }
    Ok(())
}

fn report<const D: usize>(
    name: &str,
    background: &SimplexMesh<D>,
    boundary: &BoundaryMesh<D>,
    positions: &[Point<D>],
) -> Result<(), cutcell::Error> {
    let surface = [Placed::new(boundary, positions)];
    let rules = (SimplexRule::of_degree(D, 2), SimplexRule::of_degree(D - 1, 2));
    let mut best = [f64::INFINITY; 2];
    let mut printed = String::new();
    for _ in 0..5 {
        let start = cpu_seconds();
        let cut = CutMesh::overlay(background, &surface, &OverlayOptions::new())?;
        best[0] = best[0].min(cpu_seconds() - start);
        let (mut inside, mut on_surface) = (QuadratureRule::default(), QuadratureRule::default());
        for part in cut.all_parts().filter(|&part| !cut.is_whole(part)) {
            cut.part_quadrature(background, part, &rules.0, &mut inside);
        }
        for piece in cut.interface() {
            on_surface.push_simplex(&rules.1, &piece.points[..D]);
        }
        best[1] = best[1].min(cpu_seconds() - start);
        let n_cut = cut.report().n_cut_cells;
        printed = format!("{n_cut} cut cells, volume {:.12}, {} points", cut.fluid_volume(), inside.points.len());
    }
    println!("{name}: {:.1} ms, {:.1} ms with rules; {printed}", 1e3 * best[0], 1e3 * best[1]);
    Ok(())
}

/// Seconds that this thread has computed (Linux), or that have passed.
fn cpu_seconds() -> f64 {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = schedule.split(' ').next().and_then(|word| word.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// An octahedron with each triangle divided into n² and put on the sphere.
fn sphere(centre: Point<3>, radius: f64, n: u32) -> (Vec<Point<3>>, BoundaryMesh<3>) {
    let mut numbers = std::collections::HashMap::new();
    let mut positions = Vec::new();
    let mut facets = Vec::new();
    for octant in 0..8 {
        let signs: [i64; 3] = std::array::from_fn(|k| if octant >> k & 1 == 0 { 1 } else { -1 });
        let mut vertex = |i: u32, j: u32| {
            let key = [i64::from(n - i - j) * signs[0], i64::from(i) * signs[1], i64::from(j) * signs[2]];
            *numbers.entry(key).or_insert_with(|| {
                positions.push(centre + Point::<3>::from(key.map(|c| c as f64)).normalize() * radius);
                VertexId::new(positions.len() - 1)
            })
        };
        let mut push = |[a, b, c]: [VertexId; 3]| {
            facets.extend(if signs.iter().product::<i64>() > 0 { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..n {
            for j in 0..n - i {
                push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    (positions, BoundaryMesh::from_facets(facets))
}
