//! Linear solvers: factorisation with known pattern, and solve.

use std::time::Duration;

use algebra::{DirectSolver, LinearSolver};
use benchmarks::{RESOLUTIONS, falling_ball, first_system};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn linear(c: &mut Criterion) {
    let mut group = c.benchmark_group("linear");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let system = first_system(&falling_ball(resolution));
        let place = format!("2d/{}", resolution.name);
        let mut solver = DirectSolver::new();
        solver.factorize(system.matrix(), system.unknowns()).expect("the first matrix is regular");
        group.throughput(Throughput::Elements(system.layout().len() as u64));
        group.bench_function(BenchmarkId::new("lu-refactor", &place), |b| {
            b.iter(|| solver.factorize(system.matrix(), system.unknowns()));
        });
        let mut x = vec![0.0; system.layout().len()];
        group.bench_function(BenchmarkId::new("lu-solve", &place), |b| {
            b.iter(|| solver.solve(system.residual(), &mut x, 0.0));
        });
    }
    group.finish();
}

criterion_group!(benches, linear);
criterion_main!(benches);
