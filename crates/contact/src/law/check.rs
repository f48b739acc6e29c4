//! Consistency of a contact law with itself.

use super::{ContactLaw, ContactPoint};

/// Deviations found by [`check_law`], relative to the largest traction; all of them should be small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawCheck {
    /// Largest tension: traction must not be positive.
    pub tension: f64,
    /// Largest drop of traction where the gap grows.
    pub monotonicity: f64,
    /// Traction where the law says that there is no contact.
    pub inactive: f64,
    /// Derivative with respect to the gap against central differences, away from kinks.
    pub derivative: f64,
    /// Traction against central differences of the stored energy, where there is any.
    pub energy: f64,
}

impl LawCheck {
    /// The largest of the deviations.
    pub fn largest(&self) -> f64 {
        self.tension.max(self.monotonicity).max(self.inactive).max(self.derivative).max(self.energy)
    }
}

/// Checks a law at the given gaps, in increasing order: sign, monotonicity, derivatives.
pub fn check_law(law: &dyn ContactLaw, element_size: f64, gaps: &[f64]) -> LawCheck {
    let at = |gap: f64| ContactPoint { gap, element_size, normal_stress: 0.0 };
    let value = |gap: f64| law.traction(at(gap)).value;
    let energy = |gap: f64| law.energy_density(at(gap));
    let scale = gaps.iter().map(|&gap| value(gap).abs()).fold(f64::MIN_POSITIVE, f64::max);
    let stores = gaps.iter().any(|&gap| energy(gap) != 0.0);
    let step = f64::EPSILON.cbrt() * element_size;
    let mut check = LawCheck::default();
    let mut before = f64::NEG_INFINITY;
    for &gap in gaps {
        let traction = law.traction(at(gap));
        check.tension = check.tension.max(traction.value / scale);
        check.monotonicity = check.monotonicity.max((before - traction.value) / scale);
        before = traction.value;
        if !law.is_active(at(gap)) {
            check.inactive = check.inactive.max(traction.value.abs() / scale);
        }
        if law.is_active(at(gap - step)) == law.is_active(at(gap + step)) {
            let slope = (value(gap + step) - value(gap - step)) / (2.0 * step);
            check.derivative = check.derivative.max((slope - traction.d_gap).abs() * element_size / scale);
        }
        if stores {
            let slope = (energy(gap + step) - energy(gap - step)) / (2.0 * step);
            check.energy = check.energy.max((slope - traction.value).abs() / scale);
        }
    }
    check
}
