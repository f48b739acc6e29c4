//! Exact arithmetic: sums and products of floating-point numbers without rounding.
//!
//! A number is the sum of components that do not overlap (an *expansion*), after J. R. Shewchuk, "Adaptive precision
//! floating-point arithmetic and fast robust geometric predicates" (1997). Exact as long as nothing underflows: for
//! coordinates between about 1e-25 and 1e25, or zero.

use std::ops::{Add, Mul, Neg, Sub};

use super::number::{fast_two_sum, two_product, two_sum};

/// An exact number; components in the order of their size, none zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Exact(Vec<f64>);

impl Exact {
    /// `a - b`.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self(vec![low, high]).without_zeros()
    }

    /// The nearest floating-point number, up to one unit in its last place; its sign is exact.
    pub(crate) fn value(&self) -> f64 {
        self.0.iter().sum()
    }

    fn without_zeros(mut self) -> Self {
        self.0.retain(|c| *c != 0.0);
        self
    }

    /// The same number with as few components as possible.
    fn compressed(self) -> Self {
        let Some((&last, rest)) = self.0.split_last() else { return self };
        let mut carry = last;
        let mut large = Vec::with_capacity(self.0.len());
        for &c in rest.iter().rev() {
            let (high, low) = fast_two_sum(carry, c);
            if low == 0.0 {
                carry = high;
            } else {
                large.push(high);
                carry = low;
            }
        }
        let mut small = Vec::with_capacity(large.len() + 1);
        for &c in large.iter().rev() {
            let (high, low) = fast_two_sum(c, carry);
            if low != 0.0 {
                small.push(low);
            }
            carry = high;
        }
        if carry != 0.0 {
            small.push(carry);
        }
        Self(small)
    }

    fn scaled(&self, factor: f64) -> Self {
        let mut product = Vec::with_capacity(2 * self.0.len());
        let mut carry = 0.0;
        for &c in &self.0 {
            let (high, low) = two_product(c, factor);
            let (sum, error) = two_sum(carry, low);
            product.push(error);
            let (sum, error) = fast_two_sum(high, sum);
            product.push(error);
            carry = sum;
        }
        product.push(carry);
        Self(product).without_zeros()
    }
}

impl From<f64> for Exact {
    fn from(value: f64) -> Self {
        Self(vec![value]).without_zeros()
    }
}

impl Add for &Exact {
    type Output = Exact;
    fn add(self, other: Self) -> Exact {
        // Grows the larger expansion by each component of the other one.
        let (long, short) = if self.0.len() >= other.0.len() { (self, other) } else { (other, self) };
        let mut sum = long.0.clone();
        for &c in &short.0 {
            let mut carry = c;
            let mut kept = 0;
            for k in 0..sum.len() {
                let (high, low) = two_sum(carry, sum[k]);
                carry = high;
                if low != 0.0 {
                    sum[kept] = low;
                    kept += 1;
                }
            }
            sum.truncate(kept);
            if carry != 0.0 {
                sum.push(carry);
            }
        }
        Exact(sum)
    }
}

impl Neg for &Exact {
    type Output = Exact;
    fn neg(self) -> Exact {
        Exact(self.0.iter().map(|c| -c).collect())
    }
}

impl Sub for &Exact {
    type Output = Exact;
    fn sub(self, other: Self) -> Exact {
        self + &-other
    }
}

impl Mul for &Exact {
    type Output = Exact;
    fn mul(self, other: Self) -> Exact {
        let (long, short) = if self.0.len() >= other.0.len() { (self, other) } else { (other, self) };
        let mut product = Exact::default();
        for &c in &short.0 {
            product = &product + &long.scaled(c);
        }
        product.compressed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let (a, b) = (Exact::from(1e20), Exact::from(1.0 + f64::EPSILON));
        let sum = &a + &b;
        assert_eq!((&sum - &a), b);
        assert_eq!(&sum - &(&a + &b), Exact::default());
        // (a + b)² - a² - 2ab - b² = 0
        let square = &sum * &sum;
        let two_ab = &(&a * &b) * &Exact::from(2.0);
        assert_eq!(&(&(&square - &(&a * &a)) - &two_ab) - &(&b * &b), Exact::default());
        assert_eq!(Exact::difference(0.1, 0.1).value(), 0.0);
        assert_eq!((&Exact::difference(1.0, 1e-30) - &Exact::from(1.0)).value(), -1e-30);
    }

    #[test]
    fn products_of_many_factors_keep_their_sign() {
        let third = Exact::from(1.0 / 3.0);
        let mut power = Exact::from(1.0);
        for _ in 0..9 {
            power = &power * &third;
        }
        let again = (0..9).fold(Exact::from(1.0), |product, _| &third * &product);
        let tiny = Exact::from(1e-120);
        assert_eq!((&(&power + &tiny) - &again).value(), 1e-120);
        assert!(power.0.len() <= 10, "{} components", power.0.len());
    }
}
