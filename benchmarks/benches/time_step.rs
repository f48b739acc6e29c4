//! One whole time step of the coupled problem.

use std::hint::black_box;
use std::time::Duration;

use algebra::Workspace;
use benchmarks::{RESOLUTIONS, falling_ball};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use solver::{State, advance};

fn time_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("time_step");
    group.sample_size(10).measurement_time(Duration::from_secs(5)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let setup = falling_ball(resolution);
        let start = State::initial(&setup).expect("the ball cuts the background");
        let mut work = Workspace::new();
        group.throughput(Throughput::Elements(setup.background.n_cells() as u64));
        group.bench_function(BenchmarkId::new("advance/2d", resolution.name), |b| {
            b.iter(|| black_box(advance(&setup, &start, &mut work).expect("the first step converges")));
        });
    }
    group.finish();
}

criterion_group!(benches, time_step);
criterion_main!(benches);
