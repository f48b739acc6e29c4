//! Bodies without a fluid, and time schemes of bodies with one.

use std::sync::Arc;

use crate::fixture::*;
use solid_svk::{LameParameters, LinearElastic, SolidForm, SupportKind};
use solver::algebra::NewtonSettings;
use solver::algebra::time::{ImplicitEuler, QuasiStatic};
use solver::body::Balance;
use solver::contact::{ContactForm, DeformableObstacle, NitscheLaw};
use solver::mesh::BodyId;
use solver::mesh::generate::structured_box;
use solver::{Contact, ContactObstacle, Setup, State, StepReport};

fn balance(setup: &Setup<2>, state: &State<2>, body: usize) -> Balance<2> {
    setup.bodies[body].balance(&state.bodies[body]).expect("an elastic body")
}

/// Returns a falling block.
fn block() -> Elastic<2> {
    let mesh = structured_box::<2>([0.0, 0.0512], [1.0, 1.0512], [4, 4]).expect("a box");
    let mut body = elastic("block", mesh, 1.0, 2e4, 4e4, V::zeros());
    body.options.initial_velocity = Some(Arc::new(|_| V::new(0.5, -10.0)));
    body
}

/// Returns a block at rest that hangs from its top.
fn hanging() -> Elastic<2> {
    let mut body = block();
    body.options.initial_velocity = None;
    body.form.body_force.acceleration = V::new(0.0, -100.0);
    body.support("top", SupportKind::Clamped);
    body
}

fn in_vacuum(body: Elastic<2>, scheme: Scheme) -> Setup<2> {
    Setup { newton: NewtonSettings::new(1e-10), scheme, ..dry(vec![body.body()], 5e-4) }
}

#[test]
fn a_block_bounces_and_momentum_is_the_impulse_of_contact() {
    let loss = |scheme: Scheme, is_euler: bool| {
        let mut block = block();
        if !is_euler {
            // The midpoint rule conserves quadratic energies; contact loses or makes energy where its area changes.
            let material = LinearElastic::new(LameParameters { mu: 2e4, lambda: 0.0 });
            block.form = SolidForm::new(1.0, material, V::zeros()).expect("a form");
        }
        let bottom = block.side("bottom");
        let mut setup = in_vacuum(block, scheme);
        setup.contacts.push(contact_of(&setup.bodies, 0, bottom, (1e6, 0.0, 0.1), ground()));
        let (state, reports) = run(&setup, 120);
        assert!(reports.iter().filter(|r| r.contacts[0].is_active()).count() > 5, "the block touches the ground");
        assert!(!reports[119].contacts[0].is_active(), "and leaves it");
        assert!(reports.iter().all(|r| r.newton.iterations <= 20));
        // Momentum changes by the force of contact in each step.
        let remainder = |r: &StepReport<2>| r.bodies[0].forces.expect("an elastic body").remainder().norm();
        assert!(reports.iter().all(|r| remainder(r) * setup.dt < 1e-7));
        if is_euler {
            assert!(reports.windows(2).all(|pair| pair[1].total_energy() < pair[0].total_energy() * (1.0 + 1e-9)));
        }
        let start = State::initial(&setup).expect("bodies");
        let (before, after) = (balance(&setup, &start, 0), balance(&setup, &state, 0));
        let impulse: V = reports.iter().map(|r| r.contacts[0].force * setup.dt).sum();
        if !is_euler {
            let by_scheme = reports.iter().map(|r| r.ledger.body_scheme.abs()).fold(0.0, f64::max);
            assert!(by_scheme < 1e-12 * before.energy(), "{by_scheme:e}");
        }
        assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-8);
        (1.0 - after.energy() / before.energy(), (after.momentum - before.momentum - impulse).norm() / impulse.norm())
    };
    let (euler, second_order) = (loss(Arc::new(ImplicitEuler), true), loss(second_order(1.0), false));
    assert!(euler.1 < 1e-7 && second_order.1 < 1e-7, "{euler:?} {second_order:?}");
    assert!(euler.0 > 0.1 && second_order.0.abs() < 1e-3, "{euler:?} {second_order:?}");
}

