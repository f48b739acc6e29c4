//! Weighted sums of the unknown velocity and of known values.

use std::ops::{Add, Mul, Sub};

/// One quantity at a node as a weighted sum of the unknown velocity at the stage and of known values at the start of
/// the step.
///
/// Rows are added and scaled, so that a scheme is written as its formulas.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Weight of the unknown velocity.
    pub slope: f64,
    /// Weight of the displacement at the start.
    pub displacement: f64,
    /// Weight of the velocity at the start.
    pub velocity: f64,
    /// Weight of the acceleration at the start.
    pub acceleration: f64,
}

impl Row {
    const ZERO: Self = Self { slope: 0.0, displacement: 0.0, velocity: 0.0, acceleration: 0.0 };
    /// The unknown velocity `v`.
    pub const UNKNOWN: Self = Self { slope: 1.0, ..Self::ZERO };
    /// The displacement `d^n` at the start.
    pub const DISPLACEMENT: Self = Self { displacement: 1.0, ..Self::ZERO };
    /// The velocity `v^n` at the start.
    pub const VELOCITY: Self = Self { velocity: 1.0, ..Self::ZERO };
    /// The acceleration `a^n` at the start.
    pub const ACCELERATION: Self = Self { acceleration: 1.0, ..Self::ZERO };
}

impl Add for Row {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            slope: self.slope + other.slope,
            displacement: self.displacement + other.displacement,
            velocity: self.velocity + other.velocity,
            acceleration: self.acceleration + other.acceleration,
        }
    }
}

impl Mul<f64> for Row {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            slope: self.slope * factor,
            displacement: self.displacement * factor,
            velocity: self.velocity * factor,
            acceleration: self.acceleration * factor,
        }
    }
}

impl Sub for Row {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}
