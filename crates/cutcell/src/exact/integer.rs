//! Exact arithmetic: sums, differences and products of floating-point numbers without rounding.

use std::cmp::Ordering;

use smallvec::{SmallVec, smallvec};

/// Digits to the base 2⁶⁴, the lowest first.
type Digits = SmallVec<[u64; 16]>;

/// An integer times a power of 2⁶⁴, of any size: what sums and products of floating-point numbers are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Exact {
    is_negative: bool,
    /// Without zeros at either end; none for zero.
    digits: Digits,
    /// Power of the lowest digit.
    exponent: i32,
}

impl Exact {
    fn new(is_negative: bool, mut digits: Digits, mut exponent: i32) -> Self {
        while digits.last() == Some(&0) {
            digits.pop();
        }
        let zeros = digits.iter().take_while(|d| **d == 0).count();
        if zeros > 0 {
            digits.drain(..zeros);
            exponent += zeros as i32;
        }
        if digits.is_empty() {
            return Self::default();
        }
        Self { is_negative, digits, exponent }
    }

    pub(super) fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
        let (mantissa, power) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        let wide = u128::from(mantissa) << power.rem_euclid(64);
        Self::new(value.is_sign_negative(), smallvec![wide as u64, (wide >> 64) as u64], power.div_euclid(64))
    }

    /// Nearly the nearest floating-point number; with the right sign, whatever the size.
    pub(super) fn value(&self) -> f64 {
        let base = 2.0_f64.powi(64);
        let n = self.digits.len();
        let leading = self.digits.iter().rev().take(3).fold(0.0, |value, &digit| value * base + digit as f64);
        let power = 64 * (self.exponent + n.saturating_sub(3) as i32);
        let magnitude = leading * 2.0_f64.powi(power.clamp(-900, 800));
        if self.is_negative { -magnitude } else { magnitude }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        self.sum(other, other.is_negative)
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.sum(other, !other.is_negative)
    }

    /// The sum with the magnitude of `other` and the given sign.
    fn sum(&self, other: &Self, is_negative: bool) -> Self {
        if other.digits.is_empty() {
            return self.clone();
        }
        if self.digits.is_empty() {
            return Self { is_negative, ..other.clone() };
        }
        let exponent = self.exponent.min(other.exponent);
        let (mut a, mut b) = (self.aligned(exponent), other.aligned(exponent));
        if self.is_negative == is_negative {
            add(&mut a, &b);
            return Self::new(is_negative, a, exponent);
        }
        match compare(&a, &b) {
            Ordering::Equal => Self::default(),
            Ordering::Greater => {
                subtract(&mut a, &b);
                Self::new(self.is_negative, a, exponent)
            }
            Ordering::Less => {
                subtract(&mut b, &a);
                Self::new(is_negative, b, exponent)
            }
        }
    }

    /// Digits from a power at most that of the lowest one.
    fn aligned(&self, exponent: i32) -> Digits {
        let mut digits: Digits = smallvec![0; (self.exponent - exponent) as usize];
        digits.extend_from_slice(&self.digits);
        digits
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut digits: Digits = smallvec![0; self.digits.len() + other.digits.len()];
        for (i, &a) in self.digits.iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.digits.iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(digits[i + j]) + carry;
                digits[i + j] = sum as u64;
                carry = sum >> 64;
            }
            digits[i + other.digits.len()] = carry as u64;
        }
        Self::new(self.is_negative != other.is_negative, digits, self.exponent + other.exponent)
    }
}

fn add(a: &mut Digits, b: &[u64]) {
    if a.len() < b.len() {
        a.resize(b.len(), 0);
    }
    let mut carry = false;
    for (k, digit) in a.iter_mut().enumerate() {
        let (sum, first) = digit.overflowing_add(b.get(k).copied().unwrap_or(0));
        let (sum, second) = sum.overflowing_add(u64::from(carry));
        *digit = sum;
        carry = first || second;
    }
    if carry {
        a.push(1);
    }
}

/// For `a > b`.
fn subtract(a: &mut Digits, b: &[u64]) {
    let mut borrow = false;
    for (k, digit) in a.iter_mut().enumerate() {
        let (difference, first) = digit.overflowing_sub(b.get(k).copied().unwrap_or(0));
        let (difference, second) = difference.overflowing_sub(u64::from(borrow));
        *digit = difference;
        borrow = first || second;
    }
}

/// Numbers without leading zeros.
fn compare(a: &[u64], b: &[u64]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let (a, b) = (Exact::of(1e20), Exact::of(1.0 + f64::EPSILON));
        let sum = a.plus(&b);
        assert_eq!(sum.minus(&a), b);
        // (a + b)² - a² - 2ab - b² = 0
        let two_ab = a.times(&b).times(&Exact::of(2.0));
        assert_eq!(sum.times(&sum).minus(&a.times(&a)).minus(&two_ab).minus(&b.times(&b)), Exact::default());
        assert_eq!(Exact::of(1.0).minus(&Exact::of(1e-30)).minus(&Exact::of(1.0)).value(), -1e-30);
        assert_eq!(Exact::of(-0.0), Exact::of(0.0));
    }

    #[test]
    fn values_come_back() {
        for value in [1.0, -1.5, 0.1, -1e-300, 5e-324, 1e300, f64::MAX, 1.0 / 3.0, -123_456.789e-20] {
            let back = Exact::of(value).value();
            // Beyond the range that `value` clamps to only the sign is meant.
            if value.abs() > 1e-200 && value.abs() < 1e200 {
                assert_eq!(back, value);
            }
            assert_eq!(back.signum(), value.signum());
        }
    }

    #[test]
    fn products_of_many_factors_keep_their_sign() {
        let third = Exact::of(1.0 / 3.0);
        let power = (0..9).fold(Exact::of(1.0), |product, _| product.times(&third));
        let again = (0..9).fold(Exact::of(1.0), |product, _| third.times(&product));
        let tiny = Exact::of(-1e-120);
        assert_eq!(power.plus(&tiny).minus(&again), tiny);
        let tiny = (0..40).fold(Exact::of(-1.0), |product, _| product.times(&Exact::of(1e-30)));
        assert!(tiny.value() < 0.0);
    }
}
