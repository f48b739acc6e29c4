//! Sparse LU (faer) with iterative refinement.

use super::factors::{Factors, max_norm};
use super::{LinearError, LinearReport, LinearSolver, LinearSystem};

/// Largest accepted backward error of a solution.
const BACKWARD_ERROR_BOUND: f64 = 1e-11;
/// Backward error below which refinement stops.
const BACKWARD_ERROR_GOAL: f64 = 1e-15;
/// Most steps of iterative refinement.
const MAX_REFINEMENTS: usize = 2;

/// Sparse LU with partial pivoting and a COLAMD ordering of the nodes.
///
/// The equilibrated matrix is factorised in one thread, so that bits do not depend on the number of threads. Every
/// solution is refined at most twice with its true residual and accepted only if its backward error
///
/// `‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖)`, maximum norms of the equilibrated system,
///
/// is below 1e-11. A matrix is rejected as singular if the solution for a fixed right-hand side of pseudo-random signs
/// is larger than 1e13.
///
/// The symbolic factorisation is kept while the pattern stays the same. The memory of the factors is always kept.
#[derive(Default)]
pub struct DirectSolver {
    factors: Factors,
    is_factorized: bool,
    /// Largest absolute row sum of the equilibrated matrix.
    norm: f64,
    rhs: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

impl DirectSolver {
    /// Creates a solver without a matrix.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the number of analyses of a pattern so far.
    pub fn n_symbolic_factorizations(&self) -> usize {
        self.factors.n_symbolic
    }
}

impl LinearSolver for DirectSolver {
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError> {
        self.is_factorized = false;
        let matrix = system.matrix;
        let row_sum = &mut self.residual;
        row_sum.clear();
        row_sum.resize(matrix.rows(), 0.0);
        matrix.indices().iter().zip(matrix.data()).for_each(|(row, value)| row_sum[*row as usize] += value.abs());
        self.norm = max_norm(row_sum);
        if !system.is_empty() {
            self.factors.factorize(matrix, &system.layout.nodes())?;
            self.factors.probe(system.len(), &mut self.solution)?;
        }
        self.is_factorized = true;
        Ok(())
    }

    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        _tolerance: f64,
    ) -> Result<LinearReport, LinearError> {
        if !self.is_factorized {
            return Err(LinearError::NotFactorized);
        }
        system.scale_rhs(rhs, x, &mut self.rhs)?;
        let mut report = LinearReport::default();
        if system.is_empty() {
            return Ok(report);
        }
        self.solution.clone_from(&self.rhs);
        self.factors.substitute(&mut self.solution)?;
        loop {
            self.residual.clear();
            self.residual.extend(self.rhs.iter().map(|b| -b));
            sprs::prod::mul_acc_mat_vec_csc(
                system.matrix.view(),
                self.solution.as_slice(),
                self.residual.as_mut_slice(),
            );
            let size = self.norm * max_norm(&self.solution) + max_norm(&self.rhs);
            if !size.is_finite() {
                return Err(LinearError::Singular { growth: f64::INFINITY });
            }
            let error = max_norm(&self.residual);
            report.backward_error = if error == 0.0 { 0.0 } else { error / size };
            if report.backward_error <= BACKWARD_ERROR_GOAL || report.iterations == MAX_REFINEMENTS {
                break;
            }
            self.factors.substitute(&mut self.residual)?;
            self.solution.iter_mut().zip(&self.residual).for_each(|(x, dx)| *x -= dx);
            report.iterations += 1;
        }
        if report.backward_error > BACKWARD_ERROR_BOUND {
            return Err(LinearError::Inaccurate { backward_error: report.backward_error, bound: BACKWARD_ERROR_BOUND });
        }
        system.unscale(&self.solution, x);
        Ok(report)
    }

    fn n_factorizations(&self) -> usize {
        self.factors.n_numeric
    }
}
