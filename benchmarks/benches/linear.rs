//! Linear solvers: direct with a known and a new pattern, and FGMRES with block Gauss-Seidel, including the set-up.

use std::time::Duration;

use algebra::{BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, BlockSystem, DirectSolver, Fill, LinearSolver};
use benchmarks::{
    RESOLUTIONS, StokesWeights, UnfittedStokes, ball_in_contact, falling_ball, first_system, stokes_system,
};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Relative residual of the iterative solvers.
const TOLERANCE: f64 = 1e-8;

/// Preconditioners with their names.
fn preconditioners() -> [(&'static str, Vec<BlockSolver>); 3] {
    [
        ("gmres-lu", vec![BlockSolver::Lu]),
        ("gmres-ilu", vec![BlockSolver::Incomplete(Fill::Pattern), BlockSolver::Cholesky]),
        ("gmres-ilut", vec![BlockSolver::Incomplete(Fill::THRESHOLD), BlockSolver::Cholesky]),
    ]
}

/// Equilibrates and factorises the matrix.
fn factorize(solver: &mut dyn LinearSolver, system: &mut BlockSystem) {
    system.equilibrate().expect("a matrix with scales");
    solver.factorize(&system.linear_system().expect("a matrix with scales")).expect("a regular matrix");
}

fn solve(solver: &mut dyn LinearSolver, system: &mut BlockSystem, x: &mut [f64]) -> usize {
    factorize(solver, system);
    let linear = system.linear_system().expect("a matrix with scales");
    solver.solve(&linear, system.residual(), x, TOLERANCE).expect("a solution").iterations
}

/// Measures set-up and solve with each of the named preconditioners.
fn iterative(group: &mut BenchmarkGroup<'_, WallTime>, system: &mut BlockSystem, place: &str, names: &[&str]) {
    let mut x = vec![0.0; system.layout().len()];
    group.throughput(Throughput::Elements(x.len() as u64));
    for (name, solvers) in preconditioners().into_iter().filter(|(name, _)| names.contains(name)) {
        let settings = BlockGaussSeidelSettings { solvers, ..BlockGaussSeidelSettings::default() };
        group.bench_function(BenchmarkId::new(name, place), |b| {
            let mut solver = BlockGaussSeidel::new(settings.clone());
            b.iter(|| solve(&mut solver, system, &mut x));
        });
    }
}

/// Measures factorisation of a new pattern and solve.
fn direct(group: &mut BenchmarkGroup<'_, WallTime>, system: &mut BlockSystem, place: &str) {
    let mut x = vec![0.0; system.layout().len()];
    group.throughput(Throughput::Elements(x.len() as u64));
    group.bench_function(BenchmarkId::new("lu-factor", place), |b| {
        b.iter(|| solve(&mut DirectSolver::new(), system, &mut x));
    });
}

fn coupled(c: &mut Criterion) {
    let mut group = c.benchmark_group("linear");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let mut system = first_system(&falling_ball(resolution));
        let place = format!("2d/{}", resolution.name);
        let mut solver = DirectSolver::new();
        factorize(&mut solver, &mut system);
        group.throughput(Throughput::Elements(system.layout().len() as u64));
        group.bench_function(BenchmarkId::new("lu-refactor", &place), |b| {
            b.iter(|| factorize(&mut solver, &mut system));
        });
        let mut x = vec![0.0; system.layout().len()];
        let linear = system.linear_system().expect("a matrix with scales");
        group.bench_function(BenchmarkId::new("lu-solve", &place), |b| {
            b.iter(|| solver.solve(&linear, system.residual(), &mut x, 0.0));
        });
        iterative(&mut group, &mut system, &place, &["gmres-lu", "gmres-ilu", "gmres-ilut"]);
        let mut contact = first_system(&ball_in_contact(resolution));
        iterative(&mut group, &mut contact, &format!("2d/{}/contact", resolution.name), &["gmres-lu", "gmres-ilut"]);
    }
    group.finish();
}

/// Steady Stokes flow around a cut disk and a cut sphere.
fn stokes(c: &mut Criterion) {
    let mut group = c.benchmark_group("linear");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for n in [32, 64, 128] {
        let mut system = stokes_system(&UnfittedStokes::around_disk(n, StokesWeights::PUBLISHED));
        direct(&mut group, &mut system, &format!("2d/n{n}"));
        iterative(&mut group, &mut system, &format!("2d/n{n}"), &["gmres-ilu", "gmres-ilut"]);
    }
    for n in [8, 12, 16, 24] {
        let mut system = stokes_system(&UnfittedStokes::around_sphere(n, StokesWeights::PUBLISHED));
        // Larger systems take seconds to minutes, see `RESULTS.md`.
        if n <= 12 {
            direct(&mut group, &mut system, &format!("3d/n{n}"));
        }
        iterative(&mut group, &mut system, &format!("3d/n{n}"), &["gmres-ilu", "gmres-ilut"]);
    }
    group.finish();
}

criterion_group!(benches, coupled, stokes);
criterion_main!(benches);
