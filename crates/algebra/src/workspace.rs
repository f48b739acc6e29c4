//! Memory that outlives one nonlinear solve.

use std::time::Instant;

use crate::linear::{DirectSolver, LinearError, LinearSolver};
use crate::{BlockLayout, BlockSystem, Constraints, Contributions};

/// Owns the system, the linear solver and their recycled memory.
///
/// Size and pattern may change from solve to solve. A workspace never changes results: a solve gives the same bits with
/// a used workspace as with a new one.
pub struct Workspace {
    pub(crate) system: BlockSystem,
    pub(crate) solver: Box<dyn LinearSolver>,
}

impl Workspace {
    /// A workspace with the sparse direct solver.
    pub fn new() -> Self {
        Self::with_solver(Box::new(DirectSolver::new()))
    }

    /// A workspace with another linear solver.
    pub fn with_solver(solver: Box<dyn LinearSolver>) -> Self {
        Self { system: BlockSystem::default(), solver }
    }

    /// The system of the last solve.
    pub fn system(&self) -> &BlockSystem {
        &self.system
    }

    /// Factorises the matrix of the last solve once more and returns the wall-clock seconds that it took: the measure
    /// of what a time step costs.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn time_refactorization(&mut self) -> Result<f64, LinearError> {
        let begin = Instant::now();
        self.solver.factorize(self.system.matrix(), self.system.unknowns())?;
        Ok(begin.elapsed().as_secs_f64())
    }

    /// The linear solver.
    pub fn solver(&self) -> &dyn LinearSolver {
        self.solver.as_ref()
    }

    /// Builds the system of the next solve in the memory of the last one.
    pub(crate) fn prepare(
        &mut self,
        layout: &BlockLayout,
        contributions: &[&dyn Contributions],
        constraints: &Constraints,
    ) {
        self.system = std::mem::take(&mut self.system).recycle(layout, contributions, constraints);
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}
