//! The traits of bodies.

use algebra::time::Row;
use algebra::{BlockLayout, Constraints, Contributions};
use mesh::{BoundaryMesh, Point, Vector};

use crate::{Balance, BodyState, CellOutput, StepTime, SurfaceMotion, SurfaceStress};

/// A body with a closed surface that moves. Fluid and contact depend on its surface only.
pub trait Body<const D: usize>: Send + Sync {
    /// Returns the name, for reports and files.
    fn name(&self) -> &str;

    /// Returns the surface. Its facets refer to the vertices of [`Body::reference`].
    fn surface(&self) -> &BoundaryMesh<D>;

    /// Returns the reference positions of all vertices.
    fn reference(&self) -> &[Point<D>];

    /// Returns whether forces can move the body. It is false for a prescribed motion, and for a rigid body whose
    /// translations and rotations are all held.
    fn is_movable(&self) -> bool;

    /// Returns whether unknowns of a step can deform the body.
    fn deforms(&self) -> bool {
        false
    }

    /// Returns the state at time zero.
    fn initial(&self) -> BodyState<D>;

    /// Returns the positions of all vertices at which the background mesh is cut in a step. They are the positions at
    /// the start of the step, or extrapolated to its stage (generalised-α).
    fn geometry(&self, start: &BodyState<D>, time: &StepTime) -> Vec<Point<D>> {
        start.positions_by(&time.weights.extrapolated[0], self.reference())
    }

    /// Prepares the step `time` from the state `start`, and registers the unknowns of the body in `layout`.
    fn step<'s>(
        &'s self,
        start: &'s BodyState<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Box<dyn BodyStep<D> + 's>;

    /// Returns the velocity at the point `x` of a body of prescribed motion at a time; `None` for other bodies.
    fn given_velocity(&self, _x: &Point<D>, _time: f64) -> Option<Vector<D>> {
        None
    }

    /// Returns whether a given motion of the body ends in the step `time`, so that its acceleration jumps.
    fn is_released(&self, _time: &StepTime) -> bool {
        false
    }

    /// Returns the mass, momentum, energies, centre and volume; `None` for a body of prescribed motion.
    fn balance(&self, state: &BodyState<D>) -> Option<Balance<D>>;

    /// Returns the acceleration of the time-dependent part of gravity. This part has no potential, so that its weight
    /// is a load ([`BodyStep::loads`]). The constant part of gravity is in [`Body::balance`].
    fn variable_gravity(&self, _time: f64) -> Vector<D> {
        Vector::zeros()
    }

    /// Evaluates two rows of a time scheme, one for the displacement and one for the velocity. Known values are
    /// displacement and velocity of `state` and the accelerations of `rates`; the unknown velocity is zero. The energy
    /// ledger evaluates the energy of the result ([`algebra::time::Weights::of_energy`]).
    ///
    /// A body whose balance depends on [`BodyState::inner`] must override this method.
    fn at_rows(&self, state: &BodyState<D>, rates: &BodyState<D>, rows: &[Row; 2]) -> BodyState<D> {
        BodyState { level: state.level.at_rows(&rates.level, rows), inner: state.inner.clone() }
    }

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

    /// Returns the weak form of the body without loads.
    fn contributions<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>>;

    /// Returns the external loads on the body.
    fn loads<'p>(&'p self, _layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        Vec::new()
    }

    /// Writes the starting guess of the unknowns, the velocities at the start.
    fn guess(&self, layout: &BlockLayout, x: &mut [f64]);

    /// Returns the state at the end of the step for the solution `x`.
    fn end(&self, layout: &BlockLayout, x: &[f64]) -> BodyState<D>;

    /// Returns the traction `σ n` of the body on its surface, `n` out of the body, as force per area of the surface at
    /// `positions`, the positions of all vertices. `None` for a body that computes no stress.
    fn stress<'p>(
        &'p self,
        _layout: &'p BlockLayout,
        _positions: &'p [Point<D>],
    ) -> Option<Box<dyn SurfaceStress<D> + 'p>> {
        None
    }
}
