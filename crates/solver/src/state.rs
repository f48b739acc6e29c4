//! Everything that changes in time.

use body::{BodyState, StepTime};
use cutcell::CutMesh;
use mesh::{Point, Vector};
use xfem_space::{PartValues, XfemSpace};

use crate::{Setup, StepError};

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
    /// Energy stored in contacts; it counts from zero at the start.
    pub contact_energy: f64,
}

/// Velocity and pressure of the fluid, on the geometry on which they were computed.
#[derive(Clone, Debug)]
pub struct FluidState<const D: usize> {
    /// Positions of the vertices of each body at which the background was cut: those of the stage of the last step.
    pub positions: Vec<Vec<Point<D>>>,
    /// The cut.
    pub cut: CutMesh<D>,
    /// The space on it.
    pub space: XfemSpace<D>,
    /// Velocity, one value per dof of the space.
    pub velocity: Vec<Vector<D>>,
    /// Acceleration at a fixed point, `∂u/∂t`, one value per dof of the space; empty at the start of a run, and with schemes that
    /// do not need it.
    pub acceleration: Vec<Vector<D>>,
    /// Pressure at the stage of the last step, one value per dof of the space.
    pub pressure: Vec<f64>,
    /// Time of that stage.
    pub pressure_time: f64,
    /// Kinetic energy on this geometry.
    pub kinetic_energy: f64,
    /// Kinetic energy of the scheme on this geometry ([`algebra::time::Weights::of_energy`]).
    pub(crate) scheme_energy: f64,
}

impl<const D: usize> State<D> {
    /// Returns the state at time zero.
    ///
    /// # Errors
    /// [`StepError`] if the setup does not pass [`Setup::check`], or the surfaces cannot cut the background.
    pub fn initial(setup: &Setup<D>) -> Result<Self, StepError> {
        setup.check().map_err(|source| StepError::at(0, 0.0, source))?;
        let bodies = setup.bodies.iter().map(|body| body.start()).collect();
        let mut state = Self { step: 0, time: 0.0, fluid: None, bodies, contact_energy: 0.0 };
        if let Some(fluid) = &setup.fluid {
            let positions = setup.positions(&state.bodies);
            let cut = CutMesh::overlay(&fluid.background, &setup.surfaces(&positions), &fluid.overlay)
                .map_err(|source| StepError::at(0, 0.0, source))?;
            let space = XfemSpace::new(&fluid.background, &cut);
            let at_start = |x: &Point<D>| fluid.initial_velocity.as_ref().map_or(Vector::zeros(), |field| field(x));
            let velocity: Vec<_> = space.vertices().iter().map(|&v| at_start(&fluid.background.vertex(v))).collect();
            let parts = PartValues::new(&fluid.background, &cut);
            let kinetic_energy = kinetic_energy(fluid.material.density, &cut, &space, &parts, &velocity);
            let pressure = vec![0.0; space.len()];
            let (acceleration, pressure_time) = (Vec::new(), 0.0);
            state.fluid = Some(FluidState {
                positions,
                cut,
                space,
                velocity,
                acceleration,
                pressure,
                pressure_time,
                kinetic_energy,
                scheme_energy: kinetic_energy,
            });
        }
        Ok(state)
    }

    /// Returns the kinetic energy of the fluid.
    pub(crate) fn fluid_energy(&self) -> f64 {
        self.fluid.as_ref().map_or(0.0, |fluid| fluid.kinetic_energy)
    }

    /// Returns the sum of all energies: kinetic of fluid and solids, elastic, of gravity, stored in contacts.
    pub fn total_energy(&self, setup: &Setup<D>) -> f64 {
        let bodies = setup.bodies.iter().zip(&self.bodies);
        let bodies: f64 = bodies.filter_map(|(body, state)| Some(body.balance(state)?.energy())).sum();
        bodies + self.fluid_energy() + self.contact_energy
    }

    /// Returns the time after one more step of length `dt`. Multiples of the step are exact; sums of a decimal number
    /// are not.
    pub fn next_time(&self, dt: f64) -> f64 {
        let time = self.time + dt;
        let steps = (time / dt).round();
        if (time - steps * dt).abs() <= 1e-9 * time { steps * dt } else { time }
    }

    /// Returns one more step of length `dt`.
    pub fn step_time(&self, setup: &Setup<D>, dt: f64) -> StepTime {
        let of_bodies = self.bodies.iter().map(|body| &body.level.acceleration);
        let of_fluid = self.fluid.iter().map(|fluid| &fluid.acceleration);
        let starts = of_fluid.chain(of_bodies).all(Vec::is_empty);
        StepTime::new(setup.scheme.as_ref(), self.next_time(dt), dt, starts)
    }
}

/// Returns `1/2 (ρ u, u)` of a velocity with one value per dof.
pub(crate) fn kinetic_energy<const D: usize>(
    density: f64,
    cut: &CutMesh<D>,
    space: &XfemSpace<D>,
    parts: &PartValues<D>,
    velocity: &[Vector<D>],
) -> f64 {
    let mut twice = 0.0;
    for part in cut.all_parts() {
        let (moments, dofs) = (parts.moments(part), space.dofs(part));
        for (i, a) in dofs.iter().enumerate() {
            for (j, b) in dofs.iter().enumerate() {
                twice += moments.at(i, j) * velocity[*a as usize].dot(&velocity[*b as usize]);
            }
        }
    }
    0.5 * density * twice
}
