//! LU factors for preconditioners, in single precision where this is accurate enough.

use sprs::CsMatI;

use super::LinearError;
use super::factors::{Factors, signs};
use super::static_factors::StaticFactors;

/// Largest accepted relative residual of a solve with the factors for a right-hand side of entries ±1.
const LARGEST_RESIDUAL: f64 = 0.1;

/// Static factors in single precision. They are replaced by factors with free pivoting (over the whole matrix) in
/// double precision if a pivot is too small, or if a solve does not reduce its residual.
#[derive(Default)]
pub(super) struct CheckedFactors {
    fast: StaticFactors<f32>,
    /// Used instead of `fast` if present.
    pivoting: Option<Box<Factors>>,
    n_unknowns: usize,
    solution: Vec<f64>,
}

impl CheckedFactors {
    /// Computes the factors of an equilibrated matrix.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`]; errors of the factors with free pivoting.
    pub(super) fn factorize(&mut self, matrix: &CsMatI<f64, u32>, nodes: &[u32]) -> Result<(), LinearError> {
        self.n_unknowns = matrix.rows();
        self.pivoting = None;
        match self.fast.factorize(matrix, nodes) {
            Ok(()) if self.residual(matrix)? <= LARGEST_RESIDUAL => Ok(()),
            Err(out_of_memory @ LinearError::OutOfMemory { .. }) => Err(out_of_memory),
            _ => self.factorize_with_pivoting(matrix, nodes),
        }
    }

    /// Computes factors with free pivoting.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub(super) fn factorize_with_pivoting(
        &mut self,
        matrix: &CsMatI<f64, u32>,
        nodes: &[u32],
    ) -> Result<(), LinearError> {
        self.n_unknowns = matrix.rows();
        self.fast = StaticFactors::default();
        let factors = self.pivoting.insert(Box::default());
        factors.factorize(matrix, nodes)?;
        factors.probe(self.n_unknowns, &mut self.solution)
    }

    /// Returns whether the factors have free pivoting.
    pub(super) fn is_pivoting(&self) -> bool {
        self.pivoting.is_some()
    }

    /// Returns the size of the matrix.
    pub(super) fn len(&self) -> usize {
        self.n_unknowns
    }

    /// Solves with the factors, in place.
    ///
    /// # Errors
    /// [`LinearError::NotFactorized`].
    pub(super) fn substitute(&mut self, x: &mut [f64]) -> Result<(), LinearError> {
        match &mut self.pivoting {
            Some(factors) => factors.substitute(x),
            None => self.fast.substitute(x),
        }
    }

    /// Returns the relative residual of a solve with the factors for a right-hand side of entries ±1.
    fn residual(&mut self, matrix: &CsMatI<f64, u32>) -> Result<f64, LinearError> {
        let mut x = std::mem::take(&mut self.solution);
        x.clear();
        x.extend(signs().take(self.n_unknowns));
        self.substitute(&mut x)?;
        let mut residual: Vec<f64> = signs().take(self.n_unknowns).map(|b| -b).collect();
        sprs::prod::mul_acc_mat_vec_csc(matrix.view(), x.as_slice(), residual.as_mut_slice());
        self.solution = x;
        Ok((residual.iter().map(|r| r * r).sum::<f64>() / self.n_unknowns as f64).sqrt())
    }
}
