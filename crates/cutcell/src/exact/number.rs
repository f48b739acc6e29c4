//! What the formulas of planes and corners need of a number.

use super::integer::Exact;

/// A number that remembers enough to say when its sign is certain.
pub(super) trait Number: Clone + Default {
    /// The number itself.
    fn of(value: f64) -> Self;
    /// `a - b`, not rounded.
    fn difference(a: f64, b: f64) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    /// The value, rounded.
    fn value(&self) -> f64;
    /// How wrong the value may be, beyond one unit in its last place.
    fn doubt(&self) -> f64;

    /// The value, if its sign is certain.
    fn certain(&self) -> Option<f64> {
        let (value, doubt) = (self.value(), self.doubt());
        (value.abs() > doubt || doubt == 0.0).then_some(value)
    }
}

impl Number for Exact {
    fn of(value: f64) -> Self {
        Self::of(value)
    }

    fn difference(a: f64, b: f64) -> Self {
        Self::of(a).minus(&Self::of(b))
    }

    fn plus(&self, other: &Self) -> Self {
        self.plus(other)
    }

    fn minus(&self, other: &Self) -> Self {
        self.minus(other)
    }

    fn times(&self, other: &Self) -> Self {
        self.times(other)
    }

    fn value(&self) -> f64 {
        self.value()
    }

    fn doubt(&self) -> f64 {
        0.0
    }
}

/// A number of twice the precision, with the sum of the absolute values of the terms that it was made of: round-off is
/// a fraction of that.
#[derive(Clone, Copy, Default)]
pub(super) struct Double {
    high: f64,
    low: f64,
    terms: f64,
}

/// Bound on the round-off of a determinant relative to the sum of its terms: each of its fewer than 40 operations adds
/// at most 2⁻¹⁰⁰.
const ROUND_OFF: f64 = 1e-28;

impl Double {
    fn new(sum: (f64, f64), terms: f64) -> Self {
        Self { high: sum.0, low: sum.1, terms }
    }
}

impl Number for Double {
    fn of(value: f64) -> Self {
        Self::new((value, 0.0), value.abs())
    }

    fn difference(a: f64, b: f64) -> Self {
        let difference = two_sum(a, -b);
        Self::new(difference, difference.0.abs())
    }

    fn plus(&self, other: &Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, lowest) = two_sum(self.low, other.low);
        let (high, error) = fast_two_sum(high, error + low);
        Self::new(fast_two_sum(high, error + lowest), self.terms + other.terms)
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&Self { high: -other.high, low: -other.low, terms: other.terms })
    }

    fn times(&self, other: &Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let low = error + (self.high * other.low + self.low * other.high);
        Self::new(fast_two_sum(high, low), self.terms * other.terms)
    }

    fn value(&self) -> f64 {
        self.high
    }

    fn doubt(&self) -> f64 {
        // Beyond that, products may have left the range of the exponent.
        let in_range = self.terms == 0.0 || (self.terms > 1e-200 && self.terms < 1e200);
        if in_range { ROUND_OFF * self.terms } else { f64::INFINITY }
    }
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let virtual_b = sum - a;
    (sum, (a - (sum - virtual_b)) + (b - virtual_b))
}

/// For `|a| >= |b|`.
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2²⁷ + 1
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let error = product - a_high * b_high - a_low * b_high - a_high * b_low;
    (product, a_low * b_low - error)
}
