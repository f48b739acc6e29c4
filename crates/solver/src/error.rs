//! Errors of time steps.

use algebra::{LinearError, NewtonError, NewtonReport};
use contact::StressSource;

/// Error of an observer.
pub type ObserverError = Box<dyn std::error::Error + Send + Sync>;

/// Error of a setup, a state or a step.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// A parameter of the setup is out of range.
    #[error("a parameter of the setup is out of range")]
    Parameter(#[from] mesh::ParameterError),
    /// A contact was made for other bodies than those of the setup.
    #[error("contact {contact} was made for other bodies than those of the setup")]
    Contact {
        /// Index of the contact in the setup.
        contact: usize,
        source: contact::Error,
    },
    /// A body and the fluid are described in different coordinates.
    #[error(
        "body {body} is not described in the coordinates of the background; make both meshes axisymmetric, or both Cartesian"
    )]
    Coordinates { body: String },
    /// A side of the background lies on the axis of axisymmetric coordinates and has another condition than symmetry.
    #[error(
        "a side of the background lies on the axis of rotation, so its condition must be symmetry across the radius"
    )]
    Axis,
    /// Two conditions of the fluid are for the same sides, of which only the first would hold.
    #[error("the fluid has two conditions on sides with the tag \"{side}\"; leave one of them out")]
    RepeatedCondition { side: String },
    /// A condition of the fluid is for sides that the background does not have. Tags belong to one mesh.
    #[error(
        "condition {condition} of the fluid has a tag that no side of the background has; take the tag from this background"
    )]
    UnknownSide {
        /// Index of the condition in the setup.
        condition: usize,
    },
    /// The surfaces cannot cut the background: a body is turned inside out or torn.
    #[error("the surfaces cannot cut the background")]
    Cut(#[from] cutcell::Error),
    /// Some faces between fluid and body belong to no facet of a body: fluid and body would not be coupled there. Move
    /// the body, or the mesh, by a fraction of a cell, and report the case.
    #[error(
        "the cut leaves {uncovered:e} of an interface of {interface:e} without a facet; move the body or the mesh by a fraction of a cell"
    )]
    Interface {
        /// Measure of the interface without a facet.
        uncovered: f64,
        /// Measure of the whole interface.
        interface: f64,
    },
    /// A movable body has no vertex inside the bounding box of the background any more.
    #[error(
        "body {body} has left the background, where nothing can stop it: check the signs and units of its gravity, of the densities, of the body \
         force of the fluid and of given pressures, and whether the results of earlier steps are plausible; for a body that may come that far enlarge \
         the background, give it a contact with the wall, or hold it"
    )]
    LeftDomain { body: String },
    /// A contact law depends on a stress that the setup does not have: that of the solid for a rigid or prescribed
    /// slave, or that of the fluid without a fluid.
    #[error(
        "the contact law of body {body} depends on the stress of the {}, which this setup does not have; use a law \
         without stress",
        if *stress == StressSource::Fluid { "fluid" } else { "solid" }
    )]
    MissingStress {
        stress: StressSource,
        /// Name of the slave.
        body: String,
    },
    /// The mortar is unstable with a share of the solid in its traction. Use `α = 1`, smaller steps, or a larger
    /// penalty.
    #[error(
        "with alpha = {alpha} the mortar at body {body} is stable only if its penalty is at least {required:e}, and it is {penalty:e}: the traction \
         of the solid grows with its stiffness times the step over the size of its cells; use alpha = 1, or smaller steps, or a larger penalty"
    )]
    UnstableShare {
        /// Weight of the fluid's traction.
        alpha: f64,
        body: String,
        /// Smaller eigenvalue of the penalty.
        penalty: f64,
        /// Smallest penalty for which the mortar is stable.
        required: f64,
    },
    /// Lists of a state do not have the lengths that this setup needs: they belong to another problem.
    #[error("the state does not belong to this problem: {what}: {found} found, {expected} expected")]
    Lists {
        what: &'static str,
        /// Its length in this setup.
        expected: usize,
        found: usize,
    },
    /// Newton's method failed; the error contains the history of residuals.
    #[error("the equations of the step are not solved")]
    Newton(#[from] NewtonError),
    /// The linear system that extends velocities into fluid that a body has uncovered is not solved.
    #[error("the velocity of the fluid is not extended to where a body has left")]
    Extension(#[source] NewtonError),
    /// Bodies in contact moved farther in the step than obstacles were searched: contact may have been missed. Take
    /// smaller steps.
    #[error(
        "contact {contact} may have been missed: its bodies move by {motion:e} in a step, and the search \
         allows {room:e}; take smaller steps"
    )]
    MissedContact {
        /// Index of the contact in the setup.
        contact: usize,
        /// Sum of the largest motions of slave and master in the step.
        motion: f64,
        /// Motion for which obstacles were searched.
        room: f64,
        /// Report of the nonlinear solve, which is discarded.
        newton: Box<NewtonReport>,
    },
    /// A vertex entered an obstacle in a step and came out of it, or is closer to another side at the end. Take smaller
    /// steps.
    #[error(
        "in contact {contact} a body passes through its obstacle: a vertex moves by {motion:e} in a step, from one side to another; take smaller steps"
    )]
    PassedThrough {
        /// Index of the contact in the setup.
        contact: usize,
        /// Motion of the vertex relative to the obstacle.
        motion: f64,
        /// Report of the nonlinear solve, which is discarded.
        newton: Box<NewtonReport>,
    },
    /// The multipliers of a contact still change after many solves of the step: the body does not fit between its
    /// obstacles, or surfaces change between contact, sticking and slipping from solve to solve.
    #[error(
        "the multipliers of contact {contact} still change by {change:.3e} after {solves} solves, and {accepted:.3e}, a force per area, is accepted; \
         check that the body fits between its obstacles, and try a larger parameter of its law, with friction also a smaller one, or a larger tolerance"
    )]
    Multipliers {
        /// Index of the contact in the setup.
        contact: usize,
        solves: usize,
        /// Largest change of the traction between the last two solves, force per area.
        change: f64,
        /// Largest change that is accepted.
        accepted: f64,
        /// Report of the solves, which are discarded.
        newton: Box<NewtonReport>,
    },
    /// A cell of an elastic body is inside out at the end of the step. Take smaller steps; where the load is too large
    /// for the stiffness and size of the cells, use finer cells or a stiffer material.
    #[error(
        "a cell of body {body} at {place:?} is inside out: det F is {ratio:.3e}; take smaller steps, finer \
         cells of the body or a stiffer material"
    )]
    Inverted {
        body: String,
        /// Middle of the cell.
        place: Vec<f64>,
        /// Smallest `det F`.
        ratio: f64,
        /// Report of the nonlinear solve, which is discarded.
        newton: Box<NewtonReport>,
    },
    /// An observer failed.
    #[error("an observer failed to record the step")]
    Observer(#[source] ObserverError),
}

