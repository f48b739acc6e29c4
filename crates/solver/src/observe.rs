//! How results leave the time loop.

use crate::{Setup, State, StepReport};

/// What an observer sees after a step.
pub struct StepView<'a, const D: usize> {
    /// The problem.
    pub setup: &'a Setup<D>,
    /// The state before the step.
    pub previous: &'a State<D>,
    /// The state after the step. The fluid's fields live on the geometry at the start of the step.
    pub state: &'a State<D>,
    /// What the step reports; `None` for the state at the start.
    pub report: Option<&'a StepReport<D>>,
}

/// An observer that could not do its work.
pub type ObserverError = Box<dyn std::error::Error + Send + Sync>;

/// Something that looks at every step: writes files, collects histories, shows progress.
pub trait Observer<const D: usize> {
    /// Called with the state at the start, then after every step.
    ///
    /// # Errors
    /// Anything; the run stops.
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError>;
}
