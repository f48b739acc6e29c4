//! Sparse LU (faer) inside equilibration and iterative refinement.

use sprs::CsMatI;

use super::factors::{Factors, max_norm};
use super::{Equilibration, LinearError, LinearReport, LinearSolver, MatrixView, Unknowns, check_sides};

/// Largest accepted backward error of a solution.
const BACKWARD_ERROR_BOUND: f64 = 1e-11;
/// Backward error below which refinement stops.
const BACKWARD_ERROR_GOAL: f64 = 1e-15;
/// Most steps of iterative refinement.
const MAX_REFINEMENTS: usize = 2;

/// Sparse LU with partial pivoting and a COLAMD ordering of the nodes.
///
/// The matrix is equilibrated ([`Equilibration`]) and factorised in one thread, so that bits do not depend on the number of
/// threads. Every solution is refined at most twice with its true residual and accepted only if its backward error
///
/// `‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖)`, maximum norms of the equilibrated system,
///
/// is below 1e-11. A matrix is refused as singular if the solution for a fixed right-hand side of pseudo-random signs
/// is larger than 1e13.
///
/// The symbolic factorisation is kept while the pattern stays the same, the memory of the factors always.
#[derive(Default)]
pub struct DirectSolver {
    scales: Equilibration,
    /// The equilibrated matrix; none before the first factorisation and after one that failed.
    matrix: Option<CsMatI<f64, u32>>,
    /// Largest absolute row sum of the equilibrated matrix.
    norm: f64,
    /// Nodes of the unknowns, for which the ordering was made.
    nodes: Vec<u32>,
    factors: Factors,
    growth: f64,
    rhs: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

impl DirectSolver {
    /// A solver without a matrix.
    pub fn new() -> Self {
        Self::default()
    }

    /// How often a pattern was analysed so far.
    pub fn n_symbolic_factorizations(&self) -> usize {
        self.factors.n_symbolic
    }

    /// Lower bound of the norm of the inverse of the last equilibrated matrix.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// Copies the scaled values into `owned`, a matrix with the pattern of `matrix`, and measures their norm.
    fn scale(&mut self, matrix: MatrixView<'_>, owned: &mut CsMatI<f64, u32>) {
        let row_sum = &mut self.residual;
        row_sum.clear();
        row_sum.resize(matrix.rows(), 0.0);
        self.scales.scale(matrix, owned.data_mut());
        owned.indices().iter().zip(owned.data()).for_each(|(row, value)| row_sum[*row as usize] += value.abs());
        self.norm = max_norm(row_sum);
    }
}

impl LinearSolver for DirectSolver {
    fn factorize(&mut self, matrix: MatrixView<'_>, unknowns: Unknowns<'_>) -> Result<(), LinearError> {
        assert!(matrix.is_csc() && matrix.rows() == matrix.cols(), "a square matrix compressed by columns");
        assert_eq!(matrix.rows(), unknowns.nodes.len(), "nodes of the unknowns");
        let previous = self.matrix.take();
        self.scales.compute(matrix)?;
        let column_ptr = matrix.proper_indptr();
        let mut owned = match previous {
            Some(m)
                if m.proper_indptr() == column_ptr
                    && m.indices() == matrix.indices()
                    && self.nodes == unknowns.nodes =>
            {
                m
            }
            _ => {
                self.factors.clear_pattern();
                self.nodes.clear();
                self.nodes.extend_from_slice(unknowns.nodes);
                let (rows, values) = (matrix.indices().to_vec(), matrix.data().to_vec());
                CsMatI::new_csc(matrix.shape(), column_ptr.to_vec(), rows, values)
            }
        };
        self.scale(matrix, &mut owned);
        if owned.rows() > 0 {
            self.factors.factorize(&owned, &self.nodes)?;
            self.growth = self.factors.probe(owned.rows(), &mut self.solution)?;
        }
        self.matrix = Some(owned);
        Ok(())
    }

    fn solve(&mut self, rhs: &[f64], x: &mut [f64], _tolerance: f64) -> Result<LinearReport, LinearError> {
        let Some(matrix) = &self.matrix else { return Err(LinearError::NotFactorized) };
        check_sides(matrix.rows(), rhs, x)?;
        if matrix.rows() == 0 {
            return Ok(LinearReport::default());
        }
        self.rhs.clear();
        self.rhs.extend(rhs.iter().zip(self.scales.row()).map(|(b, r)| b * r));
        self.solution.clone_from(&self.rhs);
        self.factors.substitute(&mut self.solution)?;
        let mut report = LinearReport::default();
        loop {
            self.residual.clear();
            self.residual.extend(self.rhs.iter().map(|b| -b));
            sprs::prod::mul_acc_mat_vec_csc(matrix.view(), self.solution.as_slice(), self.residual.as_mut_slice());
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
            for (x, dx) in self.solution.iter_mut().zip(&self.residual) {
                *x -= dx;
            }
            report.iterations += 1;
        }
        if report.backward_error > BACKWARD_ERROR_BOUND {
            return Err(LinearError::Inaccurate { backward_error: report.backward_error, bound: BACKWARD_ERROR_BOUND });
        }
        for ((x, y), c) in x.iter_mut().zip(&self.solution).zip(self.scales.column()) {
            *x = y * c;
        }
        Ok(report)
    }

    fn equilibration(&self) -> &Equilibration {
        &self.scales
    }

    fn n_factorizations(&self) -> usize {
        self.factors.n_numeric
    }
}
