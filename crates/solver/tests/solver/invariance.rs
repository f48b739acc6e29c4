//! Independence of the result from the number of threads, from a restart, from the use of symmetry, and from an ambient
//! pressure.

use std::sync::Arc;

use crate::fixture::*;
use solver::algebra::time::ImplicitEuler;
use solver::algebra::{LaggedSettings, LaggedSolver, Workspace};
use solver::mesh::generate::structured_box;
use solver::{Error, FluidBoundary, Setup, State, StepReport, Substep, TimeLoop, advance};

/// Returns all bits of a state.
fn bits(state: &State<2>) -> Vec<Vec<u64>> {
    state.to_lists().iter().map(|list| list.iter().map(|x| x.to_bits()).collect()).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let setup = falling_ball(0.8, 0.05, 0.1, false);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| bits(&run(&setup, 3).0))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(4));
}

/// An elastic ball that falls on a plane, and a free rigid one to the right of it.
fn two_balls(scheme: Scheme, size: f64) -> Setup<2> {
    let mut setup = falling_ball(size, 0.05, 0.1, false);
    setup.bodies.push(Arc::new(rigid("rigid", &disk([6.0, 12.0], 1.3, size), 1.4, V::new(0.0, -1e3))));
    Setup { scheme, ..setup }
}

/// Lists of a state and of the linear solver.
type Lists = [Vec<Vec<f64>>; 2];

/// Takes steps from a state with the solver that keeps old factors; returns the state, and the lists of both.
fn go_on(setup: &Setup<2>, state: State<2>, memory: &[Vec<f64>], n_steps: usize) -> (State<2>, Lists) {
    let mut work = Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
    work.recall(memory).expect("the memory of such a solver");
    let mut run = TimeLoop::new(setup, state, work);
    run.run(n_steps, &mut []).expect("steps");
    (run.state().clone(), [run.state().to_lists(), run.workspace().memory()])
}

#[test]
fn going_on_from_stored_lists_equals_not_stopping() {
    for scheme in [Arc::new(ImplicitEuler) as Scheme, second_order(0.5)] {
        let setup = two_balls(scheme, 0.8);
        let start = || State::initial(&setup).expect("a state");
        let through = go_on(&setup, start(), &[], 5).0;
        for stop in [2, 3] {
            let [stored, memory] = go_on(&setup, start(), &[], stop).1;
            let restored = State::from_lists(&setup, &stored).expect("a state of this setup");
            assert_eq!(
                bits(&restored),
                stored.iter().map(|l| l.iter().map(|x| x.to_bits()).collect()).collect::<Vec<Vec<_>>>()
            );
            assert_eq!(bits(&through), bits(&go_on(&setup, restored.clone(), &memory, 5 - stop).0));
            // A solver without old factors gives other bits.
            assert_ne!(bits(&through), bits(&go_on(&setup, restored, &[], 5 - stop).0));
        }
    }
}

#[test]
fn lists_of_another_setup_are_refused() {
    let of_size = |size| two_balls(Arc::new(ImplicitEuler), size);
    let lists = run(&of_size(0.8), 1).0.to_lists();
    let refused = |setup: &Setup<2>, lists: &[Vec<f64>]| {
        matches!(State::from_lists(setup, lists).map_err(|error| error.source), Err(Error::Lists { .. }))
    };
    assert!(refused(&of_size(0.9), &lists));
    assert!(refused(&of_size(0.8), &lists[1..]) && refused(&of_size(0.8), &lists[..lists.len() - 1]));
    let longer = [&lists[..], &[vec![1.0]]].concat();
    assert!(refused(&of_size(0.8), &longer) && !refused(&of_size(0.8), &lists));
}

#[test]
fn states_of_another_setup_are_refused() {
    let setup = two_balls(Arc::new(ImplicitEuler), 0.8);
    let what = |state: &State<2>| {
        let result = advance(&setup, state, Substep::whole(setup.dt), &mut Workspace::new());
        result.err().map(|error| error.source.to_string()).unwrap_or_default()
    };
    let start = State::initial(&setup).expect("a start");
    let mut fewer = start.clone();
    fewer.bodies.truncate(1);
    assert!(what(&fewer).contains("bodies: 1 found, 2 expected"), "{}", what(&fewer));
    let mut short = start.clone();
    short.bodies[1].level.velocity.pop();
    assert!(what(&short).contains("velocities of a body"), "{}", what(&short));
    let mut dry = start.clone();
    dry.fluid = None;
    assert!(what(&dry).contains("states of the fluid: 0 found, 1 expected"), "{}", what(&dry));
    let finer = State::initial(&two_balls(Arc::new(ImplicitEuler), 0.5)).expect("a start");
    let mut elsewhere = start;
    elsewhere.fluid = finer.fluid;
    assert!(what(&elsewhere).contains("cells of the background"), "{}", what(&elsewhere));
}

