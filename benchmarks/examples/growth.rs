//! Time and memory of a problem of given size: `growth step2 0.1` (five steps of the falling ball with cells of this
//! size), `growth step3 12` (five steps of the falling cube), `growth stokes3 28` and `growth stokes3-lu 28` (one
//! linear solve). Use one process per size, since the peak of memory is that of the process. Seconds are processor time
//! of all threads, which depends less on other work of the machine than wall-clock time; shares of tasks are of
//! wall-clock time.

#![allow(clippy::print_stdout)]

use algebra::{
    BlockGaussSeidel, BlockGaussSeidelSettings, DirectSolver, LaggedSettings, LaggedSolver, LinearSolver, Workspace,
};
use benchmarks::{Resolution, UnfittedStokes, falling_ball, falling_box, stokes_system};
use solver::{Setup, Stabilisation, State, Substep, advance};

/// Number of steps for means: the first one, and four with possibly lagged factors.
const N_STEPS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, size] = arguments.as_slice() else { return Err("give a kind and a size".into()) };
    let sweep = || BlockGaussSeidel::new(BlockGaussSeidelSettings::default());
    let row = match kind.as_str() {
        "step2" => {
            let fine = size.parse()?;
            let setup = falling_ball(Resolution { name: "given", fine, coarse: 5.0 * fine });
            steps(&setup, Box::new(LaggedSolver::new(LaggedSettings::default())))?
        }
        "step3" => steps(&falling_box::<3>(size.parse()?, Stabilisation::STANDARD), Box::new(sweep()))?,
        "stokes3" => stokes(size.parse()?, &mut sweep())?,
        "stokes3-lu" => stokes(size.parse()?, &mut DirectSolver::new())?,
        _ => return Err(format!("there is no kind {kind}").into()),
    };
    println!("{kind} {size}: {row}, peak {} MB", peak_memory().map_or("?".to_owned(), |kb| (kb / 1024).to_string()));
    Ok(())
}

/// Measures means over the first steps from rest.
fn steps<const D: usize>(
    setup: &Setup<D>,
    solver: Box<dyn LinearSolver>,
) -> Result<String, Box<dyn std::error::Error>> {
    let mut state = State::initial(setup)?;
    let mut work = Workspace::with_solver(solver);
    let mut tasks = [0.0; 4];
    let (mut n, mut solves, mut iterations, mut factorizations) = (0, 0, 0, 0);
    let begin = processor_time()?;
    for _ in 0..N_STEPS {
        let (next, report) = advance(setup, &state, Substep::whole(setup.dt), &mut work)?;
        let seconds = [report.seconds.cut, report.seconds.space, report.seconds.assembly, report.seconds.linear];
        tasks.iter_mut().zip(seconds).for_each(|(sum, seconds)| *sum += seconds);
        n = report.n_dofs;
        solves += report.newton.solves;
        iterations += report.newton.linear_iterations;
        factorizations += report.newton.factorizations;
        state = next;
    }
    let total = (processor_time()? - begin) / N_STEPS as f64;
    let sum: f64 = tasks.iter().sum();
    let [cut, space, assembly, linear] = tasks.map(|task| 100.0 * task / sum);
    Ok(format!(
        "{n} unknowns, {total:.3} s per step (cut {cut:.0} %, space {space:.0} %, assembly {assembly:.0} %, linear \
         {linear:.0} %), {factorizations} factorisations, {solves} solves, {iterations} iterations"
    ))
}

/// Measures one solve of Stokes flow around a cut sphere, including the set-up.
fn stokes(n: u32, solver: &mut dyn LinearSolver) -> Result<String, Box<dyn std::error::Error>> {
    let mut system = stokes_system(&UnfittedStokes::around_sphere(n));
    let mut x = vec![0.0; system.layout().len()];
    let begin = processor_time()?;
    system.equilibrate()?;
    let linear = system.linear_system()?;
    solver.factorize(&linear)?;
    let set_up = processor_time()? - begin;
    let report = solver.solve(&linear, system.residual(), &mut x, 1e-8)?;
    let total = processor_time()? - begin;
    let n_unknowns = x.len();
    Ok(format!("{n_unknowns} unknowns, {total:.3} s (set-up {set_up:.3}), {} iterations", report.iterations))
}

/// Returns the processor time of this process, s.
fn processor_time() -> Result<f64, Box<dyn std::error::Error>> {
    /// Unit of the counters of Linux.
    const TICKS_PER_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let after_name = stat.rsplit(") ").next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>).sum::<Result<f64, _>>()?;
    Ok(ticks / TICKS_PER_SECOND)
}

/// Returns the largest resident memory of this process, kB, if the system provides it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.split_whitespace().next()?.parse().ok()
}
