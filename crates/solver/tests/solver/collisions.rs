//! Collisions of rigid bodies in vacuum, and steps that follow the gap before them.

use std::sync::Arc;

use crate::fixture::*;
use solid_rigid::RigidBody;
use solver::algebra::Workspace;
use solver::algebra::time::ImplicitEuler;
use solver::contact::{CollisionLaw, ContactForm};
use solver::mesh::BodyId;
use solver::mesh::generate::structured_box;
use solver::{
    ApproachSteps, Contact, ContactObstacle, Observer, ObserverError, Setup, State, StepReport, StepView, TimeLoop,
};

/// Returns a body over the ground in vacuum with a law of collisions.
fn bouncing_body(body: RigidBody<2>, restitution: f64) -> Setup<2> {
    let mut setup = dry(vec![Arc::new(body)], 1e-2);
    setup.contacts.push(collision(&setup, 0, ground(), restitution));
    setup
}

/// Returns a contact with a law of collisions.
fn collision(setup: &Setup<2>, slave: u32, obstacle: ContactObstacle<2>, restitution: f64) -> Contact<2> {
    let form = ContactForm::new(CollisionLaw::new(restitution, 1e-3).expect("a law"), 0.1).expect("a contact");
    let facets = setup.bodies[slave as usize].surface().facets().collect();
    Contact::new(&setup.bodies, BodyId(slave), facets, form, obstacle).expect("a contact")
}

/// Returns a disk over the ground in vacuum with a law of collisions.
fn bouncing(restitution: f64, speed: f64, gravity: f64) -> Setup<2> {
    let mut disk = rigid("disk", &disk([0.0, 1.1], 1.0, 0.3), 2.0, V::new(0.0, -gravity));
    disk.initial_velocity = V::new(0.3, -speed);
    bouncing_body(disk, restitution)
}

/// Returns a block, 0.1 over the ground in vacuum, that is turned by an angle.
fn block(angle: f64, gravity: f64) -> RigidBody<2> {
    let (sin, cos) = angle.sin_cos();
    let mesh = structured_box::<2>([-1.0, -0.5], [1.0, 0.5], [4, 2]).expect("a box");
    let turned = |x: &P| P::new(cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]);
    let points: Vec<P> = mesh.vertices().iter().map(turned).collect();
    let lowest = points.iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
    let points = points.iter().map(|x| x + V::new(0.0, 0.1 - lowest)).collect();
    RigidBody::new("block", mesh.boundary(), points, 2.0, V::new(0.0, -gravity)).expect("a body")
}

#[test]
fn a_block_that_falls_flat_does_not_turn() {
    for (scheme, restitution) in [(Arc::new(ImplicitEuler) as Scheme, 0.8), (second_order(0.0), 1.0)] {
        let block = RigidBody { initial_velocity: V::new(0.2, -1.0), ..block(0.0, 0.0) };
        let (state, _) = run(&Setup { scheme, ..bouncing_body(block, restitution) }, 20);
        let motion = motion(&state, 0);
        assert!((motion.velocity - V::new(0.2, restitution)).norm() < 1e-7, "{:?}", motion.velocity);
        assert!(motion.spin[0].abs() < 1e-7, "{:?}", motion.spin);
    }
}

#[test]
fn bounces_of_a_block_on_its_corners_and_sides_make_no_energy() {
    for is_euler in [true, false] {
        let scheme: Scheme = if is_euler { Arc::new(ImplicitEuler) } else { second_order(0.0) };
        for restitution in [0.0, 0.5, 1.0] {
            let (dt, gravity) = (5e-3, 10.0);
            let setup = Setup { scheme: Arc::clone(&scheme), dt, ..bouncing_body(block(0.3, gravity), restitution) };
            let (_, reports) = run(&setup, 400);
            // With implicit Euler the weight acts along the motion after the collision for the whole step: half of its
            // momentum times the change of velocity is gained.
            for report in &reports {
                let of_weight = 0.51 * report.contacts[0].force[1] * gravity * dt.powi(2);
                let allowed = if is_euler { of_weight } else { 0.05 * of_weight } + 1e-9;
                let gained = -report.ledger.dissipation();
                assert!(gained < allowed, "restitution {restitution}: {gained:e} {allowed:e}");
            }
            let change: f64 = reports.iter().map(|report| report.ledger.change).sum();
            assert!(change < 0.0, "restitution {restitution}: {change:e}");
            let hits = reports.iter().filter(|report| report.contacts[0].n_active > 1).count();
            assert!(hits > 0, "restitution {restitution}: never on two points");
        }
    }
}

