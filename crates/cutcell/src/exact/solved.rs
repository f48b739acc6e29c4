//! Cache of planes and corners in extended precision.

use std::collections::HashMap;

use super::integer::Exact;
use super::number::Double;
use super::plane::Plane;

/// Results in extended precision for one cell, in which the same planes and corners are used repeatedly.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// Signed distances of corners (given by their planes and the index of the vertex) from planes.
    pub(super) sides: HashMap<([Plane; 3], u32, Plane), f64>,
    double: Solved<Double>,
    exact: Solved<Exact>,
}

impl Known {
    pub(crate) fn clear(&mut self) {
        self.sides.clear();
        self.double.clear();
        self.exact.clear();
    }
}

/// Planes and points with numbers of one kind.
#[derive(Clone, Debug, Default)]
pub(super) struct Solved<N> {
    /// Normal of a plane, and its scalar product with the points of the plane.
    pub(super) planes: HashMap<Plane, ([N; 3], N)>,
    /// Intersection of planes: numerators of the coordinates, and their common denominator.
    pub(super) corners: HashMap<[Plane; 3], ([N; 3], N)>,
}

impl<N> Solved<N> {
    fn clear(&mut self) {
        self.planes.clear();
        self.corners.clear();
    }
}

/// Access to the planes and corners with numbers of kind `N`.
pub(super) trait Cache<N> {
    fn solved(&mut self) -> &mut Solved<N>;
}

impl Cache<Double> for Known {
    fn solved(&mut self) -> &mut Solved<Double> {
        &mut self.double
    }
}

impl Cache<Exact> for Known {
    fn solved(&mut self) -> &mut Solved<Exact> {
        &mut self.exact
    }
}
