//! Bodies without a fluid, and time schemes of bodies with one.

mod fixture;

use std::sync::Arc;

use fixture::{P, V, elastic, elastic_mut, falling_ball, run, run_dry};
use solver::algebra::NewtonSettings;
use solver::contact::{ContactForm, DeformableObstacle, Penalty, RigidPlane};
use solver::dry::{DrySetup, DryState};
use solver::mesh::BodyId;
use solver::mesh::generate::structured_box;
use solver::solid_svk::boundary::{tagged_facets, vertices_of};
use solver::solid_svk::{GeneralisedAlpha, TimeScheme};
use solver::{Body, BodySupport, Contact, ContactObstacle, SupportKind};

fn second_order(rho_inf: f64) -> TimeScheme {
    TimeScheme::GeneralisedAlpha(GeneralisedAlpha::new(rho_inf).expect("from 0 to 1"))
}

/// A block on its way to the ground.
fn block(scheme: TimeScheme) -> DrySetup<2> {
    let mesh = structured_box::<2>([0.0, 0.0512], [1.0, 1.0512], [4, 4]).expect("a box");
    let mut body = elastic("block", mesh, 1.0, 2e4, 4e4, V::zeros());
    elastic_mut(&mut body).scheme = scheme;
    elastic_mut(&mut body).initial_velocity = Some(Arc::new(|_| V::new(0.5, -10.0)));
    let plane = RigidPlane::new(P::zeros(), V::new(0.0, -1.0)).expect("a plane");
    let contact = Contact {
        body: BodyId(0),
        facets: tagged_facets(&elastic_mut(&mut body).solid, "bottom").expect("a bottom"),
        form: ContactForm::new(Penalty::new(1e6, 0.0).expect("a law"), 0.1).expect("a contact"),
        obstacle: ContactObstacle::Rigid(Box::new(plane)),
    };
    DrySetup { bodies: vec![body], contacts: vec![contact], dt: 5e-4, newton: NewtonSettings::new(1e-10) }
}

#[test]
fn a_block_bounces_and_momentum_is_the_impulse_of_contact() {
    let loss = |scheme| {
        let setup = block(scheme);
        let (state, reports) = run_dry(&setup, 120);
        assert!(reports.iter().any(|r| r.contacts[0].is_active()), "the block touches the ground");
        assert!(!reports[119].contacts[0].is_active(), "and leaves it");
        let (before, after) = (DryState::initial(&setup).balance(&setup, 0), state.balance(&setup, 0));
        let (before, after) = (before.expect("elastic"), after.expect("elastic"));
        let impulse: V = reports.iter().map(|r| r.contacts[0].force * setup.dt).sum();
        assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-8);
        (1.0 - after.energy() / before.energy(), (after.momentum - before.momentum - impulse).norm() / impulse.norm())
    };
    let [euler, second_order] = [TimeScheme::ImplicitEuler, second_order(1.0)].map(loss);
    assert!(euler.1 < 1e-7 && second_order.1 < 1e-7, "{euler:?} {second_order:?}");
    assert!(euler.0 > second_order.0 && second_order.0 > -1e-9, "{euler:?} {second_order:?}");
}

#[test]
fn supports_hold() {
    for (scheme, n) in [(TimeScheme::ImplicitEuler, 10), (second_order(0.8), 10), (TimeScheme::QuasiStatic, 1)] {
        let mut setup = block(scheme);
        setup.contacts.clear();
        let body = elastic_mut(&mut setup.bodies[0]);
        body.initial_velocity = None;
        body.form.body_force.acceleration = V::new(0.0, -100.0);
        let top = vertices_of(&body.solid, &tagged_facets(&body.solid, "top").expect("a top"));
        body.supports.push(BodySupport { vertices: top.clone(), kind: SupportKind::Clamped });
        let (state, _) = run_dry(&setup, n);
        let displacement = &state.bodies[0].displacement;
        assert!(top.iter().all(|v| displacement[v.index()] == V::zeros()));
        assert!(displacement.iter().any(|d| d[1] < -1e-5));
    }
}

#[test]
fn equilibrium_is_what_vibrations_die_down_to() {
    let hang = |scheme, dt, n| {
        let mut setup = block(scheme);
        setup.contacts.clear();
        setup.dt = dt;
        let body = elastic_mut(&mut setup.bodies[0]);
        body.initial_velocity = None;
        body.form.body_force.acceleration = V::new(0.0, -100.0);
        let top = vertices_of(&body.solid, &tagged_facets(&body.solid, "top").expect("a top"));
        body.supports.push(BodySupport { vertices: top, kind: SupportKind::Clamped });
        run_dry(&setup, n).0.bodies.remove(0).displacement
    };
    let (rest, late) = (hang(TimeScheme::QuasiStatic, 1.0, 1), hang(TimeScheme::ImplicitEuler, 0.1, 4));
    let largest = rest.iter().map(|d| d.norm()).fold(0.0, f64::max);
    assert!(rest.iter().zip(&late).all(|(a, b)| (a - b).norm() < 1e-4 * largest));
}

#[test]
fn bodies_with_different_schemes_exchange_momentum() {
    let mut setup = block(second_order(0.8));
    let mesh = structured_box([0.0, -1.0], [1.0, 0.0], [3, 3]).expect("a box");
    let mut lower: Body<2> = elastic("lower", mesh, 1.0, 2e4, 4e4, V::zeros());
    let solid = &elastic_mut(&mut lower).solid;
    let top = tagged_facets(solid, "top").expect("a top");
    let surface = DeformableObstacle::new(solid.boundary().clone(), top).expect("a surface");
    setup.contacts[0].obstacle = ContactObstacle::Body { body: BodyId(1), surface };
    setup.bodies.push(lower);
    let momentum = |state: &DryState<2>| -> V {
        (0..2).map(|b| state.balance(&setup, b).expect("an elastic body").momentum).sum()
    };
    // While they touch; with rho_inf below 1 momentum lags behind the impulse by a part of a step.
    let (start, (state, reports)) = (DryState::initial(&setup), run_dry(&setup, 60));
    assert!(reports.iter().any(|r| r.contacts[0].is_active()));
    let lower = state.balance(&setup, 1).expect("an elastic body").momentum;
    assert!(lower[1] < -1.0 && (momentum(&state) - momentum(&start)).norm() < 0.05 * momentum(&start).norm());
}

#[test]
fn a_second_order_ball_in_the_fluid_gains_no_energy() {
    let setup = |scheme| {
        let mut setup = falling_ball(0.8, 1.2, 1.0, false);
        elastic_mut(&mut setup.bodies[0]).scheme = scheme;
        setup
    };
    let (euler, _) = run(&setup(TimeScheme::ImplicitEuler), 60);
    for rho_inf in [0.8, 1.0] {
        let (state, reports) = run(&setup(second_order(rho_inf)), 60);
        assert!(reports.iter().any(|r| r.contacts[0].is_active()));
        let start = reports[0].total_energy();
        let largest = reports.iter().map(|r| r.total_energy()).fold(f64::NEG_INFINITY, f64::max);
        assert!(largest <= start * (1.0 + 1e-6), "{rho_inf}: energy grows from {start} to {largest}");
        // The same fall, and a little more of a rebound.
        let [a, b] = [&euler, &state].map(|s| s.bodies[0].displacement.iter().map(|d| d[1]).sum::<f64>());
        assert!((a - b).abs() < 0.1 * a.abs(), "{rho_inf}: {a} {b}");
    }
}
