//! Linear solvers: direct with a known and a new pattern, and FGMRES with block Gauss-Seidel, including the set-up.

use std::time::Duration;

use algebra::{BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, BlockSystem, DirectSolver, Fill, LinearSolver};
use benchmarks::{RESOLUTIONS, UnfittedStokes, ball_in_contact, falling_ball, first_system, stokes_system};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Relative residual of the iterative solvers.
const TOLERANCE: f64 = 1e-8;

/// Equilibrates and factorises the matrix.
fn factorize(solver: &mut dyn LinearSolver, system: &mut BlockSystem) {
    system.equilibrate().expect("a matrix with scales");
    solver.factorize(&system.linear_system().expect("a matrix with scales")).expect("a regular matrix");
}

/// Measures set-up and solve with each of the named solvers.
fn solve(group: &mut BenchmarkGroup<'_, WallTime>, system: &mut BlockSystem, place: &str, names: &[&str]) {
    let mut x = vec![0.0; system.layout().len()];
    group.throughput(Throughput::Elements(x.len() as u64));
    for &name in names {
        let blocks = match name {
            "gmres-lu" => vec![BlockSolver::Lu],
            "gmres-ilu" => vec![BlockSolver::Incomplete(Fill::Pattern), BlockSolver::Cholesky],
            _ => vec![BlockSolver::Incomplete(Fill::THRESHOLD), BlockSolver::Cholesky],
        };
        let settings = BlockGaussSeidelSettings { solvers: blocks, ..BlockGaussSeidelSettings::default() };
        group.bench_function(BenchmarkId::new(name, place), |b| {
            let mut iterative = BlockGaussSeidel::new(settings.clone());
            b.iter(|| {
                // The direct solver has a new pattern every time.
                let direct: &mut dyn LinearSolver = &mut DirectSolver::new();
                let solver = if name == "lu-factor" { direct } else { &mut iterative };
                factorize(solver, system);
                let linear = system.linear_system().expect("a matrix with scales");
                solver.solve(&linear, system.residual(), &mut x, TOLERANCE).expect("a solution").iterations
            });
        });
    }
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
        solve(&mut group, &mut system, &place, &["gmres-lu", "gmres-ilu", "gmres-ilut"]);
        let mut contact = first_system(&ball_in_contact(resolution));
        solve(&mut group, &mut contact, &format!("2d/{}/contact", resolution.name), &["gmres-lu", "gmres-ilut"]);
    }
    group.finish();
}

/// Measures steady Stokes flow around a cut disk and a cut sphere.
fn stokes(c: &mut Criterion) {
    let mut group = c.benchmark_group("linear");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for n in [32, 64, 128] {
        let mut system = stokes_system(&UnfittedStokes::around_disk(n));
        solve(&mut group, &mut system, &format!("2d/n{n}"), &["lu-factor", "gmres-ilu", "gmres-ilut"]);
    }
    for n in [8, 12, 16, 24] {
        let mut system = stokes_system(&UnfittedStokes::around_sphere(n));
        // Larger systems take seconds to minutes, see `RESULTS.md`.
        let first = if n <= 12 { 0 } else { 1 };
        solve(&mut group, &mut system, &format!("3d/n{n}"), &["lu-factor", "gmres-ilu", "gmres-ilut"][first..]);
    }
    group.finish();
}

criterion_group!(benches, coupled, stokes);
criterion_main!(benches);
