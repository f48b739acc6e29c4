//! Memory that outlives one nonlinear solve.

use crate::BlockSystem;
use crate::linear::{DirectSolver, LinearError, LinearSolver};

/// The system and the linear solver, with their recycled memory.
///
/// Size and pattern may change from solve to solve. With the direct solver a workspace does not change results: a solve
/// gives the same bits in a used workspace as in a new one. A solver that keeps old factors ([`crate::LaggedSolver`])
/// gives the same result to its tolerance, and the same bits after [`Workspace::recall`].
pub struct Workspace {
    pub(crate) system: BlockSystem,
    pub(crate) solver: Box<dyn LinearSolver>,
}

impl Workspace {
    /// Creates a workspace with the sparse direct solver.
    pub fn new() -> Self {
        Self::with_solver(Box::new(DirectSolver::new()))
    }

    /// Creates a workspace with a given linear solver.
    pub fn with_solver(solver: Box<dyn LinearSolver>) -> Self {
        Self { system: BlockSystem::default(), solver }
    }

    /// Returns the system of the last solve.
    pub fn system(&self) -> &BlockSystem {
        &self.system
    }

    /// Returns the data of the linear solver on which later solves depend ([`LinearSolver::memory`]).
    pub fn memory(&self) -> Vec<Vec<f64>> {
        self.solver.memory()
    }

    /// Restores the memory of a workspace with a linear solver of the same kind.
    ///
    /// # Errors
    /// See [`LinearSolver::recall`].
    pub fn recall(&mut self, memory: &[Vec<f64>]) -> Result<(), LinearError> {
        self.solver.recall(memory)
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}