#[test]
fn a_collision_reverses_the_velocity_of_approach() {
    reverses_the_velocity(bouncing(0.8, 1.0, 0.0));
    for rho_inf in [0.0, 0.5] {
        reverses_the_velocity(Setup { scheme: second_order(rho_inf), ..bouncing(0.8, 1.0, 0.0) });
    }
}

/// Checks a disk that reaches the ground in step 10 and leaves it in the next one.
fn reverses_the_velocity(setup: Setup<2>) {
    let (state, reports) = run(&setup, 20);
    let motion = motion(&state, 0);
    assert!((motion.velocity - V::new(0.3, 0.8)).norm() < 1e-7, "{:?}", motion.velocity);
    assert!((motion.centre[1] - 1.08).abs() < 0.011, "{}", motion.centre[1]);
    let forces: Vec<f64> = reports.iter().map(|report| report.contacts[0].force[1]).collect();
    let impulse: f64 = forces.iter().map(|force| force * setup.dt).sum();
    let mass = reports[0].bodies[0].balance.expect("a mass").mass;
    assert!((impulse / (1.8 * mass) - 1.0).abs() < 1e-6 && forces.iter().filter(|force| **force != 0.0).count() == 1);
    // The ledger contains the work of the collision.
    let is_closed = |ledger: &solver::Ledger| ledger.other.abs() < 1e-5 * mass && ledger.defect().abs() < 1e-5 * mass;
    assert!(reports.iter().all(|report| is_closed(&report.ledger)));
}

#[test]
fn a_paddle_gives_a_disk_twice_its_speed() {
    for scheme in [Arc::new(ImplicitEuler) as Scheme, second_order(0.0)] {
        let resting = rigid("disk", &disk([0.0, 1.1], 1.0, 0.3), 2.0, V::zeros());
        let paddle = structured_box::<2>([-2.0, -0.5], [2.0, 0.0], [1, 1]).expect("a box");
        let paddle = prescribed(&paddle, |x, t| x + V::new(0.0, 0.5 * t), |_, _| V::new(0.0, 0.5));
        let mut setup = Setup { scheme, ..dry(vec![Arc::new(resting), paddle], 1e-2) };
        setup.contacts.push(collision(&setup, 0, against(1, &setup.bodies), 1.0));
        let (state, reports) = run(&setup, 30);
        assert!((motion(&state, 0).velocity - V::new(0.0, 1.0)).norm() < 1e-7, "{:?}", motion(&state, 0).velocity);
        let (mass, work) = (2.0 * reports[0].bodies[0].balance.expect("a mass").volume, |r: &StepReport<2>| r.ledger);
        assert!(reports.iter().map(work).all(|ledger| ledger.dissipation() > -1e-6 * mass));
        let given: f64 = reports.iter().map(work).map(|ledger| ledger.given_velocities).sum();
        assert!((given + 0.5 * mass).abs() < 1e-6 * mass, "{given} {mass}");
        // The impulse is the mass times one. At the stage the disk has the speed 1, and the paddle 0.5.
        let work = |end: usize| reports.iter().map(|report| report.contacts[0].powers[end] * setup.dt).sum::<f64>();
        assert!((work(0) - mass).abs() < 1e-6 * mass && (work(1) + 0.5 * mass).abs() < 1e-6 * mass);
    }
}

#[test]
fn a_block_that_rests_takes_part_in_the_collision_of_another() {
    let block = |name: &str, [half, low]: [f64; 2]| {
        let mesh = structured_box::<2>([-half, low], [half, low + 1.0], [2, 2]).expect("a box");
        rigid(name, &mesh, 2.0, V::zeros())
    };
    // The lower block is within the offset of the ground.
    let upper = RigidBody { initial_velocity: V::new(0.0, -1.0), ..block("upper", [0.5, 1.05]) };
    let mut setup = dry(vec![Arc::new(block("lower", [1.0, 5e-4])), Arc::new(upper)], 1e-2);
    setup.contacts.push(collision(&setup, 0, ground(), 0.0));
    setup.contacts.push(collision(&setup, 1, against(0, &setup.bodies), 0.0));
    let (state, reports) = run(&setup, 20);
    let speeds = [0, 1].map(|body| motion(&state, body).velocity.norm());
    assert!(speeds.iter().all(|speed| *speed < 1e-6), "{speeds:?}");
    let impulses =
        [0, 1].map(|contact: usize| reports.iter().map(|r| r.contacts[contact].force[1] * setup.dt).sum::<f64>());
    let momentum = reports[0].bodies[1].balance.expect("a mass").mass;
    assert!(impulses.iter().all(|impulse| (impulse / momentum - 1.0).abs() < 1e-6), "{impulses:?} {momentum}");
    assert!((motion(&state, 0).centre[1] - 0.5005).abs() < 1e-6, "{:?}", motion(&state, 0).centre);
}

