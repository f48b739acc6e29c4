//! Numbers with certain signs.

/// A number with a bound of its error.
pub(super) trait Number: Clone + Default {
    /// Converts a floating-point number exactly.
    fn of(value: f64) -> Self;
    /// Returns `a - b`, exact.
    fn difference(a: f64, b: f64) -> Self;
    /// Returns the sum of products `±a b` of at least one term; terms with the mark `true` are subtracted.
    fn sum_of_products(terms: &[(bool, &Self, &Self)]) -> Self;
    /// Returns the value, rounded.
    fn value(&self) -> f64;
    /// Returns the quotient, rounded.
    fn over(&self, other: &Self) -> f64;
    /// Returns the bound of the error of the value, in addition to one unit in its last place.
    fn doubt(&self) -> f64;

    /// Returns the value, if its sign is certain.
    fn certain(&self) -> Option<f64> {
        let (value, doubt) = (self.value(), self.doubt());
        (value.abs() > doubt || doubt == 0.0).then_some(value)
    }
}

/// A number of double the precision of `f64`, with the sum of the absolute values of its terms as the scale of
/// round-off.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Double {
    high: f64,
    low: f64,
    terms: f64,
}

/// Bound of the round-off of a determinant relative to the sum of its terms: less than 40 operations with at most 2⁻¹⁰⁰
/// each.
const ROUND_OFF: f64 = 1e-28;

impl Double {
    fn new(sum: (f64, f64), terms: f64) -> Self {
        Self { high: sum.0, low: sum.1, terms }
    }

    fn plus(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, lowest) = two_sum(self.low, other.low);
        let (high, error) = fast_two_sum(high, error + low);
        Self::new(fast_two_sum(high, error + lowest), self.terms + other.terms)
    }

    fn times(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let low = error + (self.high * other.low + self.low * other.high);
        Self::new(fast_two_sum(high, low), self.terms * other.terms)
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

    fn sum_of_products(terms: &[(bool, &Self, &Self)]) -> Self {
        terms.iter().fold(Self::default(), |sum, &(is_subtracted, a, b)| {
            let product = a.times(*b);
            let (high, low) = if is_subtracted { (-product.high, -product.low) } else { (product.high, product.low) };
            sum.plus(Self { high, low, ..product })
        })
    }

    fn value(&self) -> f64 {
        self.high
    }

    fn over(&self, other: &Self) -> f64 {
        self.high / other.high
    }

    fn doubt(&self) -> f64 {
        // Outside of this range, products may have overflowed or underflowed.
        let in_range = self.terms == 0.0 || (self.terms > 1e-200 && self.terms < 1e200);
        if in_range { ROUND_OFF * self.terms } else { f64::INFINITY }
    }
}

/// Returns the rounded sum and its error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let virtual_b = sum - a;
    (sum, (a - (sum - virtual_b)) + (b - virtual_b))
}

/// Returns the rounded sum and its error, for `|a| >= |b|`.
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Returns two halves of 26 bits whose sum is the number (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2²⁷ + 1
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

/// Returns the rounded product and its error (Dekker).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let error = product - a_high * b_high - a_low * b_high - a_high * b_low;
    (product, a_low * b_low - error)
}
