//! Open boundaries: integrals over the wet boundary of the background.

use algebra::{BlockLayout, Contributions, DofId, LocalSystem};
use mesh::{MAX_CELL_VERTICES, Vector};
use xfem_space::{BoundaryPoint, BoundaryValues};

use crate::form::{FluidFields, FluidGeometry};
use crate::terms::{Backflow, Traction};

/// A quadrature point of an open boundary with the fields evaluated.
pub struct OpenPoint<'a, const D: usize> {
    /// Geometry and shape values.
    pub at: &'a BoundaryPoint<D>,
    /// Velocity.
    pub velocity: Vector<D>,
    /// History `u*`.
    pub history: Vector<D>,
}

/// A term integrated over an open boundary; local rows are the velocities of the nodes of the part.
pub trait BoundaryTerm<const D: usize>: Sync {
    /// Adds the term at one point.
    fn add(&self, point: &OpenPoint<'_, D>, out: &mut LocalSystem);
}

/// The terms on one open boundary.
pub struct OpenBoundary<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: &'a FluidGeometry<'a, D>,
    /// Where the fields lie.
    pub fields: FluidFields<'a>,
    /// Quadrature points.
    pub values: BoundaryValues<D>,
    /// Traction given there.
    pub traction: Traction<'a, D>,
    /// Stabilisation of inflow; `None` switches it off.
    pub backflow: Option<Backflow>,
}

impl<const D: usize> Contributions for OpenBoundary<'_, D> {
    fn name(&self) -> &'static str {
        "open boundary"
    }

    fn len(&self) -> usize {
        self.values.points().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let layout: &BlockLayout = self.fields.layout;
        for &dof in self.geometry.space.dofs(self.values.points()[item].part) {
            out.extend((0..D).map(|a| layout.dof(self.fields.velocity, D * dof as usize + a)));
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let at = &self.values.points()[item];
        let mut point = OpenPoint { at, velocity: Vector::zeros(), history: Vector::zeros() };
        let mut velocities = [Vector::zeros(); MAX_CELL_VERTICES];
        for (i, &dof) in self.geometry.space.dofs(at.part).iter().enumerate() {
            velocities[i] = self.fields.velocity_at(x, dof);
            point.velocity += velocities[i] * at.shape[i];
            point.history += self.geometry.history[dof as usize] * at.shape[i];
        }
        self.traction.add(&point, out);
        if let Some(backflow) = &self.backflow {
            backflow.add(&point, out);
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}
