//! The energy of every step is accounted for, term by term.

use std::sync::Arc;

use crate::fixture::*;
use solid_svk::Load;
use solver::algebra::time::ImplicitEuler;
use solver::algebra::{NewtonSettings, Workspace};
use solver::contact::{CollisionLaw, ContactForm};
use solver::mesh::BodyId;
use solver::mesh::generate::{Size, graded_box, structured_box};
use solver::{Contact, FluidBoundary, Ledger, Setup, Stabilisation, State, StepReport, Substep, advance};

/// Checks that every step closes to ten times the tolerance of Newton's method, relative to the largest energy or
/// change.
fn check_closed(setup: &Setup<2>, reports: &[StepReport<2>]) {
    let size = |report: &StepReport<2>| {
        let lines = report.ledger.lines();
        lines.iter().map(|(_, lost)| lost.abs()).chain([report.total_energy().abs()]).fold(0.0, f64::max)
    };
    let size = reports.iter().map(size).fold(0.0, f64::max);
    for (step, report) in reports.iter().enumerate() {
        let defect = report.ledger.defect();
        assert!(defect.abs() < 10.0 * setup.newton.tolerance * size, "step {step}: {defect:e} of {size:e}");
        assert!(report.ledger.other.abs() < 10.0 * setup.newton.tolerance * size, "{:e}", report.ledger.other);
    }
}

#[test]
fn a_ball_that_hits_the_ground_in_a_fluid() {
    const THROWN: (f64, usize) = (-30.0, 16);
    const FALLING: (f64, usize) = (0.0, 60);
    let (standard, papers) = (Stabilisation::STANDARD, Stabilisation::PAPER_44_2019);
    for (set, rho_inf, (speed, n)) in [
        (standard, None, THROWN),
        (papers, None, FALLING),
        (standard, Some(0.8), FALLING),
        (standard, Some(0.0), FALLING),
    ] {
        let mut setup = falling_ball_with(0.9, 0.3, 0.25, false, |ball| {
            ball.options.initial_velocity = Some(Arc::new(move |_| V::new(0.0, speed)));
        });
        setup.scheme = rho_inf.map_or(setup.scheme, second_order);
        fluid_of(&mut setup).stabilisation = set;
        fluid_of(&mut setup).convection = Some(solver::ConvectionForm::Skew);
        let (_, reports) = run(&setup, n);
        assert!(reports.iter().any(|report| report.contacts[0].is_active()), "{rho_inf:?} {set:?}");
        check_closed(&setup, &reports);
        let lost = |of: fn(&solver::Ledger) -> f64| reports.iter().map(|report| of(&report.ledger)).sum::<f64>();
        let mut dissipations = vec![
            lost(|l| l.viscosity),
            lost(|l| l.cip_velocity),
            lost(|l| l.cip_pressure),
            lost(|l| l.ghost_penalty),
            lost(|l| l.penalty_normal),
            lost(|l| l.penalty_tangential),
        ];
        let of_schemes = [lost(|l| l.fluid_scheme), lost(|l| l.body_scheme)];
        match rho_inf {
            None => dissipations.extend(of_schemes.into_iter().chain([lost(|l| l.contact)])),
            Some(_) => dissipations.extend(of_schemes),
        }
        let largest = reports.iter().map(|report| report.total_energy().abs()).fold(0.0, f64::max);
        for (step, report) in reports.iter().enumerate() {
            // Round-off of energies.
            assert!(
                report.ledger.dissipation() > -1e-9 * largest,
                "{rho_inf:?} {set:?}, step {step}: {:?}",
                report.ledger
            );
        }
        assert!(dissipations.iter().all(|lost| *lost > 0.0), "{dissipations:?}");
    }
}

#[test]
fn a_ball_of_quadratic_elements_that_hits_the_ground_in_a_fluid() {
    for rho_inf in [None, Some(0.8)] {
        let mut setup = falling_round_ball(0.9, 0.3, 0.25, -30.0);
        setup.scheme = rho_inf.map_or(setup.scheme, second_order);
        fluid_of(&mut setup).stabilisation = Stabilisation::STANDARD;
        let (_, reports) = run(&setup, 16);
        assert!(reports.iter().any(|report| report.contacts[0].is_active()));
        check_closed(&setup, &reports);
    }
}

