//! Open boundaries: integrals over the wet boundary of the background.

use algebra::{DofId, Sites};
use mesh::Vector;
use xfem_space::BoundaryPoint;

use crate::{FluidFields, FluidGeometry};

/// A quadrature point of an open boundary with the fields evaluated.
pub struct OpenPoint<'a, const D: usize> {
    /// Geometry and shape values.
    pub at: &'a BoundaryPoint<D>,
    /// Velocity.
    pub velocity: Vector<D>,
    /// History `u*`.
    pub known_velocity: Vector<D>,
}

impl<const D: usize> OpenPoint<'_, D> {
    /// Returns the first row of the velocity of a node.
    #[inline]
    pub fn velocity_row(&self, node: usize) -> usize {
        D * node
    }
}

/// Quadrature points of an open boundary: one item with one site each.
pub struct OpenBoundary<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: FluidGeometry<'a, D>,
    /// The fluid's fields.
    pub fields: FluidFields<'a>,
    /// The points.
    pub points: &'a [BoundaryPoint<D>],
}

impl<'a, const D: usize> Sites for OpenBoundary<'a, D> {
    type Site = OpenPoint<'a, D>;

    fn len(&self) -> usize {
        self.points.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let FluidFields { layout, velocity, .. } = self.fields;
        for &dof in self.geometry.space.dofs(self.points[item].part) {
            out.extend(layout.node(velocity, dof as usize));
        }
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let at = &self.points[item];
        let mut point = OpenPoint { at, velocity: Vector::zeros(), known_velocity: Vector::zeros() };
        for (i, &dof) in self.geometry.space.dofs(at.part).iter().enumerate() {
            point.velocity += self.fields.velocity_at(x, dof) * at.shape[i];
            point.known_velocity += self.geometry.known_velocity[dof as usize] * at.shape[i];
        }
        visit(&point);
    }
}
