//! Interface through which results leave the time loop.

use algebra::Workspace;

use crate::{ObserverError, Setup, State, StepReport};

/// Data that an observer receives after a step.
pub struct StepView<'a, const D: usize> {
    /// The problem.
    pub setup: &'a Setup<D>,
    /// The state before the step.
    pub previous: &'a State<D>,
    /// The state after the step. The fluid's fields are given on the geometry of the step,
    /// [`crate::FluidState::positions`].
    pub state: &'a State<D>,
    /// Report of the step; `None` for the state at the start.
    pub report: Option<&'a StepReport<D>>,
    /// The system of the step and the linear solver. A resumed run needs its [`Workspace::memory`] for the same bits.
    pub workspace: &'a Workspace,
}

impl<const D: usize> StepView<'_, D> {
    /// Returns whether a whole step of the setup ends here, and not only a substep.
    pub fn ends_step(&self) -> bool {
        self.report.is_none_or(|report| report.substep.is_last)
    }
}

/// Receiver of all steps, which writes files, collects histories or shows progress.
pub trait Observer<const D: usize> {
    /// Receives the state at the start, then after every step, and after every substep of a step that was divided.
    ///
    /// # Errors
    /// Anything; the run stops.
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError>;
}
