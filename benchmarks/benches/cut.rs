//! Cutting: the whole overlay, and the quadrature on all of its parts.

use std::hint::black_box;
use std::time::Duration;

use benchmarks::{RESOLUTIONS, background, ball};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use cutcell::{CutMesh, OverlayOptions};
use mesh::{Placed, QuadratureRule, SimplexRule};

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

criterion_group!(benches, cut);
criterion_main!(benches);
