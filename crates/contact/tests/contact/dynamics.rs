//! Impacts: energy does not grow, momentum is exchanged.

use body::{Balance, Body, BodyState};
use contact::{ContactForm, DeformableObstacle, Penalty, RigidPlane};
use mesh::{Point, Vector};
use solid_svk::supports::tagged_facets;
use solid_svk::{ElasticBody, LameParameters};

use crate::setting::{Scene, block, with_velocity};

const SIZE: f64 = 0.1;
const DT: f64 = 1e-3;

fn stiff() -> LameParameters {
    LameParameters::new(2e4, 4e4).unwrap()
}

fn balance(body: &ElasticBody<2>, state: &BodyState<2>) -> Balance<2> {
    body.balance(state).unwrap()
}

#[test]
fn block_bounces_off_a_plane() {
    let (gamma, offset) = (1e6, 0.02);
    let velocity = with_velocity(Vector::<2>::new(0.5, -10.0));
    let bodies = [block([0.0, 0.05], [1.0, 1.05], [5, 5], stiff(), velocity)];
    let form = ContactForm::new(Penalty::new(gamma, offset).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets: Vec<_> = bodies[0].surface().facets().collect();
    let mut states = vec![bodies[0].start()];
    let mut before = balance(&bodies[0], &states[0]).energy();
    let (mut touched, mut most_iterations) = (0, 0);
    for _ in 0..60 {
        let scene = Scene::new(&bodies, &states, DT);
        let (report, end, iterations) = scene.advance(scene.pair(&form, &facets, &plane), 0.0, 1e-10);
        most_iterations = most_iterations.max(iterations);
        let momentum = balance(&bodies[0], &states[0]).momentum;
        let now = balance(&bodies[0], &end[0]);
        // Momentum changes by the impulse of contact.
        assert!((now.momentum - momentum - report.force * DT).norm() < 1e-8 * momentum.norm());
        let energy = now.energy() + report.stored_energy;
        assert!(energy < before * (1.0 + 1e-9), "{energy} {before}");
        before = energy;
        touched += usize::from(report.is_active());
        drop(scene);
        states = end;
    }
    let end = balance(&bodies[0], &states[0]);
    assert!(touched > 5 && most_iterations <= 20, "{touched} {most_iterations}");
    assert!(end.momentum[1] > 0.0 && (end.momentum[0] - 0.5).abs() < 1e-7);
    assert!(end.energy() < 50.125);
}

#[test]
fn two_blocks_collide() {
    let bodies = [
        block([0.3, 1.03], [1.1, 1.8], [5, 5], stiff(), with_velocity(Vector::<2>::new(0.0, -10.0))),
        block([0.0, 0.0], [1.0, 1.0], [4, 4], stiff(), with_velocity(Vector::zeros())),
    ];
    let form = ContactForm::new(Penalty::new(1e6, 0.02).unwrap(), SIZE).unwrap();
    let facets = bodies.each_ref().map(|body| body.surface().facets().collect::<Vec<_>>());
    let obstacle = DeformableObstacle::new(bodies[1].surface().clone(), facets[1].clone()).unwrap();
    let mut states: Vec<_> = bodies.iter().map(Body::start).collect();
    let of = |states: &[BodyState<2>]| [0, 1].map(|k| balance(&bodies[k], &states[k]));
    let [Balance { momentum, .. }, _] = of(&states);
    let start = of(&states)[0].energy();
    let mut touched = 0;
    for _ in 0..40 {
        let scene = Scene::new(&bodies, &states, DT);
        let (report, end, _) = scene.advance(scene.pair(&form, &facets[0], &obstacle), 0.1, 1e-10);
        touched += usize::from(report.is_active());
        drop(scene);
        states = end;
        let total = of(&states).map(|balance| balance.momentum).into_iter().sum::<Vector<2>>();
        assert!((total - momentum).norm() < 1e-7 * momentum.norm(), "{total} {momentum}");
    }
    assert!(touched > 3, "{touched}");
    let [upper, lower] = of(&states);
    assert!(lower.momentum[1] < upper.momentum[1]);
    assert!(upper.energy() + lower.energy() < start);
}

/// The impact benchmark of Doyen, Ern, Piperno 2011 (SIAM J. Sci. Comput. 33), with a speed so small that the bar is
/// linear: the floor pressure is `ρ c v0` while the front runs up the bar and back, and the bar leaves undeformed with
/// the speed with which it came.
#[test]
fn bar_hits_the_floor() {
    let (length, speed, dt) = (10.0, 0.1, 1.0 / 1500.0);
    let (wave, crossing) = (30.0, 1.0 / 3.0);
    // E = 900, nu = 0.
    let lame = LameParameters::new(450.0, 0.0).unwrap();
    let velocity = with_velocity(Vector::<2>::new(0.0, -speed));
    let bodies = [block([0.0, 0.0], [0.5, length], [1, 40], lame, velocity)];
    let form = ContactForm::new(Penalty::new(1e4, 0.0).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets = tagged_facets(bodies[0].solid(), "bottom").unwrap();
    let mut states = vec![bodies[0].start()];
    let n_steps = 1100;
    let (mut impulse, mut plateau, mut last_contact) = (0.0, Vec::new(), 0.0);
    for k in 1..=n_steps {
        let time = f64::from(k) * dt;
        let scene = Scene::new(&bodies, &states, dt);
        let (report, end, _) = scene.advance(scene.pair(&form, &facets, &plane), 0.0, 1e-9);
        let pressure = report.force[1] / 0.5;
        impulse += pressure * dt;
        if (0.25 * crossing..1.75 * crossing).contains(&time) {
            plateau.push(pressure);
        }
        if report.is_active() {
            last_contact = time;
        }
        drop(scene);
        states = end;
    }
    let exact = wave * speed;
    assert!(plateau.iter().all(|p| (p - exact).abs() < 0.01 * exact), "{plateau:?}");
    assert!((last_contact - 2.0 * crossing).abs() < 0.03 * crossing, "{last_contact}");
    // Implicit Euler blunts the front that comes back.
    assert!((impulse - 2.0 * length * speed).abs() < 0.04 * impulse, "{impulse}");
}
