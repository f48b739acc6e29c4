//! The iterative solver on the matrices of the benchmarks, compared with the direct solver.

use algebra::{
    BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, BlockSystem, DirectSolver, Fill, LinearSolver, Workspace,
};
use benchmarks::{
    RESOLUTIONS, UnfittedStokes, ball_in_contact, falling_ball, falling_box, first_system, stokes_system,
};
use solver::{Stabilisation, State, Substep, advance};

const INCOMPLETE: [BlockSolver; 2] = [BlockSolver::Incomplete(Fill::Pattern), BlockSolver::Incomplete(Fill::THRESHOLD)];

fn largest(x: impl Iterator<Item = f64>) -> f64 {
    x.fold(0.0, |largest, x| largest.max(x.abs()))
}

/// Returns the number of iterations to a relative residual of 1e-8. Before, it compares the solution with that of the
/// direct solver, in equilibrated unknowns.
fn iterations(system: &BlockSystem, solvers: &[BlockSolver]) -> usize {
    let (mut x, mut exact) = (vec![0.0; system.residual().len()], vec![0.0; system.residual().len()]);
    let settings = BlockGaussSeidelSettings { solvers: solvers.to_vec(), ..BlockGaussSeidelSettings::default() };
    let mut solver = BlockGaussSeidel::new(settings);
    let linear = system.linear_system().expect("a matrix with scales");
    solver.factorize(&linear).expect("stable factors");
    let report = solver.solve(&linear, system.residual(), &mut x, 1e-8).expect("convergence");
    let mut direct = DirectSolver::new();
    direct.factorize(&linear).expect("a regular matrix");
    direct.solve(&linear, system.residual(), &mut exact, 0.0).expect("a solution");
    let scales = linear.scales.column();
    let error = largest(x.iter().zip(&exact).zip(scales).map(|((a, b), c)| (a - b) / c));
    let size = largest(exact.iter().zip(scales).map(|(b, c)| b / c));
    assert!(error < 1e-5 * size, "{solvers:?}: error {:e} after {} iterations", error / size, report.iterations);
    report.iterations
}

#[test]
fn stokes_flow_in_3d_however_it_is_cut() {
    for n in 7..11 {
        for nitsche in [20.0, 1e5] {
            let system = stokes_system(&UnfittedStokes::around_sphere(n).with_nitsche(nitsche));
            let [pattern, threshold] = INCOMPLETE.map(|block| iterations(&system, &[block]));
            assert!(pattern < 50 && threshold < 40, "N = {n}, {nitsche:e}: {pattern} and {threshold} iterations");
        }
    }
}

#[test]
fn a_ball_in_free_fall_and_in_contact() {
    for system in [first_system(&falling_ball(RESOLUTIONS[0])), first_system(&ball_in_contact(RESOLUTIONS[0]))] {
        let exact = iterations(&system, &[BlockSolver::Lu]);
        let [pattern, threshold] = INCOMPLETE.map(|block| iterations(&system, &[block, BlockSolver::Cholesky]));
        assert!(exact < 15 && pattern < 35 && threshold < 25, "{exact}, {pattern}, {threshold} iterations");
    }
}

#[test]
fn a_step_in_3d() {
    let setup = falling_box::<3>(5, Stabilisation::STANDARD);
    let start = State::initial(&setup).expect("the cube cuts the background");
    let sweep = BlockGaussSeidel::new(BlockGaussSeidelSettings::default());
    let [direct, iterative] = [Workspace::new(), Workspace::with_solver(Box::new(sweep))].map(|mut work| {
        let (state, report) =
            advance(&setup, &start, Substep::whole(setup.dt), &mut work).expect("the first step converges");
        assert!(report.newton.solves > 0);
        state
    });
    // Free fall for 1 ms gives a vertical velocity of -1 cm/s. The added mass of the fluid reduces the speed, by less
    // than a factor of ten.
    for (a, b) in direct.bodies[0].velocity().iter().zip(iterative.bodies[0].velocity()) {
        assert!((-1.0..-0.1).contains(&a[1]) && (a - b).norm() < 1e-5, "{a} and {b}");
    }
}
