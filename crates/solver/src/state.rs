//! What changes in time.

use cutcell::CutMesh;
use mesh::{Placed, Point, Vector};
use solid_rigid::RigidMotion;
use xfem_space::XfemSpace;

use crate::setup::BodyKind;
use crate::{Setup, StepError};

/// The state at one time.
#[derive(Clone, Debug)]
pub struct State<const D: usize> {
    /// Number of whole steps since the start.
    pub step: usize,
    /// Time.
    pub time: f64,
    /// The fluid.
    pub fluid: FluidState<D>,
    /// The bodies, in the order of the setup.
    pub bodies: Vec<BodyState<D>>,
}

/// Velocity and pressure of the fluid, on the geometry that they were computed on.
#[derive(Clone, Debug)]
pub struct FluidState<const D: usize> {
    /// Positions of the vertices of each body at which the background was cut.
    pub positions: Vec<Vec<Point<D>>>,
    /// The cut.
    pub cut: CutMesh<D>,
    /// The space on it.
    pub space: XfemSpace<D>,
    /// Velocity, one value per dof of the space.
    pub velocity: Vec<Vector<D>>,
    /// Pressure, one value per dof of the space.
    pub pressure: Vec<f64>,
}

/// Displacement, velocity and acceleration of the vertices of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyState<const D: usize> {
    /// Displacement from the reference positions.
    pub displacement: Vec<Vector<D>>,
    /// Velocity.
    pub velocity: Vec<Vector<D>>,
    /// Acceleration of an elastic body; `None` at the start, where it follows from the first step.
    pub acceleration: Option<Vec<Vector<D>>>,
    /// Position, rotation, velocity and spin of a rigid body, which the others follow from.
    pub rigid: Option<RigidMotion<D>>,
}

impl<const D: usize> BodyState<D> {
    /// Current positions.
    pub fn positions(&self, reference: &[Point<D>]) -> Vec<Point<D>> {
        reference.iter().zip(&self.displacement).map(|(x, d)| x + d).collect()
    }
}

impl<const D: usize> State<D> {
    /// Time after one more step. Multiples of the step are hit as such: sums of a decimal number drift.
    pub fn next_time(&self, dt: f64) -> f64 {
        next_time(self.time, dt)
    }

    /// The state at time zero.
    ///
    /// # Errors
    /// [`StepError`] if the surfaces cannot cut the background.
    pub fn initial(setup: &Setup<D>) -> Result<Self, StepError> {
        let bodies: Vec<BodyState<D>> = setup.bodies.iter().map(|body| initial_body(&body.kind)).collect();
        let positions = setup.positions(&bodies);
        let cut = CutMesh::overlay(&setup.background, &setup.surfaces(&positions), &setup.overlay)
            .map_err(|source| StepError::at(0, 0.0, source))?;
        let space = XfemSpace::new(&setup.background, &cut);
        let at_rest = |_: &Point<D>| Vector::zeros();
        let velocity_at: &dyn Fn(&Point<D>) -> Vector<D> = match &setup.fluid.initial_velocity {
            Some(field) => field.as_ref(),
            None => &at_rest,
        };
        let velocity = space.vertices().iter().map(|&v| velocity_at(&setup.background.vertex(v))).collect();
        let pressure = vec![0.0; space.len()];
        Ok(Self { step: 0, time: 0.0, fluid: FluidState { positions, cut, space, velocity, pressure }, bodies })
    }
}

/// Time one step after a time; multiples of the step are hit as such.
pub(crate) fn next_time(time: f64, dt: f64) -> f64 {
    let time = time + dt;
    let steps = (time / dt).round();
    if (time - steps * dt).abs() <= 1e-9 * time { steps * dt } else { time }
}

/// A body at time zero.
pub(crate) fn initial_body<const D: usize>(kind: &BodyKind<D>) -> BodyState<D> {
    match kind {
        BodyKind::Elastic(body) => {
            let vertices = body.solid.mesh().vertices();
            let evaluate = |field: &Option<crate::PointField<D>>| {
                vertices.iter().map(|x| field.as_ref().map_or(Vector::zeros(), |f| f(x))).collect()
            };
            BodyState {
                displacement: evaluate(&body.initial_displacement),
                velocity: evaluate(&body.initial_velocity),
                acceleration: None,
                rigid: None,
            }
        }
        BodyKind::Rigid(body) => {
            let motion = RigidMotion::initial(&body.mass, body.initial_velocity, body.initial_spin);
            rigid_body(body, motion)
        }
        BodyKind::Prescribed(body) => prescribed_body(body, 0.0),
    }
}

/// A body of given motion at a time.
pub(crate) fn prescribed_body<const D: usize>(body: &crate::PrescribedBody<D>, time: f64) -> BodyState<D> {
    let at: Vec<Point<D>> = body.reference.iter().map(|x| (body.position)(x, time)).collect();
    BodyState {
        velocity: at.iter().map(|x| (body.velocity)(x, [time; 2])).collect(),
        displacement: at.iter().zip(&body.reference).map(|(x, reference)| x - reference).collect(),
        acceleration: None,
        rigid: None,
    }
}

/// A rigid body in a given motion.
pub(crate) fn rigid_body<const D: usize>(body: &crate::RigidBody<D>, motion: RigidMotion<D>) -> BodyState<D> {
    let at: Vec<Point<D>> = body.reference.iter().map(|x| motion.position(&body.mass, x)).collect();
    BodyState {
        velocity: at.iter().map(|x| motion.velocity_at(x)).collect(),
        displacement: at.iter().zip(&body.reference).map(|(x, reference)| x - reference).collect(),
        acceleration: None,
        rigid: Some(motion),
    }
}

impl<const D: usize> Setup<D> {
    /// Current positions of the vertices of each body.
    pub fn positions(&self, bodies: &[BodyState<D>]) -> Vec<Vec<Point<D>>> {
        self.bodies.iter().zip(bodies).map(|(body, state)| state.positions(body.reference())).collect()
    }

    /// The surfaces of the bodies at the given positions.
    pub fn surfaces<'a>(&'a self, positions: &'a [Vec<Point<D>>]) -> Vec<Placed<'a, D>> {
        self.bodies.iter().zip(positions).map(|(body, x)| Placed::new(body.boundary(), x)).collect()
    }
}
