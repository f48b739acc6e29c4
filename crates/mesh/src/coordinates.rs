//! The coordinates of a mesh, and their weight in integrals.

use std::f64::consts::TAU;

use crate::{Point, Vector};

/// The coordinates of a mesh of dimension `D`.
///
/// An integral over a region, a surface or a curve is an integral over the mesh with the weight of the coordinates as a
/// factor. Masses, forces and energies are those of the whole body, or per unit depth in plane problems.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coordinates {
    /// Cartesian coordinates: weight one.
    #[default]
    Cartesian,
    /// Cylindrical coordinates `(r, z)` of a problem with rotational symmetry and without swirl, for `D = 2`. The mesh
    /// lies in the half plane `r >= 0` through the axis. The weight of a point is the length `2π r` of its circle.
    Axisymmetric,
}

impl Coordinates {
    /// Index of the radial component.
    const RADIAL: usize = 0;

    /// Returns the weight of a point.
    #[inline]
    pub fn weight<const D: usize>(self, x: &Point<D>) -> f64 {
        match self {
            Self::Cartesian => 1.0,
            Self::Axisymmetric => TAU * x[Self::RADIAL],
        }
    }

    /// Returns the gradient of the weight.
    #[inline]
    pub fn weight_gradient<const D: usize>(self) -> Vector<D> {
        let mut gradient = Vector::zeros();
        self.radial().into_iter().for_each(|a| gradient[a] = TAU);
        gradient
    }

    /// Returns the polynomial degree of the weight, which is added to the degree of a quadrature rule.
    #[inline]
    pub fn degree(self) -> usize {
        match self {
            Self::Cartesian => 0,
            Self::Axisymmetric => 1,
        }
    }

    /// Returns the index of the radial component; `None` in Cartesian coordinates.
    #[inline]
    pub fn radial(self) -> Option<usize> {
        match self {
            Self::Cartesian => None,
            Self::Axisymmetric => Some(Self::RADIAL),
        }
    }

    /// Returns the resultant of vectors whose sum with the weight is given: radial components on opposite sides of the
    /// axis cancel.
    #[inline]
    pub fn resultant<const D: usize>(self, mut sum: Vector<D>) -> Vector<D> {
        self.radial().into_iter().for_each(|a| sum[a] = 0.0);
        sum
    }

    /// Returns the moment of forces whose sum with the weight is given. It is zero with rotational symmetry: without
    /// swirl there is no moment about the axis, and moments about other axes cancel.
    #[inline]
    pub fn moment(self, sum: [f64; 3]) -> [f64; 3] {
        if self.radial().is_some() { [0.0; 3] } else { sum }
    }
}
