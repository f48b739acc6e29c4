//! A body as contact sees it: a boundary, positions that follow from velocities, and where these are in the system.

use std::ops::Range;

use algebra::{BlockLayout, DofId, FieldId};
use mesh::{BoundaryMesh, Point, Vector, VertexId};

use crate::Error;
use crate::error::positive;

/// The boundary of a body in one step, with positions `x = x_pred + c_d v` at its end.
///
/// Implicit Euler: `x_pred` are the positions at step n and `c_d` is the time step.
#[derive(Clone, Copy, Debug)]
pub struct ContactBody<'a, const D: usize> {
    boundary: &'a BoundaryMesh<D>,
    predicted: &'a [Point<D>],
    displacement_per_velocity: f64,
    first_dof: usize,
}

impl<'a, const D: usize> ContactBody<'a, D> {
    /// A body with the velocity field `field`.
    ///
    /// Shapes: `predicted` (`x_pred`): one point per vertex of the body's mesh.
    ///
    /// # Errors
    /// [`Error::Parameter`]: `displacement_per_velocity` (`c_d`) not positive. [`Error::Field`]: the field does not
    /// have `D` dofs per vertex. [`Error::UnknownVertex`]: too few positions for the boundary.
    pub fn new(
        boundary: &'a BoundaryMesh<D>,
        predicted: &'a [Point<D>],
        displacement_per_velocity: f64,
        layout: &BlockLayout,
        field: FieldId,
    ) -> Result<Self, Error> {
        positive("displacement per velocity", displacement_per_velocity)?;
        let range = layout.range(field);
        if range.len() != D * predicted.len() {
            return Err(Error::Field { found: range.len(), expected: D * predicted.len() });
        }
        let highest = boundary.facets().flat_map(|f| boundary.facet(f)).max();
        if let Some(&vertex) = highest.filter(|v| v.index() >= predicted.len()) {
            return Err(Error::UnknownVertex { vertex, n_positions: predicted.len() });
        }
        Ok(Self { boundary, predicted, displacement_per_velocity, first_dof: range.start })
    }

    /// The boundary.
    pub fn boundary(&self) -> &'a BoundaryMesh<D> {
        self.boundary
    }

    /// Positions at zero velocity; the measure of facets is taken there.
    pub fn predicted(&self) -> &'a [Point<D>] {
        self.predicted
    }

    /// `c_d`: derivative of positions with respect to velocity.
    #[inline]
    pub fn displacement_per_velocity(&self) -> f64 {
        self.displacement_per_velocity
    }

    /// Whether the dofs of another body are the same ones.
    pub(crate) fn is_same_field(&self, other: &Self) -> bool {
        self.first_dof == other.first_dof
    }

    /// Where its velocities are in a global vector.
    pub fn range(&self) -> Range<usize> {
        self.first_dof..self.first_dof + D * self.predicted.len()
    }

    /// The dofs of a vertex.
    #[inline]
    pub(crate) fn dofs(&self, vertex: VertexId) -> impl Iterator<Item = DofId> + use<D> {
        let first = self.first_dof + D * vertex.index();
        (first..first + D).map(DofId::new)
    }

    /// Positions at the velocities in the global vector `x`.
    #[inline]
    pub fn motion(&self, x: &'a [f64]) -> Motion<'a, D> {
        let velocity = &x[self.range()];
        Motion { predicted: self.predicted, velocity, displacement_per_velocity: self.displacement_per_velocity }
    }
}

/// Positions of the vertices of a body, evaluated where they are needed.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a, const D: usize> {
    predicted: &'a [Point<D>],
    velocity: &'a [f64],
    displacement_per_velocity: f64,
}

impl<'a, const D: usize> Motion<'a, D> {
    /// The given positions (none for a rigid obstacle).
    pub fn frozen(positions: &'a [Point<D>]) -> Self {
        Self { predicted: positions, velocity: &[], displacement_per_velocity: 0.0 }
    }

    /// Position of a vertex: `x_pred + c_d v`.
    #[inline]
    pub fn position(&self, vertex: VertexId) -> Point<D> {
        let predicted = self.predicted[vertex.index()];
        if self.velocity.is_empty() {
            return predicted;
        }
        let velocity = Vector::from_column_slice(&self.velocity[D * vertex.index()..][..D]);
        predicted + self.displacement_per_velocity * velocity
    }

    /// Positions of all vertices.
    pub(crate) fn positions(&self) -> Vec<Point<D>> {
        (0..self.predicted.len()).map(|k| self.position(VertexId::new(k))).collect()
    }
}
