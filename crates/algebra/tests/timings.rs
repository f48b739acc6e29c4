//! Timings of a system of the size of a 2D time step; run with `--ignored --nocapture`.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use std::time::Instant;

use algebra::{BlockSystem, Contributions, DirectSolver, LinearSolver, NewtonSettings, Pattern, Workspace, newton};
use common::{Flow, Problem, state};

fn milliseconds<T>(what: &str, run: impl FnOnce() -> T) -> T {
    let begin = Instant::now();
    let out = run();
    println!("{what:<48} {:9.2} ms", begin.elapsed().as_secs_f64() * 1e3);
    out
}

#[test]
#[ignore = "prints times, checks nothing"]
fn timings() {
    for threads in [1, 2] {
        println!("--- {threads} threads");
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run);
    }
}

fn run() {
    let flow = Flow::new(90, 1.0);
    let (linear, convection, jumps) = flow.parts();
    let list: Vec<&dyn Contributions> = vec![&linear, &convection, &jumps[0], &jumps[1], &jumps[2]];
    let n = flow.layout.len();
    let x = state(n);
    let pattern = milliseconds("pattern, first", || Pattern::new(n, &list));
    let pattern = milliseconds("pattern, recycled", || pattern.recycle(n, &list));
    println!("{n} unknowns, {} entries, {} cells, {} faces", pattern.n_entries(), linear.len(), jumps[0].len());
    let system = milliseconds("system, first", || BlockSystem::new(&flow.layout, &list, &flow.constraints));
    let mut system = milliseconds("system, recycled", || system.recycle(&flow.layout, &list, &flow.constraints));
    for t in system.timings() {
        println!("    {:<20} {} items {:.2} ms", t.name, t.items, t.seconds * 1e3);
    }
    milliseconds("assemble (16 k nonlinear cells)", || system.assemble(&list, &x));
    milliseconds("assemble, again", || system.assemble(&list, &x));
    milliseconds("residual", || system.assemble_residual(&list, &x));
    let mut solver = DirectSolver::new();
    let mut solution = vec![0.0; n];
    for k in 0..3 {
        milliseconds(&format!("factorize {k}"), || solver.factorize(system.matrix(), system.unknowns())).unwrap();
        let report = milliseconds("solve", || solver.solve(system.residual(), &mut solution)).unwrap();
        println!("    {report:?}, growth {:e}", solver.growth());
    }
    for m in [89, 91, 88, 90] {
        let other = Flow::new(m, 1.0);
        let (linear, convection, jumps) = other.parts();
        let list: Vec<&dyn Contributions> = vec![&linear, &convection, &jumps[0], &jumps[1], &jumps[2]];
        let mut system = BlockSystem::new(&other.layout, &list, &other.constraints);
        system.assemble(&list, &state(other.layout.len()));
        milliseconds(&format!("factorize, m = {m}, kept memory"), || {
            solver.factorize(system.matrix(), system.unknowns())
        })
        .unwrap();
        let mut fresh = DirectSolver::new();
        milliseconds(&format!("factorize, m = {m}, new memory"), || {
            fresh.factorize(system.matrix(), system.unknowns())
        })
        .unwrap();
    }
    let mut work = Workspace::new();
    let problem = Problem { layout: &flow.layout, contributions: list, constraints: &flow.constraints };
    for contraction in [0.0, 0.25] {
        let mut x = vec![0.0; n];
        let settings = NewtonSettings { contraction, ..NewtonSettings::new(1e-8) };
        let report = milliseconds("newton", || newton(&problem, &mut x, &mut work, &settings)).unwrap();
        println!("{report:#?}");
    }
}
