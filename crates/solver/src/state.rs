//! The state: data that change in time.

use algebra::time::{Level, Weights};
use body::{BodyState, StepTime};
use cutcell::{CutMesh, PartId};
use mesh::{Point, Vector};
use xfem_space::{PartValues, XfemSpace};

use crate::overlay::overlay;
use crate::{Error, Setup, StepError};

/// The state at one time.
#[derive(Clone, Debug)]
pub struct State<const D: usize> {
    /// Number of whole steps since the start.
    pub step: usize,
    /// Time.
    pub time: f64,
    /// The fluid, if there is one.
    pub fluid: Option<FluidState<D>>,
    /// The bodies, in the order of the setup.
    pub bodies: Vec<BodyState<D>>,
    /// Energy stored in contacts; zero at the start of a run.
    pub contact_energy: f64,
}

/// Velocity and pressure of the fluid, on the geometry on which they were computed.
#[derive(Clone, Debug)]
pub struct FluidState<const D: usize> {
    /// Positions of the vertices of each body at which the background was cut: those at the start of the last step, or
    /// extrapolated to its stage (generalised-α).
    pub positions: Vec<Vec<Point<D>>>,
    /// The cut.
    pub cut: CutMesh<D>,
    /// The space on the cut.
    pub space: XfemSpace<D>,
    /// Velocity, one value per dof of the space.
    pub velocity: Vec<Vector<D>>,
    /// Acceleration at a fixed point, `∂u/∂t`, one value per dof of the space; empty at the start of a run, and with
    /// schemes that do not need it.
    pub acceleration: Vec<Vector<D>>,
    /// Pressure at the stage of the last step, one value per dof of the space.
    pub pressure: Vec<f64>,
    /// Time of the stage of the last step.
    pub pressure_time: f64,
    /// Products of velocity and acceleration on this geometry.
    pub(crate) products: KineticProducts,
}

impl<const D: usize> FluidState<D> {
    /// Returns velocity and pressure at a point of a part with the given shape values.
    pub fn at(&self, part: PartId, shape: &[f64]) -> (Vector<D>, f64) {
        let dofs = self.space.dofs(part).iter().map(|dof| *dof as usize).zip(shape);
        dofs.fold((Vector::zeros(), 0.0), |(u, p), (k, n)| (u + self.velocity[k] * *n, p + self.pressure[k] * *n))
    }
}

/// `1/2 (ρ u, u)`, `(ρ u, a)` and `1/2 (ρ a, a)` of velocity and acceleration of the fluid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KineticProducts(pub(crate) [f64; 3]);

impl<const D: usize> State<D> {
    /// Returns the state at time zero.
    ///
    /// # Errors
    /// [`StepError`] if the setup does not pass [`Setup::check`], or the surfaces cannot cut the background.
    pub fn initial(setup: &Setup<D>) -> Result<Self, StepError> {
        setup.check().map_err(|source| StepError::at(0, 0.0, source))?;
        let bodies = setup.bodies.iter().map(|body| body.initial()).collect();
        let mut state = Self { step: 0, time: 0.0, fluid: None, bodies, contact_energy: 0.0 };
        if let Some(fluid) = &setup.fluid {
            let positions = setup.positions(&state.bodies);
            let cut = overlay(setup, fluid, &positions, 0.0).map_err(|source| StepError::at(0, 0.0, source))?;
            let space = XfemSpace::new(&fluid.background, &cut);
            let at_start = |x: &Point<D>| fluid.initial_velocity.as_ref().map_or(Vector::zeros(), |field| field(x));
            let velocity: Vec<_> = space.vertices().iter().map(|&v| at_start(&fluid.background.vertex(v))).collect();
            let parts = PartValues::new(&fluid.background, &cut);
            let products = KineticProducts::new(fluid.material.density, &cut, &space, &parts, [&velocity, &[]]);
            let pressure = vec![0.0; space.len()];
            let (acceleration, pressure_time) = (Vec::new(), 0.0);
            state.fluid =
                Some(FluidState { positions, cut, space, velocity, acceleration, pressure, pressure_time, products });
        }
        Ok(state)
    }

