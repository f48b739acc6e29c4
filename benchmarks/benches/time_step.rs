//! One time step of the coupled problem.

use std::hint::black_box;
use std::time::Duration;

use algebra::{BlockGaussSeidel, BlockGaussSeidelSettings, Workspace};
use benchmarks::{RESOLUTIONS, UNIFORM, falling_ball, falling_box, n_background_cells};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use solver::{Setup, Stabilisation, State, Substep, advance};

fn time_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("time_step");
    group.sample_size(10).measurement_time(Duration::from_secs(5)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        first_step(&mut group, &falling_ball(resolution), Workspace::new(), "advance/2d", resolution.name);
    }
    for (name, stabilisation) in [("advance/3d", Stabilisation::STANDARD), ("advance/3d-uniform", UNIFORM)] {
        for n in [8, 12] {
            let solver = BlockGaussSeidel::new(BlockGaussSeidelSettings::default());
            let work = Workspace::with_solver(Box::new(solver));
            first_step(&mut group, &falling_box::<3>(n, stabilisation), work, name, &format!("n{n}"));
        }
    }
    group.finish();
}

/// Measures the first step of a setup, repeated from the same state with the same workspace.
fn first_step<const D: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    setup: &Setup<D>,
    mut work: Workspace,
    name: &str,
    size: &str,
) {
    let start = State::initial(setup).expect("the body cuts the background");
    group.throughput(Throughput::Elements(n_background_cells(setup) as u64));
    let whole = Substep::whole(setup.dt);
    group.bench_function(BenchmarkId::new(name, size), |b| {
        b.iter(|| black_box(advance(setup, &start, whole, &mut work).expect("the first step converges")));
    });
}

criterion_group!(benches, time_step);
criterion_main!(benches);
