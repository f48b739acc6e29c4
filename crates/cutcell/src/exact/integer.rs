//! Exact arithmetic: sums, differences and products of floating-point numbers without rounding.

use smallvec::{SmallVec, smallvec};

use super::number::Number;

/// Digits to the base 2⁶⁴, the lowest first.
type Digits = SmallVec<[u64; 4]>;

/// An integer times a power of 2⁶⁴, of any size. Contains all sums and products of floating-point numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Exact {
    is_negative: bool,
    /// Digits without zeros at either end; empty for zero.
    digits: Digits,
    /// Power of the lowest digit.
    exponent: i32,
}

/// Returns a floating-point number as an integer times a power of 2.
fn decompose(value: f64) -> (i128, i32) {
    let bits = value.to_bits();
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (mantissa, power) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if value.is_sign_negative() { -i128::from(mantissa) } else { i128::from(mantissa) }, power)
}

impl Exact {
    fn new(is_negative: bool, digits: &[u64], exponent: i32) -> Self {
        let Some(first) = digits.iter().position(|d| *d != 0) else { return Self::default() };
        let end = digits.iter().rposition(|d| *d != 0).map_or(0, |last| last + 1);
        Self { is_negative, digits: Digits::from_slice(&digits[first..end]), exponent: exponent + first as i32 }
    }

    /// Creates a number from an integer below 2¹²⁶ times a power of 2.
    fn of_integer(value: i128, power: i32) -> Self {
        let (magnitude, shift) = (value.unsigned_abs(), power.rem_euclid(64));
        let low = magnitude << shift;
        let high = if shift == 0 { 0 } else { (magnitude >> (128 - shift)) as u64 };
        Self::new(value < 0, &[low as u64, (low >> 64) as u64, high], power.div_euclid(64))
    }

    /// Returns the leading digits with the sign, and the power of 2⁶⁴ of their unit.
    fn leading(&self) -> (f64, i32) {
        let base = 2.0_f64.powi(64);
        let magnitude = self.digits.iter().rev().take(3).fold(0.0, |value, &digit| value * base + digit as f64);
        let power = self.exponent + self.digits.len().saturating_sub(3) as i32;
        (if self.is_negative { -magnitude } else { magnitude }, power)
    }
}

impl Number for Exact {
    fn of(value: f64) -> Self {
        let (mantissa, power) = decompose(value);
        Self::of_integer(mantissa, power)
    }

    fn difference(a: f64, b: f64) -> Self {
        let ((x, p), (y, q)) = (decompose(a), decompose(b));
        let low = p.min(q);
        if x == 0 || y == 0 || p.max(q) - low > 64 {
            let (one, a, b) = (Self::of(1.0), Self::of(a), Self::of(b));
            return Self::sum_of_products(&[(false, &a, &one), (true, &b, &one)]);
        }
        Self::of_integer((x << (p - low)) - (y << (q - low)), low)
    }

    fn sum_of_products(terms: &[(bool, &Self, &Self)]) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for (_, a, b) in terms.iter().filter(|(_, a, b)| !a.digits.is_empty() && !b.digits.is_empty()) {
            low = low.min(a.exponent + b.exponent);
            high = high.max(a.exponent + b.exponent + (a.digits.len() + b.digits.len()) as i32);
        }
        if low > high {
            return Self::default();
        }
        // One digit more than the largest term, for carries and the sign (two's complement).
        let mut sum: SmallVec<[u64; 32]> = smallvec![0; (high - low) as usize + 1];
        for &(is_subtracted, a, b) in terms {
            if a.digits.is_empty() || b.digits.is_empty() {
                continue;
            }
            let at = &mut sum[(a.exponent + b.exponent - low) as usize..];
            if is_subtracted == (a.is_negative == b.is_negative) {
                subtract_product(at, &a.digits, &b.digits);
            } else {
                add_product(at, &a.digits, &b.digits);
            }
        }
        let is_negative = sum.last().is_some_and(|top| top >> 63 == 1);
        if is_negative {
            let mut carry = true;
            for digit in &mut sum {
                (*digit, carry) = (!*digit).overflowing_add(u64::from(carry));
            }
        }
        Self::new(is_negative, &sum, low)
    }

    /// Returns the value, clamped to the range of floating-point numbers, with the correct sign.
    fn value(&self) -> f64 {
        let (leading, power) = self.leading();
        leading * 2.0_f64.powi((64 * power).clamp(-900, 800))
    }

    /// Returns the rounded quotient, also of numbers beyond the range of floating-point numbers.
    fn over(&self, other: &Self) -> f64 {
        let ((a, p), (b, q)) = (self.leading(), other.leading());
        a / b * 2.0_f64.powi((64 * (p - q)).clamp(-900, 800))
    }

    fn doubt(&self) -> f64 {
        0.0
    }
}

fn add_product(sum: &mut [u64], a: &[u64], b: &[u64]) {
    for (i, &a) in a.iter().enumerate() {
        let mut carry = 0;
        for (digit, &b) in sum[i..].iter_mut().zip(b) {
            let wide = u128::from(a) * u128::from(b) + u128::from(*digit) + carry;
            *digit = wide as u64;
            carry = wide >> 64;
        }
        let mut carry = carry as u64;
        for digit in &mut sum[i + b.len()..] {
            if carry == 0 {
                break;
            }
            let overflows;
            (*digit, overflows) = digit.overflowing_add(carry);
            carry = u64::from(overflows);
        }
    }
}

