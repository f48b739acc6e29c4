//! Solvers of the linear systems of Newton's method.

mod block_gauss_seidel;
mod checked_factors;
mod cholesky;
mod condition;
mod direct;
mod equilibration;
mod factors;
mod fronts;
mod gmres;
mod incomplete;
mod lagged;
mod nodes;
mod static_factors;
mod subdomain;
mod system;

pub use block_gauss_seidel::{BlockGaussSeidel, BlockGaussSeidelSettings};
pub use condition::{Scaling, condition_number};
pub use direct::DirectSolver;
pub use equilibration::Equilibration;
pub use gmres::{Gmres, GmresSettings, LinearMap};
pub use incomplete::Fill;
pub use lagged::{LaggedSettings, LaggedSolver};
pub use subdomain::BlockSolver;
pub use system::{LinearSystem, ScaledMatrix};

/// A borrowed sparse matrix, compressed by columns, with sorted rows.
pub type MatrixView<'a> = sprs::CsMatViewI<'a, f64, u32>;

/// A solver of linear systems.
pub trait LinearSolver: Send {
    /// Prepares solves with the matrix of a system.
    ///
    /// # Errors
    /// See [`LinearError`].
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError>;

    /// Solves `A x = rhs` for the system of the last [`LinearSolver::factorize`], which is passed again.
    ///
    /// Iterative solvers stop at a residual of `tolerance` relative to the right-hand side (Euclidean norms of the
    /// equilibrated system). On error `x` is unchanged.
    ///
    /// # Errors
    /// See [`LinearError`].
    ///
    /// # Panics
    /// `rhs` or `x` does not have the size of the matrix.
    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<LinearReport, LinearError>;

    /// Returns the number of factorisations of a whole matrix so far.
    fn n_factorizations(&self) -> usize;

    /// Returns the number of these factorisations that needed pivoting over the whole matrix, because a pivot inside
    /// its supernode was too small or the factors were too inaccurate. Zero for solvers without such a fallback.
    fn n_fallbacks(&self) -> usize {
        0
    }

    /// Returns the data of earlier matrices on which later solves depend, as lists; empty if there are none.
    fn memory(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Restores the memory of a solver of the same kind and settings. Later solves give the same bits as that solver.
    ///
    /// # Errors
    /// [`LinearError::Memory`]: the lists are not those of such a solver. Errors of a factorisation that is repeated.
    fn recall(&mut self, memory: &[Vec<f64>]) -> Result<(), LinearError> {
        if memory.is_empty() { Ok(()) } else { Err(LinearError::Memory) }
    }
}

/// Work and accuracy of one linear solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Steps of iterative refinement, or iterations of an iterative method.
    pub iterations: usize,
    /// Error of the solution of the equilibrated system. Direct solvers: `‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖)` in maximum
    /// norms; iterative ones: `‖b − A x‖ / ‖b‖` in Euclidean norms.
    pub backward_error: f64,
}

/// Errors of linear solvers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum LinearError {
    /// A row of the matrix is zero: an unknown has no equation. Constrain it, or take it out of the system.
    #[error("row {row} of the matrix is zero")]
    EmptyRow { row: usize },
    /// A column of the matrix is zero: an unknown acts on nothing. Constrain it, or take it out of the system.
    #[error("column {column} of the matrix is zero")]
    EmptyColumn { column: usize },
    /// An entry of the matrix or of the right-hand side is infinite or NaN.
    #[error("row {row} of the linear system is not finite")]
    NotFinite { row: usize },
    /// The matrix has no inverse because of its pattern.
    #[error("the matrix is structurally singular (no pivot number {pivot})")]
    StructurallySingular {
        /// Index of the pivot that was not found.
        pivot: usize,
    },
    /// The matrix is singular to working precision; often a missing constraint (a rigid motion, a pressure constant).
    #[error("the matrix is numerically singular: its inverse is at least {growth:e} large after equilibration")]
    Singular {
        /// Lower bound of the norm of the inverse of the equilibrated matrix (infinite if a pivot was zero).
        growth: f64,
    },
    /// Incomplete factors are far from their matrix.
    #[error("incomplete factors are unstable (relative error {error:e}): keep more fill, or factorise completely")]
    Unstable {
        /// Error of the factors on a vector of entries ±1, relative to it (infinite without a pivot).
        error: f64,
    },
    /// The computed solution does not satisfy the system.
    #[error("backward error {backward_error:e} exceeds {bound:e}")]
    Inaccurate {
        /// Backward error of the solution.
        backward_error: f64,
        /// Largest accepted backward error.
        bound: f64,
    },
    /// An iterative method stopped before its tolerance.
    #[error("no convergence in {iterations} iterations (relative residual {residual:e})")]
    NotConverged {
        iterations: usize,
        /// Relative residual that was reached.
        residual: f64,
    },
    /// The factors need more memory than there is, or more entries than 32-bit indices can number.
    #[error("out of memory while factorising {n_unknowns} unknowns")]
    OutOfMemory { n_unknowns: usize },
    /// Stored lists are not the memory of a solver of this kind.
    #[error("the stored memory of the linear solver is not that of this solver")]
    Memory,
    /// There is no factorised matrix: none was given yet, or its factorisation failed.
    #[error("there is no factorised matrix")]
    NotFactorized,
}
