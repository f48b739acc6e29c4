//! Assembly: the pattern, each contribution alone, the whole system, and forms for the comparison with other packages.

use std::collections::BTreeSet;
use std::hint::black_box;
use std::time::Duration;

use algebra::{BlockSystem, Constraints, Equations};
use benchmarks::{
    RESOLUTIONS, UnfittedStokes, contributions, falling_ball, n_background_cells, system, whirl, with_first_problem,
    with_internal_work,
};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use solid_svk::{LameParameters, LinearElastic, Material, SaintVenantKirchhoff};

fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let place = format!("2d/{}", resolution.name);
        with_first_problem(&falling_ball(resolution), |problem, x| {
            let all = contributions(&problem.equations);
            let Equations { layout, constraints, .. } = problem.equations;
            group.throughput(Throughput::Elements(layout.len() as u64));
            group.bench_function(BenchmarkId::new("pattern-and-linear", &place), |b| {
                b.iter(|| black_box(BlockSystem::new(layout, &all, constraints)));
            });
            let mut system = BlockSystem::new(layout, &all, constraints);
            group.bench_function(BenchmarkId::new("iteration", &place), |b| b.iter(|| system.assemble(&all, x)));
            let mut seen = BTreeSet::new();
            for &contribution in all.iter().filter(|c| !c.is_empty() && seen.insert(c.name())) {
                let name = contribution.name().replace(' ', "-");
                group.throughput(Throughput::Elements(contribution.len() as u64));
                group.bench_function(BenchmarkId::new(name, &place), |b| {
                    let mut dofs = Vec::new();
                    let mut local = algebra::LocalSystem::new();
                    b.iter(|| {
                        for item in 0..contribution.len() {
                            dofs.clear();
                            contribution.dofs(item, &mut dofs);
                            local.reset(dofs.len());
                            contribution.add(item, x, &mut local);
                            black_box(&local);
                        }
                    });
                });
            }
        });
    }
    group.finish();
}

/// Measures forms for the comparison with other packages, in elements per second with a known pattern and
/// `RAYON_NUM_THREADS=1`.
fn known_pattern(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    let lame = LameParameters { mu: 1.0, lambda: 2.0 };
    elasticity::<2>(&mut group, "elasticity/2d/n448", 448, LinearElastic::new(lame));
    elasticity::<3>(&mut group, "elasticity/3d/n32", 32, LinearElastic::new(lame));
    elasticity::<2>(&mut group, "finite-elasticity/2d/n448", 448, SaintVenantKirchhoff::new(lame));
    elasticity::<3>(&mut group, "finite-elasticity/3d/n32", 32, SaintVenantKirchhoff::new(lame));
    cut_stokes(&mut group, "2d/n256", UnfittedStokes::around_disk(256));
    let published = UnfittedStokes::around_disk(256).with_published_forms();
    cut_stokes(&mut group, "2d/n256/published-forms", published);
    cut_stokes(&mut group, "3d/n32", UnfittedStokes::around_sphere(32));
    let setup = whirl(224);
    with_first_problem(&setup, |problem, x| {
        let mut system = system(&problem.equations);
        let all = contributions(&problem.equations);
        group.throughput(Throughput::Elements(n_background_cells(&setup) as u64));
        group.bench_function("navier-stokes/2d/n224", |b| b.iter(|| system.assemble(&all, x)));
    });
    group.finish();
}

/// Measures matrix and residual of the internal work of a box.
fn elasticity<const D: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: &str,
    n: usize,
    material: impl Material<D> + 'static,
) {
    with_internal_work(n, material, |layout, work, x| {
        group.throughput(Throughput::Elements(work.len() as u64));
        let mut system = BlockSystem::new(layout, &[work], &Constraints::new());
        group.bench_function(id, |b| {
            b.iter(|| if work.is_linear() { system.assemble_linear(&[work]) } else { system.assemble(&[work], x) });
        });
    });
}

/// Measures the assembly of matrix and right-hand side of cut Stokes flow, and the evaluation of the shape values on
/// parts, faces and pieces.
fn cut_stokes<const D: usize>(group: &mut BenchmarkGroup<'_, WallTime>, place: &str, mut stokes: UnfittedStokes<D>) {
    group.throughput(Throughput::Elements(stokes.n_active() as u64));
    let mut system = stokes.with_equations(system);
    group.bench_function(format!("cut-stokes/{place}"), |b| {
        b.iter(|| stokes.with_equations(|equations| system.assemble_linear(&contributions(equations))));
    });
    group.bench_function(format!("cut-stokes-shapes/{place}"), |b| b.iter(|| stokes.evaluate_shapes()));
}

criterion_group!(benches, assembly, known_pattern);
criterion_main!(benches);
