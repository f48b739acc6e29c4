//! Axis-aligned bounding boxes.

use crate::{Point, Vector};

/// The points `x` with `low <= x <= high` in every component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<const D: usize> {
    /// Corner with the smallest coordinates.
    pub low: Point<D>,
    /// Corner with the largest coordinates.
    pub high: Point<D>,
}

impl<const D: usize> Aabb<D> {
    /// Returns the box without points: `low` is infinite, `high` is minus infinity.
    pub fn empty() -> Self {
        Self { low: Point::repeat(f64::INFINITY), high: Point::repeat(f64::NEG_INFINITY) }
    }

    /// Returns the smallest box that contains the points.
    #[inline]
    pub fn of_points<'p>(points: impl IntoIterator<Item = &'p Point<D>>) -> Self {
        let with = |bounds: Self, x: &Point<D>| Self { low: bounds.low.inf(x), high: bounds.high.sup(x) };
        points.into_iter().fold(Self::empty(), with)
    }

    /// Returns the smallest box that contains both boxes.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// Returns the box with every face moved outwards by `margin`.
    #[must_use]
    pub fn expanded(&self, margin: f64) -> Self {
        Self { low: self.low.add_scalar(-margin), high: self.high.add_scalar(margin) }
    }

    /// Returns the lengths of the edges.
    pub fn extent(&self) -> Vector<D> {
        self.high - self.low
    }

    /// Returns the centre of the box.
    pub fn centre(&self) -> Point<D> {
        0.5 * (self.low + self.high)
    }

    /// Returns whether the box or its boundary contains the point.
    pub fn contains(&self, x: &Point<D>) -> bool {
        (0..D).all(|k| self.low[k] <= x[k] && x[k] <= self.high[k])
    }

    /// Returns whether the boxes have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..D).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Returns the distance between the boxes; zero if they overlap, infinite if one is empty.
    pub fn distance(&self, other: &Self) -> f64 {
        (self.low - other.high).sup(&(other.low - self.high)).map(|gap| gap.max(0.0)).norm()
    }

    /// Returns the squared distance from a point; zero inside.
    #[inline]
    pub fn squared_distance(&self, x: &Point<D>) -> f64 {
        (self.low - x).sup(&(x - self.high)).map(|gap| gap.max(0.0)).norm_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_of_points_have_distances_and_overlaps() {
        let at = |x: f64, y: f64| Point::<2>::new(x, y);
        let unit = Aabb::of_points(&[at(1.0, 0.0), at(0.0, 1.0)]);
        assert_eq!((unit.low, unit.high, unit.centre()), (at(0.0, 0.0), at(1.0, 1.0), at(0.5, 0.5)));
        assert!(unit.contains(&at(1.0, 0.5)) && !unit.contains(&at(0.5, 1.1)) && !unit.contains(&at(f64::NAN, 0.5)));
        assert_eq!((unit.squared_distance(&at(4.0, -4.0)), unit.squared_distance(&at(0.2, 0.3))), (25.0, 0.0));

        let far = Aabb { low: at(4.0, 5.0), high: at(6.0, 7.0) };
        assert_eq!((unit.distance(&far), far.distance(&unit)), (5.0, 5.0));
        assert!(!unit.overlaps(&far) && unit.expanded(4.0).overlaps(&far) && !unit.expanded(3.0).overlaps(&far));
        assert_eq!(unit.union(&far), Aabb { low: unit.low, high: far.high });
        assert_eq!(far.extent(), at(2.0, 2.0));
    }

    #[test]
    fn the_empty_box_contains_nothing_and_is_neutral() {
        let unit = Aabb::of_points(&[Point::<2>::zeros(), Point::<2>::repeat(1.0)]);
        let empty = Aabb::of_points(&[]);
        assert!(!empty.contains(&Point::zeros()) && !empty.overlaps(&unit) && !unit.overlaps(&empty));
        assert_eq!(empty.union(&unit), unit);
        assert_eq!(empty.distance(&unit), f64::INFINITY);
    }
}
