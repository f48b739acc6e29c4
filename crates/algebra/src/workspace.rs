//! Memory that outlives one nonlinear solve.

use std::time::Instant;

use crate::linear::{DirectSolver, LinearError, LinearSolver};
use crate::{BlockLayout, BlockSystem, Constraints, Contributions};

/// Owns the system, the linear solver and their recycled memory.
///
/// Size and pattern may change from solve to solve. With the direct solver a workspace never changes results: a solve gives
/// the same bits with a used workspace as with a new one. A solver that keeps old factors ([`crate::LaggedSolver`]) gives the
/// same result to its tolerance; after [`Workspace::forget`] it gives the same bits.
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

    /// Factorises the matrix of the last solve directly and returns the median of the wall-clock seconds that three
    /// factorisations with a known pattern take: the measure of what a time step costs.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn time_refactorization(&self) -> Result<f64, LinearError> {
        let (matrix, unknowns) = (self.system.matrix(), self.system.unknowns());
        let mut solver = DirectSolver::new();
        solver.factorize(matrix, unknowns)?;
        let mut seconds = [0.0; 3];
        for time in &mut seconds {
            let begin = Instant::now();
            solver.factorize(matrix, unknowns)?;
            *time = begin.elapsed().as_secs_f64();
        }
        seconds.sort_by(f64::total_cmp);
        Ok(seconds[1])
    }

    /// Makes the next solve independent of those before.
    pub fn forget(&mut self) {
        self.solver.forget();
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
        keys: Vec<u64>,
    ) {
        assert!(keys.is_empty() || keys.len() == layout.len(), "one key for each unknown");
        self.system = std::mem::take(&mut self.system).recycle(layout, contributions, constraints);
        self.system.keys = keys;
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}