#[test]
fn supports_hold() {
    let schemes: [(Scheme, usize); 3] =
        [(Arc::new(ImplicitEuler), 10), (second_order(0.8), 10), (Arc::new(QuasiStatic), 1)];
    for (scheme, n) in schemes {
        let body = hanging();
        let top = body.options.supports[0].vertices.clone();
        let (state, _) = run(&in_vacuum(body, scheme), n);
        let displacement = state.bodies[0].displacement();
        assert!(top.iter().all(|v| displacement[v.index()] == V::zeros()));
        assert!(displacement.iter().any(|d| d[1] < -1e-5));
    }
}

#[test]
fn vibrations_die_down_to_the_equilibrium() {
    let hang = |scheme: Scheme, dt: f64, n: usize| {
        let setup = Setup { dt, ..in_vacuum(hanging(), scheme) };
        run(&setup, n).0.bodies[0].displacement().to_vec()
    };
    let (rest, late) = (hang(Arc::new(QuasiStatic), 1.0, 1), hang(Arc::new(ImplicitEuler), 0.1, 4));
    let largest = rest.iter().map(|d| d.norm()).fold(0.0, f64::max);
    assert!(rest.iter().zip(&late).all(|(a, b)| (a - b).norm() < 1e-4 * largest));
}

/// A body at rest moves by the rounding of its positions only. Newton's tolerance relative to this motion cannot be
/// reached.
#[test]
fn a_body_at_rest_does_not_stop_a_run() {
    let (state, reports) = run(&Setup { dt: 0.1, ..in_vacuum(hanging(), Arc::new(ImplicitEuler)) }, 60);
    assert!(state.bodies[0].largest_speed() < 1e-12 && reports[59].newton.iterations <= 3);
}

/// Checks Nitsche's law with a scheme of second order: the gap does not alternate from step to step, which would make
/// energy, and a stiffer law has less penetration.
#[test]
fn contact_without_stored_energy_is_stable() {
    let penetration = |gamma_0: f64| {
        let mut block = block();
        let material = LinearElastic::new(LameParameters { mu: 2e4, lambda: 4e4 });
        block.form = SolidForm::new(1.0, material, V::zeros()).expect("a form");
        let bottom = block.side("bottom");
        let mut setup = in_vacuum(block, second_order(0.0));
        let form = ContactForm::new(NitscheLaw::new(gamma_0, 0.0, 0.0).expect("a law"), 0.1).expect("a contact");
        let contact = Contact::new(&setup.bodies, BodyId(0), bottom, form, ground()).expect("a contact");
        setup.contacts.push(contact);
        let (_, reports) = run(&setup, 120);
        let start = balance(&setup, &State::initial(&setup).expect("bodies"), 0).energy();
        // Released contact returns some of the energy that closing it took.
        let made: f64 = reports.iter().map(|r| (-r.ledger.dissipation()).max(0.0)).sum();
        assert!(made < 5e-3 * start && !reports[119].contacts[0].is_active(), "{made:e} of {start:e}");
        reports.iter().map(|r| r.contacts[0].largest_penetration).fold(0.0, f64::max)
    };
    let (soft, stiff) = (penetration(10.0), penetration(1000.0));
    assert!(stiff < 0.1 * soft, "{soft:e} {stiff:e}");
}

#[test]
fn bodies_exchange_momentum() {
    let schemes: [Scheme; 2] = [Arc::new(ImplicitEuler), second_order(0.8)];
    for scheme in schemes {
        let upper = block();
        let bottom = upper.side("bottom");
        let mut setup = in_vacuum(upper, scheme);
        let mesh = structured_box([0.0, -1.0], [1.0, 0.0], [3, 3]).expect("a box");
        let lower = elastic("lower", mesh, 1.0, 2e4, 4e4, V::zeros());
        let surface = DeformableObstacle::new(lower.solid.boundary().clone(), lower.side("top")).expect("a surface");
        setup.bodies.push(lower.body());
        let obstacle = ContactObstacle::Body { body: BodyId(1), surface };
        setup.contacts.push(contact_of(&setup.bodies, 0, bottom, (1e6, 0.0, 0.1), obstacle));
        let of = |state: &State<2>| [0, 1].map(|b| balance(&setup, state, b));
        let (start, (state, reports)) = (of(&State::initial(&setup).expect("bodies")), run(&setup, 60));
        assert!(reports.iter().any(|r| r.contacts[0].is_active()));
        let momentum = start[0].momentum;
        for report in &reports {
            let total: V = report.bodies.iter().map(|body| body.balance.expect("an elastic body").momentum).sum();
            assert!((total - momentum).norm() < 1e-7 * momentum.norm(), "{total} {momentum}");
        }
        let [upper, lower] = of(&state);
        assert!(lower.momentum[1] < -1.0 && lower.momentum[1] < upper.momentum[1]);
        assert!(upper.energy() + lower.energy() < start[0].energy());
    }
}

