//! The surface of a body in one time step.

use algebra::time::Affine;
use algebra::{BlockLayout, FieldId};
use mesh::{BoundaryMesh, Point, Vector, VertexId};

use crate::{BodyState, StepTime};

/// A surface in one step.
///
/// The background mesh is cut at `geometry`. Contact acts at the shifted positions of [`algebra::time::Weights`]:
/// `start` at the start of the step, `end` at its end. The difference is the velocity times the length of the step. A
/// rigid body that turns by `θ` moves along arcs instead, which differ by `θ²/2` (implicit Euler) or `θ³/24`
/// (generalised-α) of the distance from its centre.
pub struct SurfaceMotion<'s, const D: usize> {
    /// The surface.
    pub boundary: &'s BoundaryMesh<D>,
    /// Positions of all vertices at the start of the step, or extrapolated to its stage (generalised-α).
    pub geometry: Vec<Point<D>>,
    /// Shifted positions of all vertices at the start.
    pub start: Vec<Point<D>>,
    /// Shifted positions of all vertices at the end. The slope is zero for a given motion.
    pub end: Affine<Point<D>>,
    /// Positions of all vertices at the stage, where the pressure of the fluid acts; `None` if it acts at `geometry`.
    pub stage: Option<Affine<Point<D>>>,
    /// Velocity at the stage.
    pub velocity: SurfaceVelocity<'s, D>,
}

/// The velocity of a surface at the stage of a step.
pub enum SurfaceVelocity<'s, const D: usize> {
    /// Vertex velocities, unknown or tied to unknowns: a field with `D` components at each vertex.
    Field(FieldId),
    /// A velocity given at every point of the surface at [`SurfaceMotion::geometry`].
    Given(Box<dyn Fn(&Point<D>) -> Vector<D> + Send + Sync + 's>),
}

impl<'s, const D: usize> SurfaceMotion<'s, D> {
    /// Creates the motion of a surface with unknown velocities, from the state at the start of the step. The pressure
    /// of the fluid acts at `geometry`.
    pub fn of_field(
        boundary: &'s BoundaryMesh<D>,
        reference: &[Point<D>],
        start: &BodyState<D>,
        geometry: Vec<Point<D>>,
        time: &StepTime,
        field: FieldId,
    ) -> Self {
        let [shifted, end] = &time.weights.shifted;
        Self {
            boundary,
            geometry,
            start: start.positions_by(shifted, reference),
            end: Affine { slope: end.slope, predicted: start.positions_by(end, reference) },
            stage: None,
            velocity: SurfaceVelocity::Field(field),
        }
    }

    /// Returns the field of the vertex velocities; `None` for a given motion.
    #[inline]
    pub fn field(&self) -> Option<FieldId> {
        match self.velocity {
            SurfaceVelocity::Field(field) => Some(field),
            SurfaceVelocity::Given(_) => None,
        }
    }

    /// Returns the velocity of a vertex at the state `x`.
    #[inline]
    pub fn velocity_at(&self, vertex: VertexId, layout: &BlockLayout, x: &[f64]) -> Vector<D> {
        match &self.velocity {
            SurfaceVelocity::Field(field) => layout.at(*field, vertex.index(), x).into(),
            SurfaceVelocity::Given(velocity) => velocity(&self.geometry[vertex.index()]),
        }
    }

    /// Returns the shifted position of a vertex at the end of the step at the state `x`.
    #[inline]
    pub fn position_at(&self, vertex: VertexId, layout: &BlockLayout, x: &[f64]) -> Point<D> {
        match &self.velocity {
            SurfaceVelocity::Field(field) => self.end.at(vertex.index(), layout.at(*field, vertex.index(), x).into()),
            SurfaceVelocity::Given(_) => self.end.predicted[vertex.index()],
        }
    }
}
