//! The traits of bodies.

use algebra::{BlockLayout, Constraints, Contributions};
use mesh::{BoundaryMesh, Point, Vector};

use crate::{Balance, BodyState, CellOutput, StepTime, SurfaceMotion, SurfaceStress};

/// A body with a closed surface that moves. Fluid and contact depend on its surface only.
pub trait Body<const D: usize>: Send + Sync {
    /// Returns the name, for reports and files.
    fn name(&self) -> &str;

    /// Returns the surface. Vertices are those of [`Body::reference`].
    fn surface(&self) -> &BoundaryMesh<D>;

    /// Returns the reference positions of all vertices.
    fn reference(&self) -> &[Point<D>];

    /// Returns whether forces can move the body: false for a prescribed motion, and for a rigid motion that is held as a
    /// whole.
    fn is_movable(&self) -> bool;

    /// Returns the state at time zero.
    fn start(&self) -> BodyState<D>;

    /// Returns the body in the step from `begin` to the end of `time`. Registers its unknowns in `layout`.
    fn step<'s>(
        &'s self,
        begin: &'s BodyState<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Box<dyn BodyStep<D> + 's>;

    /// Returns a map from points to the distance and velocity of the body in a state: the extension of the fluid's
    /// velocity to points that the body has left. Indices for the search are built in this call.
    fn locator<'s>(&'s self, state: &'s BodyState<D>, time: f64) -> Locator<'s, D>;

    /// Returns the mass, momentum, energies, centre and volume; `None` for a body of prescribed motion.
    fn balance(&self, state: &BodyState<D>) -> Option<Balance<D>>;

    /// Returns the cells with their stresses, for output. A body without cells is drawn as its surface.
    fn cells(&self, _state: &BodyState<D>) -> Option<CellOutput<'_, D>> {
        None
    }
}

/// A body in one time step.
pub trait BodyStep<const D: usize>: Sync {
    /// Returns the motion of the surface.
    fn surface(&self) -> &SurfaceMotion<'_, D>;

    /// Adds prescribed values and ties of the body's unknowns.
    fn constrain(&self, layout: &BlockLayout, constraints: &mut Constraints);

    /// Returns the weak form of the body.
    fn contributions<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>>;

    /// Writes the starting guess of the unknowns.
    fn guess(&self, layout: &BlockLayout, x: &mut [f64]);

    /// Returns the state at the end of the step for the solution `x`.
    fn end(&self, layout: &BlockLayout, x: &[f64]) -> BodyState<D>;

    /// Returns the stress of the body on its surface; `None` for bodies without stress.
    fn stress<'p>(&'p self, _layout: &'p BlockLayout) -> Option<Box<dyn SurfaceStress<D> + 'p>> {
        None
    }
}

/// A map from points to the position relative to a body; `None` for a body without a surface.
pub type Locator<'s, const D: usize> = Box<dyn Fn(&Point<D>) -> Option<Located<D>> + 's>;

/// Position of a point relative to a body, and the velocity of the body there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located<const D: usize> {
    /// Whether the point lies inside the body.
    pub is_inside: bool,
    /// Distance of the point from the surface; not significant inside.
    pub distance: f64,
    /// Velocity of the body at the point, or at the closest point of its surface.
    pub velocity: Vector<D>,
}
