//! Memory that outlives one nonlinear solve.

use crate::BlockSystem;
use crate::linear::{DirectSolver, LinearSolver};

/// The system and the linear solver, with their recycled memory.
///
/// Size and pattern may change from solve to solve. With the direct solver a workspace does not change results: a solve
/// gives the same bits in a used workspace as in a new one. A solver that keeps old factors ([`crate::LaggedSolver`]) gives
/// the same result to its tolerance, and the same bits after [`Workspace::forget`].
pub struct Workspace {
    pub(crate) system: BlockSystem,
    pub(crate) solver: Box<dyn LinearSolver>,
}

impl Workspace {
    /// Creates a workspace with the sparse direct solver.
    pub fn new() -> Self {
        Self::with_solver(Box::new(DirectSolver::new()))
    }

    /// Creates a workspace with another linear solver.
    pub fn with_solver(solver: Box<dyn LinearSolver>) -> Self {
        Self { system: BlockSystem::default(), solver }
    }

    /// Returns the system of the last solve.
    pub fn system(&self) -> &BlockSystem {
        &self.system
    }

    /// Makes the next solve independent of earlier ones.
    pub fn forget(&mut self) {
        self.solver.forget();
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}