/// Its step is solved again to a smaller tolerance, and the ledger is that of the second solution.
#[test]
fn a_disk_that_collides_with_the_ground_in_a_fluid() {
    for scheme in [Arc::new(ImplicitEuler) as Scheme, second_order(0.5)] {
        let background = graded_box::<2>([0.0, 0.0], [2.0, 2.0], &Size::uniform(0.15)).expect("a box");
        let mut setup = setup(fluid(background, 1.0, 0.05), 5e-3);
        (setup.scheme, setup.newton) = (scheme, NewtonSettings::new(1e-4));
        on_sides(&mut setup, &["bottom", "left", "right"], || FluidBoundary::NoSlip);
        on_sides(&mut setup, &["top"], || FluidBoundary::Open { traction: None, backflow: true });
        let mut disk = rigid("disk", &disk([1.0, 0.5], 0.4, 0.1), 4.0, V::new(0.0, -10.0));
        disk.initial_velocity = V::new(0.0, -2.0);
        setup.bodies.push(Arc::new(disk));
        let form = ContactForm::new(CollisionLaw::new(0.8, 0.06).expect("a law"), 0.1).expect("a contact");
        let facets = setup.bodies[0].surface().facets().collect();
        setup.contacts.push(Contact::new(&setup.bodies, BodyId(0), facets, form, ground()).expect("a contact"));
        let (_, reports) = run(&setup, 12);
        assert!(reports.iter().any(|report| report.contacts[0].is_active()));
        check_closed(&setup, &reports);
        let energy = reports.iter().map(|report| report.total_energy().abs()).fold(0.0, f64::max);
        // All terms are lines: round-off, which the weight of a collision amplifies.
        reports.iter().for_each(|report| assert!(report.ledger.other.abs() < 1e-8 * energy, "{}", report.ledger.other));
    }
}

#[test]
fn given_velocities_forces_and_loads_do_the_work() {
    let background = structured_box::<2>([0.0, 0.0], [2.0, 1.5], [14, 11]).expect("a box");
    let mut setup = setup(fluid(background, 1.2, 0.05), 0.02);
    fluid_of(&mut setup).body_force = Some(Arc::new(|x, t| V::new(1.0 + t, x[0])));
    on_sides(&mut setup, &["left"], || FluidBoundary::Velocity(Arc::new(|x, _| V::new(x[1] * (1.5 - x[1]), 0.1))));
    on_sides(&mut setup, &["bottom", "top"], || FluidBoundary::NoSlip);
    on_sides(&mut setup, &["right"], || FluidBoundary::Open {
        traction: Some(Arc::new(|x, n, _| n * (40.0 * (x[1] - 0.75)))),
        backflow: true,
    });
    setup.bodies.push(prescribed(
        &disk([0.5, 0.5], 0.2, 0.07),
        |x, t| x + V::new(0.8, 0.3) * t,
        |x, _| V::new(0.8 - x[1], 0.3 + x[0]),
    ));
    setup.bodies.push(Arc::new(rigid("rigid", &disk([0.6, 1.1], 0.15, 0.06), 1.7, V::new(0.0, -9.0))));
    let mut elastic = elastic("elastic", disk([1.3, 0.7], 0.25, 0.08), 0.9, 200.0, 800.0, V::new(1.0, -2.0));
    let facets = elastic.solid.boundary().facets().collect();
    elastic.options.loads.push(Load::pressure(facets, 3.0));
    setup.bodies.push(elastic.body());
    let (_, reports) = run(&setup, 8);
    check_closed(&setup, &reports);
    for line in [
        |l: &solver::Ledger| l.given_velocities,
        |l: &solver::Ledger| l.fluid_force,
        |l: &solver::Ledger| l.loads,
        |l: &solver::Ledger| l.open_boundary,
        |l: &solver::Ledger| l.backflow,
        |l: &solver::Ledger| l.convection,
        |l: &solver::Ledger| l.mortar,
        |l: &solver::Ledger| l.transfer,
    ] {
        assert!(reports.iter().any(|report| line(&report.ledger).abs() > 1e-6), "a line is empty");
    }
}

/// With `r = (1-ρ_∞)/(1+ρ_∞)` a step takes `3/4 r³ (M |Δt ΔA|² + J (Δt Δα)²)` from a rigid body, where `ΔA` and `Δα`
/// are the changes of acceleration and rate of the spin.
#[test]
fn the_scheme_takes_energy_from_a_rigid_body_by_its_formula() {
    let rho_inf = 0.5;
    let r: f64 = (1.0 - rho_inf) / (1.0 + rho_inf);
    let mesh = structured_box::<2>([0.0, 0.02], [1.0, 0.52], [4, 2]).expect("a box");
    let mut body = rigid("box", &mesh, 1.3, V::new(0.0, -10.0));
    (body.initial_velocity, body.initial_spin) = (V::new(0.3, -1.0), [1.5, 0.0, 0.0]);
    let (mass, facets) = (body.mass, body.boundary.facets().collect());
    let inertia = mass.inertia(&solver::mesh::Tensor::identity())[0][0];
    let mut setup = dry(vec![Arc::new(body)], 2e-3);
    setup.scheme = second_order(rho_inf);
    setup.contacts.push(contact_of(&setup.bodies, 0, facets, (1e4, 0.0, 0.1), ground()));
    let (mut state, mut work) = (State::initial(&setup).expect("a body"), Workspace::new());
    let mut largest = 0.0_f64;
    for step in 0..60 {
        let (next, report) = advance(&setup, &state, Substep::whole(setup.dt), &mut work).expect("a step");
        let (before, after) = (motion(&state, 0), motion(&next, 0));
        let of_centre = mass.mass * (after.acceleration - before.acceleration).norm_squared();
        let of_spin = inertia * (after.spin_rate[0] - before.spin_rate[0]).powi(2);
        // In the first step the acceleration is constant.
        let expected = if step == 0 { 0.0 } else { 0.75 * r.powi(3) * setup.dt.powi(2) * (of_centre + of_spin) };
        let found = report.ledger.body_scheme;
        assert!((found - expected).abs() < 1e-9, "step {step}: {found:e} {expected:e}");
        largest = largest.max(expected);
        state = next;
    }
    assert!(largest > 1e-3, "the ground changes the acceleration: {largest:e}");
}