fn subtract_product(sum: &mut [u64], a: &[u64], b: &[u64]) {
    for (i, &a) in a.iter().enumerate() {
        let mut borrow = 0;
        for (digit, &b) in sum[i..].iter_mut().zip(b) {
            let wide = u128::from(a) * u128::from(b) + borrow;
            let overflows;
            (*digit, overflows) = digit.overflowing_sub(wide as u64);
            borrow = (wide >> 64) + u128::from(overflows);
        }
        let mut borrow = borrow as u64;
        for digit in &mut sum[i + b.len()..] {
            if borrow == 0 {
                break;
            }
            let overflows;
            (*digit, overflows) = digit.overflowing_sub(borrow);
            borrow = u64::from(overflows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plus(a: &Exact, b: &Exact) -> Exact {
        let one = Exact::of(1.0);
        Exact::sum_of_products(&[(false, a, &one), (false, b, &one)])
    }

    fn minus(a: &Exact, b: &Exact) -> Exact {
        let one = Exact::of(1.0);
        Exact::sum_of_products(&[(false, a, &one), (true, b, &one)])
    }

    fn times(a: &Exact, b: &Exact) -> Exact {
        Exact::sum_of_products(&[(false, a, b)])
    }

    #[test]
    fn nothing_is_lost() {
        let (a, b) = (Exact::of(1e20), Exact::of(1.0 + f64::EPSILON));
        let sum = plus(&a, &b);
        assert_eq!(minus(&sum, &a), b);
        // (a + b)² - a² - 2ab - b² = 0
        let two_a = times(&a, &Exact::of(2.0));
        let terms = [(false, &sum, &sum), (true, &a, &a), (true, &two_a, &b), (true, &b, &b)];
        assert_eq!(Exact::sum_of_products(&terms), Exact::default());
        let small = minus(&minus(&Exact::of(1.0), &Exact::of(1e-30)), &Exact::of(1.0));
        assert_eq!(small.value(), -1e-30);
        assert_eq!(Exact::of(-0.0), Exact::of(0.0));
    }

    #[test]
    fn differences_are_those_of_the_numbers() {
        let values = [0.0, 1.0, -1.0 / 3.0, 1e-17, 1e17 / 3.0, -5e-324, 1e300, 2.0_f64.powi(64), 0.1];
        for a in values {
            for b in values {
                assert_eq!(Exact::difference(a, b), minus(&Exact::of(a), &Exact::of(b)), "{a} - {b}");
                assert_eq!(plus(&Exact::difference(a, b), &Exact::of(b)), Exact::of(a), "{a} - {b}");
            }
        }
    }

    #[test]
    fn carries_and_borrows_run_through_all_digits() {
        // (2¹²⁸ - 1) + 1 and 2¹²⁸ - 1, and the same below zero.
        let (one, power) = (Exact::of(1.0), Exact::of(2.0_f64.powi(128)));
        let below = minus(&power, &one);
        assert_eq!(below.digits.as_slice(), [u64::MAX; 2]);
        assert_eq!(plus(&below, &one), power);
        assert_eq!(minus(&one, &power), minus(&Exact::default(), &below));
        // (2¹²⁸ - 1)² = 2²⁵⁶ - 2¹²⁹ + 1
        let expected = plus(&minus(&times(&power, &power), &times(&power, &Exact::of(2.0))), &one);
        assert_eq!(times(&below, &below), expected);
        assert_eq!(Exact::sum_of_products(&[(true, &below, &below), (false, &below, &below)]), Exact::default());
    }

    #[test]
    fn values_come_back() {
        for value in [1.0, -1.5, 0.1, -1e-300, 5e-324, 1e300, f64::MAX, 1.0 / 3.0, -123_456.789e-20] {
            let back = Exact::of(value).value();
            // Beyond the range to which `value` is clamped, only the sign is correct.
            if value.abs() > 1e-200 && value.abs() < 1e200 {
                assert_eq!(back, value);
            }
            assert_eq!(back.signum(), value.signum());
        }
    }

    #[test]
    fn quotients_of_numbers_beyond_the_range_of_floating_point() {
        let third = Exact::of(1.0 / 3.0);
        let tiny = (0..20).fold(Exact::of(1.0), |product, _| times(&product, &Exact::of(1e-30)));
        assert_eq!(times(&third, &tiny).over(&tiny), 1.0 / 3.0);
        assert_eq!(tiny.over(&times(&tiny, &Exact::of(-0.25))), -4.0);
        assert_eq!(times(&tiny, &tiny).over(&tiny).signum(), 1.0);
    }

    #[test]
    fn products_of_many_factors_keep_their_sign() {
        let third = Exact::of(1.0 / 3.0);
        let power = (0..9).fold(Exact::of(1.0), |product, _| times(&product, &third));
        let again = (0..9).fold(Exact::of(1.0), |product, _| times(&third, &product));
        let tiny = Exact::of(-1e-120);
        assert_eq!(minus(&plus(&power, &tiny), &again), tiny);
        let tiny = (0..40).fold(Exact::of(-1.0), |product, _| times(&product, &Exact::of(1e-30)));
        assert!(tiny.value() < 0.0, "{}", tiny.value());
    }
}
