//! The traits of bodies.

use algebra::time::Row;
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

    /// Returns the positions of all vertices on which the geometry of a step is evaluated: those at its start, or extrapolated
    /// to its stage (generalised-α).
    fn geometry(&self, begin: &BodyState<D>, time: &StepTime) -> Vec<Point<D>> {
        begin.positions_by(&time.weights.extrapolated[0], self.reference())
    }

    /// Returns the body in the step from `begin` to the end of `time`. Registers its unknowns in `layout`.
    fn step<'s>(
        &'s self,
        begin: &'s BodyState<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Box<dyn BodyStep<D> + 's>;

    /// Returns the velocity at a point of a body of prescribed motion; `None` for other bodies.
    fn given_velocity(&self, _x: &Point<D>, _time: f64) -> Option<Vector<D>> {
        None
    }

    /// Returns the mass, momentum, energies, centre and volume; `None` for a body of prescribed motion.
    fn balance(&self, state: &BodyState<D>) -> Option<Balance<D>>;

    /// Returns the part of gravity that varies in time, at a time; the weight of a constant one is in the balance. It has
    /// no potential, and its weight is one of the loads.
    fn variable_gravity(&self, _time: f64) -> Vector<D> {
        Vector::zeros()
    }

    /// Returns the state with displacement and velocity given by two rows of the scheme, with the accelerations of `rates`. The
    /// ledger evaluates its energy ([`algebra::time::Weights::of_energy`]).
    ///
    /// A body whose balance depends on [`BodyState::inner`] overrides this method.
    fn at_rows(&self, state: &BodyState<D>, rates: &BodyState<D>, rows: &[Row; 2]) -> BodyState<D> {
        BodyState { level: state.level.by(&rates.level, rows), inner: state.inner.clone() }
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

    /// Writes the starting guess of the unknowns.
    fn guess(&self, layout: &BlockLayout, x: &mut [f64]);

    /// Returns the state at the end of the step for the solution `x`.
    fn end(&self, layout: &BlockLayout, x: &[f64]) -> BodyState<D>;

    /// Returns the stress of the body on its surface, force per area of the surface at the given positions of its
    /// vertices; `None` for bodies without stress.
    fn stress<'p>(
        &'p self,
        _layout: &'p BlockLayout,
        _positions: &'p [Point<D>],
    ) -> Option<Box<dyn SurfaceStress<D> + 'p>> {
        None
    }
}