#[test]
fn the_lines_contain_every_field() {
    // Different powers of two: their sum is exact, and shows which are in it. Without `..`, a new field is needed here
    // too.
    let mut next = 0.5;
    let mut value = || {
        next *= 2.0;
        next
    };
    let ledger = Ledger {
        change: 0.0,
        transfer: value(),
        fluid_scheme: value(),
        viscosity: value(),
        convection: value(),
        cip_velocity: value(),
        cip_pressure: value(),
        ghost_penalty: value(),
        film: value(),
        cavitation: value(),
        fluid_force: value(),
        open_boundary: value(),
        backflow: value(),
        mortar: value(),
        penalty_normal: value(),
        penalty_tangential: value(),
        body_scheme: value(),
        moved_surface: value(),
        loads: value(),
        contact: value(),
        given_velocities: value(),
        scheme_storage: value(),
        other: value(),
    };
    // Without a change of the energy the defect is the sum of all lines.
    assert_eq!(ledger.defect(), 2.0 * next - 1.0);
}

#[test]
fn a_moving_floor_works_on_the_body_that_it_lifts() {
    // The floor moves up with speed 2 and throws a block of mass 3. With generalised-α the law does not act at the
    // velocity of the stage, and its power differs from the change of its energy by 2e-5 of the energy at most.
    for (scheme, most) in [(Arc::new(ImplicitEuler) as Scheme, 1e-9), (second_order(0.5), 1e-3)] {
        let speed = 2.0;
        let floor = structured_box::<2>([-1.0, -1.0], [2.0, 0.0], [3, 1]).expect("a box");
        let block = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [2, 2]).expect("a box");
        let floor = prescribed(&floor, move |x, t| x + V::new(0.0, speed * t), move |_, _| V::new(0.0, speed));
        let block = rigid("block", &block, 3.0, V::zeros());
        let mut setup = Setup { scheme, ..dry(vec![floor, Arc::new(block)], 1e-3) };
        let obstacle = against(0, &setup.bodies);
        setup.contacts.push(contact(&setup.bodies, 1, (1e3, 0.0, 1.0), obstacle));
        let (_, reports) = run(&setup, 200);
        let (mut given, mut force_work) = (0.0, 0.0);
        for report in &reports {
            let ledger = &report.ledger;
            assert!(
                ledger.defect().abs() < 1e-9 && ledger.other.abs() < 1e-9 && ledger.dissipation() > -most,
                "{ledger:?}"
            );
            given += ledger.given_velocities;
            force_work += report.contacts[0].force[1] * speed * setup.dt;
        }
        let energy = reports[199].total_energy();
        assert!(energy > 0.9 * 0.5 * 3.0 * (2.0 * speed).powi(2), "the block leaves with twice the speed: {energy}");
        assert!((given + force_work).abs() < 0.02 * force_work, "{given} {force_work}");
    }
}

/// Checks that the changes of the parts of a first step add up: the block begins with an energy in its contact.
#[test]
fn the_parts_of_a_first_step_begin_with_the_energy_of_those_before() {
    let block = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [2, 2]).expect("a box");
    let mut setup = dry(vec![Arc::new(rigid("block", &block, 2.0, V::new(0.0, -10.0)))], 0.01);
    setup.contacts.push(contact(&setup.bodies, 0, (100.0, 0.1, 0.1), ground()));
    let (mut state, mut energies) = (State::initial(&setup).expect("a state"), Vec::new());
    let mut work = Workspace::new();
    for is_last in [false, false, true] {
        let (next, report) = advance(&setup, &state, Substep { dt: 0.01, is_last }, &mut work).expect("a step");
        energies.push((report.contacts[0].stored_energy, report.total_energy(), report.ledger.change));
        state = next;
    }
    for pair in energies.windows(2) {
        let [(_, before, _), (contact, after, change)] = pair else { panic!("two parts") };
        assert!(*contact > 1.0 && (after - before - change).abs() < 1e-10 * contact, "{energies:?}");
    }
}