#[test]
fn a_second_order_ball_in_the_fluid_gains_no_energy() {
    let setup = |scheme: Scheme| Setup { scheme, ..falling_ball(0.8, 1.2, 1.0, false) };
    let (euler, _) = run(&setup(Arc::new(ImplicitEuler)), 60);
    for rho_inf in [0.8, 1.0] {
        let (state, reports) = run(&setup(second_order(rho_inf)), 60);
        assert!(reports.iter().any(|r| r.contacts[0].is_active()));
        let start = reports[0].total_energy();
        let largest = reports.iter().map(|r| r.total_energy()).fold(f64::NEG_INFINITY, f64::max);
        assert!(largest <= start * (1.0 + 1e-6), "{rho_inf}: energy grows from {start} to {largest}");
        // The same fall, and a slightly higher rebound.
        let [a, b] = [&euler, &state].map(|s| s.bodies[0].displacement().iter().map(|d| d[1]).sum::<f64>());
        assert!((a - b).abs() < 0.1 * a.abs(), "{rho_inf}: {a} {b}");
    }
}

#[test]
fn gravity_that_varies_in_time_is_a_load() {
    // Implicit Euler takes the gravity at the end of the step, generalised-α with this radius a third of a step before
    // it.
    for (scheme, before_end) in [(Arc::new(ImplicitEuler) as Scheme, 0.0), (second_order(0.5), 1.0 / 3.0)] {
        let mesh = structured_box::<2>([0.0, 0.0], [2.0, 1.0], [2, 1]).expect("a box");
        let gravity: solver::body::VectorInTime<2> = Arc::new(|t: f64| V::new(2.0, -3.0) * t.cos());
        let mut elastic = elastic("elastic", mesh.clone(), 4.0, 1e2, 1e2, V::zeros());
        elastic.options.variable_gravity = Some(gravity.clone());
        let mut rigid = rigid("rigid", &mesh, 4.0, V::zeros());
        rigid.variable_gravity = Some(gravity.clone());
        let (n, dt, mass) = (20, 0.1, 8.0);
        let setup = Setup { scheme, ..dry(vec![elastic.body(), Arc::new(rigid)], dt) };
        let (_, reports) = run(&setup, n);
        for (k, report) in reports.iter().enumerate() {
            let gravity = gravity((k + 1) as f64 * dt - before_end * dt);
            for body in &report.bodies {
                let balance = body.balance.expect("a movable body");
                assert_eq!(balance.potential_energy, 0.0);
                let forces = body.forces.expect("a movable body");
                assert!((forces.body_force - gravity * mass).norm() < 1e-12 && forces.remainder().norm() < 1e-9);
            }
            let ledger = &report.ledger;
            assert!(
                ledger.defect().abs() < 1e-9 && ledger.other.abs() < 1e-9 && ledger.dissipation() > -1e-9,
                "{ledger:?}"
            );
            if before_end == 0.0 {
                let velocity = report.bodies[0].balance.expect("a movable body").momentum / mass;
                let work = -2.0 * dt * mass * gravity.dot(&velocity);
                assert!((ledger.loads - work).abs() < 1e-9, "{ledger:?}");
            }
        }
        // Velocities are integrals of the gravity, up to the error of the scheme.
        let end = V::new(2.0, -3.0) * (n as f64 * dt).sin();
        for body in &reports[n - 1].bodies {
            let velocity = body.balance.expect("a movable body").momentum / mass;
            let error = (velocity - end).norm();
            assert!(error < if before_end == 0.0 { 0.3 } else { 0.02 }, "{velocity} {end}");
        }
    }
}
