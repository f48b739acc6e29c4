//! Which page of the step stopped.

use algebra::{LinearError, NewtonError, NewtonReport};

/// A setup whose parts do not fit together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A solid refused its data.
    #[error("body {body}")]
    Solid {
        /// Name of the body.
        body: String,
        /// Why.
        source: solid_svk::Error,
    },
    /// A contact refused its data.
    #[error("contact {index}")]
    Contact {
        /// Number of the contact.
        index: usize,
        /// Why.
        source: contact::Error,
    },
    /// A rigid body refused its data.
    #[error("body {body}")]
    Rigid {
        /// Name of the body.
        body: String,
        /// Why.
        source: solid_rigid::Error,
    },
}

/// The stage of a step that failed.
#[derive(Debug, thiserror::Error)]
pub enum Stage {
    /// The surfaces cannot cut the background: a body is turned inside out or torn.
    #[error("cutting the background")]
    Cut(#[from] cutcell::Error),
    /// The cut leaves a part of the interface without a facet: fluid and body would not feel each other there. Move
    /// the body, or the mesh, by a fraction of a cell, and report the case.
    #[error("the cut leaves {uncovered:e} of an interface of {interface:e} without a facet")]
    Interface {
        /// Measure of the interface without a facet.
        uncovered: f64,
        /// Measure of the whole interface.
        interface: f64,
    },
    /// A body that is moved by forces has no vertex in the bounds of the background any more.
    #[error("body {body} has left the domain")]
    LeftDomain {
        /// Its name.
        body: String,
    },
    /// The parts of the setup do not fit together.
    #[error("composing the problem")]
    Setup(#[from] SetupError),
    /// Newton's method failed; the history of residuals is inside.
    #[error("solving the coupled problem")]
    Newton(#[from] NewtonError),
    /// Points of a contact moved farther in the step than it was looked for obstacles: contact may have been missed. Take
    /// smaller steps.
    #[error(
        "contact {contact} may have been missed: its bodies move by {motion:e} in a step, and it looks {room:e} ahead"
    )]
    MissedContact {
        /// Number of the contact.
        contact: usize,
        /// Relative motion in the step, at most.
        motion: f64,
        /// Motion for which obstacles were looked for.
        room: f64,
        /// The solve that came to nothing.
        newton: Box<NewtonReport>,
    },
    /// An observer failed.
    #[error("writing results")]
    Observer(crate::ObserverError),
}

impl Stage {
    /// Whether a smaller step may succeed: not if the matrix is too large for the memory, or has no inverse because of its
    /// pattern.
    pub fn asks_for_a_smaller_step(&self) -> bool {
        let Self::Newton(newton) = self else { return matches!(self, Self::MissedContact { .. }) };
        let NewtonError::Linear { source, .. } = newton else { return true };
        !matches!(
            source,
            LinearError::OutOfMemory { .. }
                | LinearError::EmptyRow { .. }
                | LinearError::EmptyColumn { .. }
                | LinearError::StructurallySingular { .. }
        )
    }

    /// What the nonlinear solver did before the failure.
    pub fn newton_report(&self) -> Option<&NewtonReport> {
        match self {
            Self::Newton(newton) => Some(newton.report()),
            Self::MissedContact { newton, .. } => Some(newton),
            _ => None,
        }
    }
}

/// A step that failed: when, and in which stage.
#[derive(Debug, thiserror::Error)]
#[error("step {step} to time {time:.6} failed")]
pub struct StepError {
    /// Number of the step.
    pub step: usize,
    /// Time at the end of the step.
    pub time: f64,
    /// What failed.
    pub source: Stage,
}

impl StepError {
    /// An error in the given step.
    pub fn at(step: usize, time: f64, source: impl Into<Stage>) -> Self {
        Self { step, time, source: source.into() }
    }
}
