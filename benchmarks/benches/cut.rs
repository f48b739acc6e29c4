//! Cuts: the whole overlay, and quadrature on all parts.

use std::hint::black_box;
use std::time::Duration;

use benchmarks::{BODY_CENTRE, RESOLUTIONS, background, ball, polygon, sphere};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use cutcell::{CutMesh, Cutter, OverlayOptions};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, QuadratureRule, SimplexMesh, SimplexRule};

fn cut(c: &mut Criterion) {
    let mut group = c.benchmark_group("cut");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let (background, ball) = (background(resolution), ball(resolution));
        let boundary = ball.boundary();
        let surface = [Placed::new(&boundary, ball.vertices())];
        let overlay =
            || CutMesh::overlay(&background, &surface, &OverlayOptions::new()).expect("the ball cuts the background");
        let cut = overlay();
        let place = format!("2d/{}", resolution.name);
        group.throughput(Throughput::Elements(background.n_cells() as u64));
        group.bench_function(BenchmarkId::new("overlay", &place), |b| b.iter(|| black_box(overlay())));
        let rule = SimplexRule::of_degree(2, 2);
        group.throughput(Throughput::Elements(cut.n_parts() as u64));
        group.bench_function(BenchmarkId::new("quadrature", &place), |b| {
            b.iter(|| {
                let mut points = QuadratureRule::default();
                cut.all_parts().for_each(|part| cut.part_quadrature(&background, part, &rule, &mut points));
                black_box(points)
            });
        });
    }
    group.finish();
}

/// A polygonal disk and a triangulated sphere with facets of the size of the cells, in boxes of N² squares and N³ cubes,
/// with rules of order 2 on cut parts and pieces, in reused memory. For the comparison with other packages, use
/// `RAYON_NUM_THREADS=1`.
fn explicit_surfaces(c: &mut Criterion) {
    let mut group = c.benchmark_group("cut");
    group.sample_size(10).measurement_time(Duration::from_secs(4)).warm_up_time(Duration::from_millis(500));
    for (n, edges) in [(128, 256), (256, 256), (256, 4096), (512, 256)] {
        let background = structured_box::<2>([-0.5; 2], [0.5; 2], [n; 2]).expect("a box");
        let (positions, boundary) = polygon(BODY_CENTRE, 0.4, edges);
        let id = BenchmarkId::new("disk", format!("2d/{n}/{edges}"));
        group.throughput(Throughput::Elements(2 * (n as u64).pow(2)));
        let mut cutter = Cutter::new();
        group.bench_function(id, |b| {
            b.iter(|| black_box(overlay_with_rules(&mut cutter, &background, &boundary, &positions)));
        });
    }
    // A constant number of cut cells, and an increasing number of uncut ones.
    for n in [64, 128, 256, 512] {
        let background = structured_box::<2>([-0.5; 2], [0.5; 2], [n; 2]).expect("a box");
        let (positions, boundary) = polygon(BODY_CENTRE, 0.4 * 64.0 / n as f64, 256);
        let id = BenchmarkId::new("far-cells", format!("2d/{n}"));
        group.throughput(Throughput::Elements(background.n_cells() as u64));
        let mut cutter = Cutter::new();
        group.bench_function(id, |b| {
            b.iter(|| black_box(overlay_with_rules(&mut cutter, &background, &boundary, &positions)));
        });
    }
    for n in [16, 32, 64] {
        let background = structured_box::<3>([-0.5; 3], [0.5; 3], [n; 3]).expect("a box");
        let (positions, boundary) = sphere(BODY_CENTRE, 0.4, (0.63 * n as f64) as u32);
        let id = BenchmarkId::new("sphere", format!("3d/{n}"));
        group.throughput(Throughput::Elements(6 * (n as u64).pow(3)));
        let mut cutter = Cutter::new();
        group.bench_function(id, |b| {
            b.iter(|| black_box(overlay_with_rules(&mut cutter, &background, &boundary, &positions)));
        });
    }
    group.finish();
}

fn overlay_with_rules<const D: usize>(
    cutter: &mut Cutter<D>,
    background: &SimplexMesh<D>,
    boundary: &BoundaryMesh<D>,
    positions: &[Point<D>],
) -> [QuadratureRule<D>; 2] {
    let surface = [Placed::new(boundary, positions)];
    let cut = cutter.overlay(background, &surface, &OverlayOptions::new()).expect("a sound surface");
    let rules = [D, D - 1].map(|dimension| SimplexRule::of_degree(dimension, 2));
    let mut points = [QuadratureRule::default(), QuadratureRule::default()];
    for part in cut.all_parts().filter(|&part| !cut.is_whole(part)) {
        cut.part_quadrature(background, part, &rules[0], &mut points[0]);
    }
    cut.interface().iter().for_each(|piece| points[1].push_simplex(&rules[1], &piece.points[..D]));
    cutter.recycle(cut);
    points
}

criterion_group!(benches, cut, explicit_surfaces);
criterion_main!(benches);
