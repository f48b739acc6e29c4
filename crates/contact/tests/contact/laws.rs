//! Laws of the tests against their own derivatives.

use contact::ContactPoint;
use contact::law::check_law;

use crate::setting::Coulomb;

const SIZE: f64 = 0.1;

/// Returns points on both sides of the offset, in the order of increasing gaps.
fn points(slip: [f64; 2]) -> Vec<ContactPoint> {
    (-20..20)
        .map(|k| ContactPoint {
            gap: 0.013 * f64::from(k) + 0.001,
            slip,
            size: SIZE,
            dt: 1e-2,
            ..ContactPoint::default()
        })
        .collect()
}

#[test]
fn a_law_with_friction_is_consistent() {
    let law = Coulomb { gamma: 200.0, offset: 0.08, friction: 0.4, transition: 0.02 };
    for slip in [[0.0; 2], [0.013, 0.0], [-0.004, 0.02], [0.05, -0.09]] {
        let check = check_law(&law, &points(slip));
        assert!(check.largest() < 1e-7, "{check:?}");
    }
}
