//! Cuts: the whole overlay, and quadrature on all parts.

use std::hint::black_box;
use std::time::Duration;

use benchmarks::{BODY_CENTRE, RESOLUTIONS, background, ball, polygon, sphere};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use cutcell::{CutMesh, Cutter, OverlayOptions};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, QuadratureRule, SimplexRule};

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
                cut.all_parts().for_each(|part| cut.part_quadrature(&background, part, rule, &mut points));
                black_box(points)
            });
        });
    }
    group.finish();
}

/// Measures the cut by a polygonal disk or a triangulated sphere, in boxes of N² squares and N³ cubes. It includes
/// quadrature rules of degree 2 on cut parts and interface pieces, in reused memory. For the comparison with other
/// packages, use `RAYON_NUM_THREADS=1`.
fn explicit_surfaces(c: &mut Criterion) {
    let mut group = c.benchmark_group("cut");
    group.sample_size(10).measurement_time(Duration::from_secs(4)).warm_up_time(Duration::from_millis(500));
    for (n, edges) in [(128, 256), (256, 256), (256, 4096), (512, 256)] {
        let id = BenchmarkId::new("disk", format!("2d/{n}/{edges}"));
        overlay_with_rules::<2>(&mut group, id, n, polygon(BODY_CENTRE, 0.4, edges));
    }
    // A constant number of cut cells, and an increasing number of uncut ones.
    for n in [64, 128, 256, 512] {
        let id = BenchmarkId::new("far-cells", format!("2d/{n}"));
        overlay_with_rules::<2>(&mut group, id, n, polygon(BODY_CENTRE, 0.4 * 64.0 / n as f64, 256));
    }
    for n in [16, 32, 64] {
        let id = BenchmarkId::new("sphere", format!("3d/{n}"));
        overlay_with_rules::<3>(&mut group, id, n, sphere(BODY_CENTRE, 0.4, (0.63 * n as f64) as u32));
    }
    group.finish();
}

/// Measures the overlay of a surface on a box of `n` bricks along each side, with rules on cut parts and pieces.
fn overlay_with_rules<const D: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: BenchmarkId,
    n: usize,
    (positions, boundary): (Vec<Point<D>>, BoundaryMesh<D>),
) {
    let background = structured_box::<D>([-0.5; D], [0.5; D], [n; D]).expect("a box");
    let surface = [Placed::new(&boundary, &positions)];
    let rules = [D, D - 1].map(|dimension| SimplexRule::of_degree(dimension, 2));
    let mut cutter = Cutter::new();
    group.throughput(Throughput::Elements(background.n_cells() as u64));
    group.bench_function(id, |b| {
        b.iter(|| {
            let cut = cutter.overlay(&background, &surface, &OverlayOptions::new()).expect("a sound surface");
            let mut points = [QuadratureRule::default(), QuadratureRule::default()];
            for part in cut.all_parts().filter(|&part| !cut.is_whole(part)) {
                cut.part_quadrature(&background, part, rules[0], &mut points[0]);
            }
            cut.interface().iter().for_each(|piece| points[1].push_simplex(rules[1], &piece.points[..D]));
            cutter.recycle(cut);
            black_box(points)
        });
    });
}

criterion_group!(benches, cut, explicit_surfaces);
criterion_main!(benches);
