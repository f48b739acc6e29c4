//! Units of length in which generators work.

use std::sync::Arc;

use super::region::{Region, RegionShape};
use super::size::Size;
use crate::search::SurfaceIndex;
use crate::{Aabb, Placed, Point};

/// Smallest extent of a shape that is generated in the unit of the caller; the largest extent is 100 times as large.
const LEAST: f64 = 0.2;
/// Decimal digits to which lengths are rounded when they are converted. A length and its conversion by a power of ten
/// thus have the same digits.
const DIGITS: usize = 12;

/// A unit of length: the unit of the caller times a power of 100. A shape that is given in centimetres or in metres has
/// the same digits in this unit, so that the round-off of generators is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unit {
    /// Lengths in the unit of the caller are multiplied by ten to this power.
    exponent: i32,
}

impl Unit {
    /// Returns the unit in which the extent of a shape is from 0.2 to 20.
    pub(super) fn of(extent: f64) -> Self {
        if !extent.is_normal() {
            return Self { exponent: 0 };
        }
        Self { exponent: -2 * ((extent / LEAST).log10() / 2.0).floor() as i32 }
    }

    /// Returns whether this is the unit of the caller.
    pub(super) fn is_caller_unit(self) -> bool {
        self.exponent == 0
    }

    /// Returns a length in this unit.
    pub(super) fn of_length(self, x: f64) -> f64 {
        if self.is_caller_unit() || !x.is_finite() {
            return x;
        }
        // Shifts the decimal exponent in text form: a multiplication by a power of ten would round a second time.
        let text = format!("{x:.*e}", DIGITS - 1);
        let shifted = text.split_once('e').and_then(|(digits, exponent)| {
            let exponent = exponent.parse::<i32>().ok()? + self.exponent;
            format!("{digits}e{exponent}").parse().ok()
        });
        shifted.unwrap_or(x)
    }

    /// Returns a point in this unit.
    pub(super) fn of_point<const D: usize>(self, x: &Point<D>) -> Point<D> {
        x.map(|x| self.of_length(x))
    }

    /// Returns a size field in this unit.
    pub(super) fn of_size(self, size: &Size) -> Size {
        let to = |x: f64| self.of_length(x);
        match *size {
            Size::Uniform { h } => Size::Uniform { h: to(h) },
            Size::Graded { fine, fine_until, coarse, coarse_from, axis } => Size::Graded {
                fine: to(fine),
                fine_until: to(fine_until),
                coarse: to(coarse),
                coarse_from: to(coarse_from),
                axis,
            },
        }
    }

    /// Returns a region in this unit.
    pub(super) fn of_region<const D: usize>(self, region: &Region<D>) -> Region<D> {
        let shape = match &region.shape {
            RegionShape::Segment { ends, within } => RegionShape::Segment {
                ends: ends.each_ref().map(|x| self.of_point(x)),
                within: self.of_length(*within),
            },
            RegionShape::Surface { index, is_filled, within } => {
                let surface = index.surface();
                let positions: Vec<Point<D>> = surface.positions().iter().map(|x| self.of_point(x)).collect();
                let index = Arc::new(SurfaceIndex::new(&Placed::new(surface.boundary(), &positions)));
                RegionShape::Surface { index, is_filled: *is_filled, within: self.of_length(*within) }
            }
            RegionShape::Box(Aabb { low, high }) => {
                RegionShape::Box(Aabb { low: self.of_point(low), high: self.of_point(high) })
            }
        };
        Region { shape, size: self.of_length(region.size), growth: region.growth }
    }

    /// Returns a length of this unit in the unit of the caller.
    pub(super) fn to_caller_unit(self, x: f64) -> f64 {
        match self.exponent {
            0 => x,
            e if e > 0 => x / 10_f64.powi(e),
            e => x * 10_f64.powi(-e),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centimetres_and_metres_have_the_same_numbers() {
        assert!([15.0, 0.2, 19.9].iter().all(|&x| Unit::of(x).is_caller_unit()));
        let unit = Unit::of(0.15);
        assert_eq!(unit.exponent, 2);
        for x in [0.1, 4.5, 10.0, 15.0, 0.05, 7.02, 0.0, -0.2] {
            assert_eq!(unit.of_length(x / 100.0), x);
            assert_eq!(unit.of_length(x * 0.01), x);
        }
        assert_eq!(Unit::of(150.0).exponent, -2);
        assert_eq!(Unit::of(150.0).of_length(0.7), 0.007);
        assert_eq!((unit.to_caller_unit(7.0), Unit::of(150.0).to_caller_unit(0.5)), (0.07, 50.0));
        assert!([0.0, f64::NAN, f64::INFINITY].iter().all(|&x| Unit::of(x).is_caller_unit()));
    }
}