impl Error {
    /// Returns whether a smaller step may succeed: after a failure of Newton's method, multipliers that do not settle,
    /// a missed or passed contact or an inverted cell, except if the matrix is too large for the memory or structurally
    /// singular.
    pub fn smaller_step_may_succeed(&self) -> bool {
        let (Self::Newton(newton) | Self::Extension(newton)) = self else {
            return matches!(
                self,
                Self::Multipliers { .. }
                    | Self::MissedContact { .. }
                    | Self::PassedThrough { .. }
                    | Self::Inverted { .. }
            );
        };
        let NewtonError::Linear { source, .. } = newton else { return true };
        !matches!(
            source,
            LinearError::OutOfMemory { .. }
                | LinearError::EmptyRow { .. }
                | LinearError::EmptyColumn { .. }
                | LinearError::StructurallySingular { .. }
        )
    }

    /// Returns the report of the nonlinear solver before the failure.
    pub fn newton_report(&self) -> Option<&NewtonReport> {
        match self {
            Self::Newton(newton) | Self::Extension(newton) => Some(newton.report()),
            Self::MissedContact { newton, .. }
            | Self::PassedThrough { newton, .. }
            | Self::Multipliers { newton, .. }
            | Self::Inverted { newton, .. } => Some(newton),
            _ => None,
        }
    }
}

/// A step that failed, or a state that cannot be built: number, time and cause.
#[derive(Debug, thiserror::Error)]
#[error("{}", if *step == 0 { "the initial state cannot be built".to_owned() } else { format!("step {step} to time {time:.6} failed") })]
pub struct StepError {
    /// Number of the step. The first one is 1, and 0 is the state at the start.
    pub step: usize,
    /// Time at the end of the step.
    pub time: f64,
    /// Cause.
    pub source: Error,
}

impl StepError {
    /// Creates an error in the given step.
    pub fn at(step: usize, time: f64, source: impl Into<Error>) -> Self {
        Self { step, time, source: source.into() }
    }
}