/// Checks a light block that falls with one corner first onto a heavy block, which is held or free: the corner that is
/// pulled upwards by the turning block is released, whatever the mass below it is.
#[test]
fn a_light_block_bounces_off_a_heavy_one_as_off_the_ground() {
    let onto = |obstacle: Option<bool>| {
        let falling =
            RigidBody { initial_velocity: V::new(0.0, -1.0), initial_spin: [3.0, 0.0, 0.0], ..block(0.0, 0.0) };
        let Some(is_held) = obstacle else { return run(&bouncing_body(falling, 0.5), 30) };
        let anvil = structured_box::<2>([-3.0, -1.0], [3.0, 0.0], [1, 1]).expect("a box");
        let mut anvil = rigid("anvil", &anvil, 1e7, V::zeros());
        (anvil.held_axes, anvil.holds_rotation) = ([is_held; 2], is_held);
        let mut setup = dry(vec![Arc::new(falling), Arc::new(anvil)], 1e-2);
        setup.contacts.push(collision(&setup, 0, against(1, &setup.bodies), 0.5));
        run(&setup, 30)
    };
    let [ground, held, free] = [None, Some(true), Some(false)].map(|obstacle| motion(&onto(obstacle).0, 0));
    for found in [held, free] {
        assert!((found.velocity - ground.velocity).norm() < 1e-5, "{found:?} {ground:?}");
        assert!((found.spin[0] - ground.spin[0]).abs() < 1e-5, "{found:?} {ground:?}");
    }
    assert!(ground.velocity[1] > 0.1, "{ground:?}");
}

/// Gap at the start, length and end of every step.
struct Steps(Vec<(f64, f64, f64)>);

impl Observer<2> for Steps {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        if let Some(report) = view.report {
            let positions = view.previous.bodies[0].positions(view.setup.bodies[0].reference());
            let gap = positions.iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
            self.0.push((gap, report.substep.dt, view.state.time));
        }
        Ok(())
    }
}

#[test]
fn steps_follow_the_gap() {
    let mut setup = bouncing(1.0, 1.0, 0.0);
    setup.approach = Some(ApproachSteps { fraction: 0.1, smallest: 1e-4 });
    let mut steps = Steps(Vec::new());
    let state = State::initial(&setup).expect("a state");
    TimeLoop::new(&setup, state, Workspace::new()).run(20, &mut [&mut steps]).expect("steps");
    let Steps(seen) = steps;
    assert!((seen.last().expect("steps").2 - 0.2).abs() < 1e-12);
    let speed = 1.0_f64.hypot(0.3);
    for (gap, dt, _) in &seen {
        assert!(*dt <= (0.1 * gap / speed).max(1e-4) * 1.001 + 1e-15 && *dt > 0.4e-4, "gap {gap}, step {dt}");
    }
    assert!(seen.iter().any(|(_, dt, _)| *dt > 4.9e-3) && seen.iter().any(|(_, dt, _)| *dt < 2e-4));
}

/// Without an offset the gap falls by the same fraction in every substep, to the smallest length that time resolves.
#[test]
fn steps_that_follow_the_gap_advance_the_time() {
    let mut setup = bouncing(1.0, 1.0, 0.0);
    let form = ContactForm::new(CollisionLaw::new(1.0, 0.0).expect("a law"), 0.1).expect("a contact");
    let facets = setup.bodies[0].surface().facets().collect();
    setup.contacts = vec![Contact::new(&setup.bodies, BodyId(0), facets, form, ground()).expect("a contact")];
    setup.approach = Some(ApproachSteps { fraction: 0.3, smallest: 1e-30 });
    let mut steps = Steps(Vec::new());
    let state = State::initial(&setup).expect("a state");
    TimeLoop::new(&setup, state, Workspace::new()).run(20, &mut [&mut steps]).expect("steps");
    assert!(steps.0.windows(2).all(|pair| pair[1].2 > pair[0].2), "{}", steps.0.len());
    assert!(steps.0.len() < 2000, "{}", steps.0.len());
}
