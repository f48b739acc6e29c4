//! An impact with a known course.

use algebra::time::ImplicitEuler;
use body::Body;
use contact::{ContactForm, PenaltyLaw, RigidPlane};
use mesh::{Point, Vector};
use solid_svk::LameParameters;
use solid_svk::supports::tagged_facets;

use crate::setting::{Scene, block, with_velocity};

const SIZE: f64 = 0.1;

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
    let form = ContactForm::new(PenaltyLaw::new(1e4, 0.0).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets = tagged_facets(bodies[0].solid(), "bottom").unwrap();
    let mut states = vec![bodies[0].initial()];
    let n_steps = 1100;
    let (mut impulse, mut plateau, mut last_contact) = (0.0, Vec::new(), 0.0);
    for k in 1..=n_steps {
        let time = f64::from(k) * dt;
        let scene = Scene::new(&bodies, &states, &ImplicitEuler, dt);
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
