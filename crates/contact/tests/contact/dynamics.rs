//! Impacts: energy does not grow, momentum is exchanged.

use algebra::{BlockLayout, Contributions};
use contact::{ContactFacets, ContactForm, ContactPair, ContactReport, DeformableObstacle, Penalty, RigidPlane};
use mesh::{Point, Vector};
use solid_svk::boundary::tagged_facets;
use solid_svk::energy::BodyBalance;
use solid_svk::{LameParameters, SolidCells};

use crate::setting::{Body, Problem};

const SIZE: f64 = 0.1;
const DT: f64 = 1e-3;

fn stiff() -> LameParameters {
    LameParameters::new(2e4, 4e4).unwrap()
}

fn balance(body: &Body<2>) -> BodyBalance<2> {
    BodyBalance::new(&body.solid, &body.form, &body.displacement, &body.velocity)
}

#[test]
fn block_bounces_off_a_plane() {
    let (gamma, offset) = (1e6, 0.02);
    let mut layout = BlockLayout::new();
    let mut body = Body::block(&mut layout, [0.0, 0.05], [1.0, 1.05], [5, 5], stiff());
    body.velocity.fill(Vector::<2>::new(0.5, -10.0));
    let form = ContactForm::new(Penalty::new(gamma, offset).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets: Vec<_> = body.solid.boundary().facets().collect();
    let mut before = balance(&body).energy();
    let (mut touched, mut most_iterations) = (0, 0);
    for _ in 0..60 {
        let positions = body.positions();
        let step = body.step(DT);
        let cells = SolidCells::new(&body.solid, &body.form, &step, &layout, body.field).unwrap();
        let (linear, work) = (cells.linear(), cells.internal_work());
        let slave = body.contact(&positions, DT, &layout);
        let pair = ContactPair { slave, facets: &facets, obstacle: &plane, master: None, reach: 0.0 };
        let contact = ContactFacets::new(&form, pair).unwrap();
        let mut x = vec![0.0; layout.len()];
        body.solid.set_velocity(&layout, body.field, &body.velocity, &mut x).unwrap();
        let solids: Vec<&dyn Contributions> = vec![&linear, &work];
        let problem = Problem { layout: &layout, solids, contacts: vec![&contact], constraints: Default::default() };
        most_iterations = most_iterations.max(problem.solve(&mut x, 1e-10).iterations);
        let report = ContactReport::new(&contact, &x);
        let momentum = balance(&body).momentum;
        body.accept(&step, &layout, &x);
        let now = balance(&body);
        // Momentum changes by the impulse of contact.
        assert!((now.momentum - momentum - report.force * DT).norm() < 1e-8 * momentum.norm());
        let energy = now.energy() + report.stored_energy;
        assert!(energy < before * (1.0 + 1e-9), "{energy} {before}");
        before = energy;
        touched += usize::from(report.is_active());
    }
    let end = balance(&body);
    assert!(touched > 5 && most_iterations <= 20, "{touched} {most_iterations}");
    assert!(end.momentum[1] > 0.0 && (end.momentum[0] - 0.5).abs() < 1e-7);
    assert!(end.energy() < 50.125);
}

#[test]
fn two_blocks_collide() {
    let mut layout = BlockLayout::new();
    let mut bodies = [
        Body::block(&mut layout, [0.3, 1.03], [1.1, 1.8], [5, 5], stiff()),
        Body::block(&mut layout, [0.0, 0.0], [1.0, 1.0], [4, 4], stiff()),
    ];
    bodies[0].velocity.fill(Vector::<2>::new(0.0, -10.0));
    let form = ContactForm::new(Penalty::new(1e6, 0.02).unwrap(), SIZE).unwrap();
    let facets = [0, 1].map(|k: usize| bodies[k].solid.boundary().facets().collect::<Vec<_>>());
    let obstacle = DeformableObstacle::new(bodies[1].solid.boundary().clone(), facets[1].clone()).unwrap();
    let momentum = balance(&bodies[0]).momentum;
    let start = balance(&bodies[0]).energy();
    let mut touched = 0;
    for _ in 0..40 {
        let positions = [0, 1].map(|k: usize| bodies[k].positions());
        let steps = [0, 1].map(|k: usize| bodies[k].step(DT));
        let mut x = vec![0.0; layout.len()];
        for body in &bodies {
            body.solid.set_velocity(&layout, body.field, &body.velocity, &mut x).unwrap();
        }
        let cells = [0, 1].map(|k: usize| {
            SolidCells::new(&bodies[k].solid, &bodies[k].form, &steps[k], &layout, bodies[k].field).unwrap()
        });
        let linear = cells.map(|c| c.linear());
        let work = cells.map(|c| c.internal_work());
        let pair = ContactPair {
            slave: bodies[0].contact(&positions[0], DT, &layout),
            facets: &facets[0],
            obstacle: &obstacle,
            master: Some(bodies[1].contact(&positions[1], DT, &layout)),
            reach: 0.1,
        };
        let contact = ContactFacets::new(&form, pair).unwrap();
        let solids: Vec<&dyn Contributions> = vec![&linear[0], &linear[1], &work[0], &work[1]];
        Problem { layout: &layout, solids, contacts: vec![&contact], constraints: Default::default() }
            .solve(&mut x, 1e-10);
        touched += usize::from(ContactReport::new(&contact, &x).is_active());
        bodies.iter_mut().zip(&steps).for_each(|(body, step)| body.accept(step, &layout, &x));
        let total = balance(&bodies[0]).momentum + balance(&bodies[1]).momentum;
        assert!((total - momentum).norm() < 1e-7 * momentum.norm(), "{total} {momentum}");
    }
    assert!(touched > 3, "{touched}");
    assert!(balance(&bodies[1]).momentum[1] < balance(&bodies[0]).momentum[1]);
    assert!(balance(&bodies[0]).energy() + balance(&bodies[1]).energy() < start);
}

/// The impact benchmark of Doyen, Ern, Piperno 2011 (SIAM J. Sci. Comput. 33), with a speed so small that the bar is
/// linear: the floor pressure is `ρ c v0` while the front runs up the bar and back, and the bar leaves undeformed with
/// the speed with which it came.
#[test]
fn bar_hits_the_floor() {
    let (length, speed, dt) = (10.0, 0.1, 1.0 / 1500.0);
    let (wave, crossing) = (30.0, 1.0 / 3.0);
    let mut layout = BlockLayout::new();
    // E = 900, nu = 0.
    let lame = LameParameters::new(450.0, 0.0).unwrap();
    let mut body = Body::block(&mut layout, [0.0, 0.0], [0.5, length], [1, 40], lame);
    body.velocity.fill(Vector::<2>::new(0.0, -speed));
    let form = ContactForm::new(Penalty::new(1e4, 0.0).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets = tagged_facets(&body.solid, "bottom").unwrap();
    let n_steps = 1100;
    let (mut impulse, mut plateau, mut last_contact) = (0.0, Vec::new(), 0.0);
    for k in 1..=n_steps {
        let time = f64::from(k) * dt;
        let positions = body.positions();
        let step = body.step(dt);
        let cells = SolidCells::new(&body.solid, &body.form, &step, &layout, body.field).unwrap();
        let (linear, work) = (cells.linear(), cells.internal_work());
        let slave = body.contact(&positions, dt, &layout);
        let pair = ContactPair { slave, facets: &facets, obstacle: &plane, master: None, reach: 0.0 };
        let contact = ContactFacets::new(&form, pair).unwrap();
        let mut x = vec![0.0; layout.len()];
        body.solid.set_velocity(&layout, body.field, &body.velocity, &mut x).unwrap();
        let solids: Vec<&dyn Contributions> = vec![&linear, &work];
        let problem = Problem { layout: &layout, solids, contacts: vec![&contact], constraints: Default::default() };
        problem.solve(&mut x, 1e-9);
        let report = ContactReport::new(&contact, &x);
        let pressure = report.force[1] / 0.5;
        impulse += pressure * dt;
        if (0.25 * crossing..1.75 * crossing).contains(&time) {
            plateau.push(pressure);
        }
        if report.is_active() {
            last_contact = time;
        }
        body.accept(&step, &layout, &x);
    }
    let exact = wave * speed;
    assert!(plateau.iter().all(|p| (p - exact).abs() < 0.01 * exact), "{plateau:?}");
    assert!((last_contact - 2.0 * crossing).abs() < 0.03 * crossing, "{last_contact}");
    // Implicit Euler blunts the front that comes back.
    assert!((impulse - 2.0 * length * speed).abs() < 0.04 * impulse, "{impulse}");
}
