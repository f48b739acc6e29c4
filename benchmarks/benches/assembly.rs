//! Assembly: the pattern, each contribution alone, and the whole system.

use std::collections::BTreeSet;
use std::hint::black_box;
use std::time::Duration;

use algebra::{BlockSystem, NonlinearProblem};
use benchmarks::{RESOLUTIONS, falling_ball, with_first_problem};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    for resolution in RESOLUTIONS {
        let place = format!("2d/{}", resolution.name);
        with_first_problem(&falling_ball(resolution), |problem, x| {
            let all = problem.contributions();
            let (layout, constraints) = (problem.layout(), problem.constraints());
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

criterion_group!(benches, assembly);
criterion_main!(benches);