#[test]
fn old_factors_give_the_same_solution() {
    // The run includes the contact. The settings accept old factors whenever they converge.
    let setup = falling_ball(0.8, 1.001, 1.0, false);
    let lax = LaggedSettings { largest_share: 1.0, most_iterations: 40, ..LaggedSettings::default() };
    let mut work = Workspace::with_solver(Box::new(LaggedSolver::new(lax)));
    let mut state = State::initial(&setup).expect("a state");
    let (mut n_factorizations, mut n_active) = (0, 0);
    for _ in 0..12 {
        let (next, report) = solver::advance(&setup, &state, Substep::whole(setup.dt), &mut work).expect("a step");
        n_factorizations += report.newton.factorizations;
        n_active += usize::from(report.contacts[0].is_active());
        state = next;
    }
    let (direct, _) = run(&setup, 12);
    let scale = direct.bodies[0].velocity().iter().map(|v| v.norm()).fold(0.0, f64::max);
    for (a, b) in state.bodies[0].velocity().iter().zip(direct.bodies[0].velocity()) {
        assert!((a - b).norm() < 1e-7 * scale, "{a} {b}");
    }
    assert!(n_active > 0 && n_factorizations < 12, "{n_active} steps in contact, {n_factorizations} factorisations");
}

/// Returns the setup of an elastic disk that turns about its centre, in a box with a pressure at its open top.
fn turning_disk(scheme: Scheme, [viscosity, dt, spin]: [f64; 3], pressure: fn(f64) -> f64) -> Setup<2> {
    let background = structured_box([-2.0, -2.0], [2.0, 2.0], [8, 8]).expect("a box");
    let mut setup = Setup { scheme, ..setup(fluid(background, 1.0, viscosity), dt) };
    on_sides(&mut setup, &["left", "right", "bottom"], || FluidBoundary::NoSlip);
    on_sides(&mut setup, &["top"], || FluidBoundary::Open {
        traction: Some(Arc::new(move |_, normal, time| normal * -pressure(time))),
        backflow: false,
    });
    let mut body = elastic("disk", disk([0.0, 0.0], 1.0, 0.4), 1.5, 30.0, 60.0, V::zeros());
    body.options.initial_velocity = Some(Arc::new(move |x: &P| V::new(-x[1], x[0]) * spin));
    setup.bodies.push(body.body());
    setup
}

/// Returns the angular velocity of an elastic disk after 15 steps under a pressure.
fn spin(scheme: Scheme, pressure: fn(f64) -> f64) -> f64 {
    let setup = turning_disk(scheme, [1e-2, 0.1, 0.5], pressure);
    let (state, _) = run(&setup, 15);
    let body = (&setup.bodies[0], &state.bodies[0]);
    let moments = body
        .1
        .positions(body.0.reference())
        .into_iter()
        .zip(body.1.velocity())
        .map(|(x, v)| [x[0] * v[1] - x[1] * v[0], x.norm_squared()]);
    let [moment, square] = moments.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
    moment / square
}

#[test]
fn an_ambient_pressure_does_not_turn_a_body() {
    // The error of implicit Euler grows with the rate 2 p dt/(ρ R²), 0.13, over a time of 1.5.
    let gain = |scheme: Scheme| spin(scheme.clone(), |_| 1.0) / spin(scheme, |_| 0.0) - 1.0;
    let [first, second] = [Arc::new(ImplicitEuler) as Scheme, second_order(0.0)].map(gain);
    assert!(first > 0.1 && second.abs() < 0.1 * first, "{first} {second}");
}

/// Returns the kinetic energy of an elastic disk at rest under a pressure of a fifth of Young's modulus, relative to
/// the largest one while the pressure rises.
fn shaking(rho_inf: f64) -> f64 {
    let setup = turning_disk(second_order(rho_inf), [0.1, 0.4, 0.0], |time| 16.0 * (time / 8.0).min(1.0));
    let (_, reports) = run(&setup, 60);
    let kinetic = |report: &StepReport<2>| report.bodies[0].balance.as_ref().expect("a body").kinetic_energy;
    kinetic(&reports[59]) / reports.iter().map(kinetic).fold(0.0, f64::max)
}