    /// Checks that the lists of the state have the lengths that a setup needs.
    pub(crate) fn check(&self, setup: &Setup<D>) -> Result<(), Error> {
        let check = |what: &'static str, found: usize, expected: usize| {
            if found == expected { Ok(()) } else { Err(Error::Lists { what, expected, found }) }
        };
        check("bodies", self.bodies.len(), setup.bodies.len())?;
        for (body, state) in setup.bodies.iter().zip(&self.bodies) {
            let (n, Level { displacement, velocity, acceleration }) = (body.reference().len(), &state.level);
            check("displacements of a body", displacement.len(), n)?;
            check("velocities of a body", velocity.len(), n)?;
            check("accelerations of a body", acceleration.len(), if acceleration.is_empty() { 0 } else { n })?;
            check("own numbers of a body", state.inner.len(), body.initial().inner.len())?;
        }
        check("states of the fluid", usize::from(self.fluid.is_some()), usize::from(setup.fluid.is_some()))?;
        for (fluid, setup) in self.fluid.iter().zip(&setup.fluid) {
            let (n, FluidState { velocity, acceleration, pressure, .. }) = (fluid.space.len(), fluid);
            check("cells of the background", fluid.cut.n_cells(), setup.background.n_cells())?;
            check("velocities of the fluid", velocity.len(), n)?;
            check("accelerations of the fluid", acceleration.len(), if acceleration.is_empty() { 0 } else { n })?;
            check("pressures of the fluid", pressure.len(), n)?;
        }
        Ok(())
    }

    /// Returns the kinetic energy of the fluid.
    pub fn fluid_energy(&self) -> f64 {
        self.fluid.as_ref().map_or(0.0, |fluid| fluid.products.energy())
    }

    /// Returns the time after one more step of length `dt`, or the multiple of `dt` that equals it within round-off.
    pub fn next_time(&self, dt: f64) -> f64 {
        let time = self.time + dt;
        let steps = (time / dt).round();
        if (time - steps * dt).abs() <= (1e-9 * time).min(1e-3 * dt) { steps * dt } else { time }
    }

    /// Returns one more step of length `dt`.
    pub fn step_time(&self, setup: &Setup<D>, dt: f64) -> StepTime {
        StepTime::new(setup.scheme.as_ref(), self.next_time(dt), dt, !self.has_accelerations())
    }

    /// Returns whether accelerations are known.
    pub(crate) fn has_accelerations(&self) -> bool {
        let of_bodies = self.bodies.iter().map(|body| &body.level.acceleration);
        let of_fluid = self.fluid.iter().map(|fluid| &fluid.acceleration);
        of_fluid.chain(of_bodies).any(|accelerations| !accelerations.is_empty())
    }

    /// Returns the state without accelerations, from which a scheme starts as from the beginning of a run.
    pub(crate) fn without_accelerations(mut self) -> Self {
        self.bodies.iter_mut().for_each(|body| body.level.acceleration.clear());
        if let Some(fluid) = &mut self.fluid {
            fluid.acceleration.clear();
            fluid.products = fluid.products.of_velocity();
        }
        self
    }
}

impl KineticProducts {
    /// Computes the products of fields with one value per dof; an empty acceleration means zero.
    pub(crate) fn new<const D: usize>(
        density: f64,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        parts: &PartValues<D>,
        [velocity, acceleration]: [&[Vector<D>]; 2],
    ) -> Self {
        let mut sums = [0.0; 3];
        for part in cut.all_parts() {
            let (moments, dofs) = (parts.moments(part), space.dofs(part));
            for (i, a) in dofs.iter().enumerate() {
                for (j, b) in dofs.iter().enumerate() {
                    let (a, b, moment) = (*a as usize, *b as usize, moments.at(i, j));
                    sums[0] += moment * velocity[a].dot(&velocity[b]);
                    if !acceleration.is_empty() {
                        sums[1] += moment * velocity[a].dot(&acceleration[b]);
                        sums[2] += moment * acceleration[a].dot(&acceleration[b]);
                    }
                }
            }
        }
        Self([0.5 * density * sums[0], density * sums[1], 0.5 * density * sums[2]])
    }

    /// Returns the kinetic energy.
    pub(crate) fn energy(&self) -> f64 {
        self.0[0]
    }

    /// Returns the products with an acceleration of zero.
    fn of_velocity(&self) -> Self {
        Self([self.0[0], 0.0, 0.0])
    }

    /// Returns the kinetic energy of the scheme.
    pub(crate) fn scheme_energy(&self, weights: &Weights) -> f64 {
        let energies = weights.of_energy.map(|[_, row]| {
            let [u, a] = [row.velocity, row.acceleration];
            u * u * self.0[0] + u * a * self.0[1] + a * a * self.0[2]
        });
        0.5 * (energies[0] + energies[1])
    }
}
