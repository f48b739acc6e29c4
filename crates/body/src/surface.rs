//! The surface of a body in one time step.

use algebra::{BlockLayout, FieldId};
use mesh::{BoundaryMesh, Point, Vector, VertexId};

/// A surface in one step. Its vertices are at `begin` at the start of the step, which is the geometry of the step, and
/// at `predicted + slope v` at its end.
pub struct SurfaceMotion<'s, const D: usize> {
    /// The surface.
    pub boundary: &'s BoundaryMesh<D>,
    /// Positions of all vertices at the start of the step.
    pub begin: Vec<Point<D>>,
    /// Positions at the end of the step for zero velocity.
    pub predicted: Vec<Point<D>>,
    /// Derivative of the positions at the end with respect to the velocity there; zero for a given motion.
    pub slope: f64,
    /// Velocity at the end of the step.
    pub velocity: SurfaceVelocity<'s, D>,
}

/// The velocity of a surface at the end of a step.
pub enum SurfaceVelocity<'s, const D: usize> {
    /// Vertex velocities, unknown or tied to unknowns: a field with `D` components at each vertex.
    Field(FieldId),
    /// A velocity given at every point of the surface at the start of the step.
    Given(Box<dyn Fn(&Point<D>) -> Vector<D> + Send + Sync + 's>),
}

impl<const D: usize> SurfaceMotion<'_, D> {
    /// Returns the field of the vertex velocities; `None` for a given motion.
    #[inline]
    pub fn field(&self) -> Option<FieldId> {
        match self.velocity {
            SurfaceVelocity::Field(field) => Some(field),
            SurfaceVelocity::Given(_) => None,
        }
    }

    /// Returns the velocity of a vertex at the end of the step at the state `x`.
    #[inline]
    pub fn velocity_at(&self, vertex: VertexId, layout: &BlockLayout, x: &[f64]) -> Vector<D> {
        match &self.velocity {
            SurfaceVelocity::Field(field) => layout.at(*field, vertex.index(), x).into(),
            SurfaceVelocity::Given(velocity) => velocity(&self.begin[vertex.index()]),
        }
    }

    /// Returns the position of a vertex at the end of the step at the state `x`.
    #[inline]
    pub fn position_at(&self, vertex: VertexId, layout: &BlockLayout, x: &[f64]) -> Point<D> {
        let predicted = self.predicted[vertex.index()];
        match &self.velocity {
            SurfaceVelocity::Field(field) => {
                let velocity: Vector<D> = layout.at(*field, vertex.index(), x).into();
                predicted + self.slope * velocity
            }
            SurfaceVelocity::Given(_) => predicted,
        }
    }
}