#[test]
fn a_large_ambient_pressure_does_not_shake_a_body() {
    // If the pressure acts at the cut alone, the vibration grows until a step fails.
    for (rho_inf, most) in [(0.0, 1e-6), (0.5, 1e-3)] {
        let rest = shaking(rho_inf);
        assert!(rest < most, "rho_inf {rho_inf}: {rest:e}");
    }
}

#[test]
fn half_and_mirrored_full_domain_give_the_same_solution() {
    // The run includes the contact: the gap starts slightly above the offset.
    let (half, full) = (falling_ball(0.8, 1.001, 1.0, false), falling_ball(0.8, 1.001, 1.0, true));
    let ((h, h_reports), (f, f_reports)) = (run(&half, 12), run(&full, 12));
    // Vertices of the given half come first in a mirrored mesh.
    let n = h.bodies[0].velocity().len();
    let scale = h.bodies[0].velocity().iter().map(|v| v.norm()).fold(0.0, f64::max);
    for (a, b) in h.bodies[0].velocity().iter().zip(&f.bodies[0].velocity()[..n]) {
        assert!((a - b).norm() < 1e-9 * scale, "{a} {b}");
    }
    // The fluid of the right half, vertex by vertex: a mirrored mesh has the vertices of the half first.
    let n_vertices = half.fluid.as_ref().expect("a fluid").background.n_vertices();
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    let pressure_scale = largest(&wet(&h).pressure);
    let mut n_compared = 0;
    for (k, &vertex) in wet(&h).space.vertices().iter().enumerate() {
        let j = wet(&f).space.vertices().iter().position(|&v| v == vertex).expect("the same vertex is wet");
        assert!(vertex.index() < n_vertices);
        assert!((wet(&h).velocity[k] - wet(&f).velocity[j]).norm() < 1e-8 * scale);
        assert!((wet(&h).pressure[k] - wet(&f).pressure[j]).abs() < 1e-8 * pressure_scale);
        n_compared += 1;
    }
    assert!(n_compared > 100);
    for (a, b) in h_reports.iter().zip(&f_reports) {
        let (a, b) = (&a.contacts[0], &b.contacts[0]);
        assert!((a.force[1] * 2.0 - b.force[1]).abs() <= 1e-9 * b.force[1].abs(), "{} {}", a.force, b.force);
        assert_eq!(a.is_active(), b.is_active());
    }
    assert!(h_reports.iter().any(|r| r.contacts[0].is_active()), "the ball touches the ground");
    let balance = f_reports[11].bodies[0].balance.expect("an elastic body");
    assert!(balance.centre_of_mass[0].abs() < 1e-9, "lateral drift {}", balance.centre_of_mass[0]);
}

#[test]
fn energy_never_grows_while_a_ball_falls_and_bounces() {
    let (_, reports) = run(&falling_ball(0.8, 1.2, 1.0, false), 60);
    assert!(reports.iter().any(|r| r.contacts[0].is_active()));
    let largest = reports.iter().map(|r| r.total_energy().abs()).fold(0.0, f64::max);
    for pair in reports.windows(2) {
        let gain = pair[1].total_energy() - pair[0].total_energy();
        assert!(gain <= 1e-8 * largest, "energy grows by {gain:e} of {largest:e}");
    }
}

#[test]
fn the_forces_on_the_ball_balance() {
    // Free fall, then contact; no support holds the ball vertically. The forces of the last two schemes contain those
    // of the pressure on the surface at the stage.
    for (scheme, alpha, is_round) in [
        (Arc::new(ImplicitEuler) as Scheme, 1.0, false),
        (Arc::new(ImplicitEuler), 1.0, true),
        (second_order(0.0), 1.0, true),
        (second_order(0.0), 0.97, false),
    ] {
        let mut setup =
            if is_round { falling_round_ball(0.8, 1.05, 1.0, 0.0) } else { falling_ball(0.8, 1.05, 1.0, false) };
        setup.scheme = scheme;
        fluid_of(&mut setup).alpha = alpha;
        let (_, reports) = run(&setup, 20);
        assert!(reports.iter().any(|r| r.contacts[0].is_active()));
        let start = reports[0].bodies[0].forces.expect("an elastic body");
        assert!(start.pressure[1] > 0.0 && start.inertia[1] < 0.0, "added mass reduces the acceleration");
        for report in &reports {
            let forces = report.bodies[0].forces.expect("an elastic body");
            let scale = forces.body_force.norm() + forces.contact.norm();
            assert!(forces.remainder()[1].abs() < 1e-6 * scale, "{forces:?}");
            assert_eq!(forces.contact[1] > 0.0, report.contacts[0].is_active());
        }
    }
}
