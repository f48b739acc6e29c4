//! Sparse Cholesky factors (faer) of a scaled symmetric matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::{Conj, MatMut, Par, Side};
use sprs::CsMatI;

use super::LinearError;
use super::factors::faer_view;

/// Largest difference of mirrored entries, relative to their diagonal entries, that counts as round-off.
const ASYMMETRY: f64 = 1e-10;

/// Cholesky factors of `R A C D⁻¹`, which is the symmetric `R A R` with the ratios `D = C R⁻¹` of the scales.
pub(super) struct CholeskyFactors {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    /// `R C⁻¹`.
    ratios: Vec<f64>,
    memory: MemBuffer,
}

impl CholeskyFactors {
    /// Computes the factors of an equilibrated matrix, given the ratios of row to column scales. Returns `None` if the
    /// matrix before scaling is not symmetric, or not positive definite.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`].
    pub(super) fn new(matrix: &CsMatI<f64, u32>, ratios: Vec<f64>) -> Result<Option<Self>, LinearError> {
        let n_unknowns = matrix.rows();
        let out_of_memory = || LinearError::OutOfMemory { n_unknowns };
        let mut symmetric = matrix.clone();
        for (mut column, ratio) in symmetric.outer_iterator_mut().zip(&ratios) {
            column.iter_mut().for_each(|(_, value)| *value *= ratio);
        }
        if !is_symmetric(&symmetric) {
            return Ok(None);
        }
        let column_ptr = symmetric.indptr();
        let a = faer_view(column_ptr.raw_storage(), symmetric.indices(), symmetric.data());
        let symbolic =
            factorize_symbolic_cholesky(a.symbolic(), Side::Lower, SymmetricOrdering::Amd, Default::default())
                .map_err(|_| out_of_memory())?;
        let need = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let mut memory = MemBuffer::try_new(need).map_err(|_| out_of_memory())?;
        let mut values = vec![0.0; symbolic.len_val()];
        let outcome = symbolic.factorize_numeric_llt(
            &mut values,
            a,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let is_definite = outcome.is_ok();
        Ok(is_definite.then_some(Self { symbolic, values, ratios, memory }))
    }

    /// Solves with the factors, in place.
    pub(super) fn substitute(&mut self, x: &mut [f64]) {
        let n = x.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        x.iter_mut().zip(&self.ratios).for_each(|(x, ratio)| *x *= ratio);
    }
}

/// Returns whether mirrored entries are equal up to round-off.
fn is_symmetric(matrix: &CsMatI<f64, u32>) -> bool {
    let diagonal: Vec<f64> = (0..matrix.rows()).map(|i| matrix.get(i, i).copied().unwrap_or(0.0)).collect();
    matrix.iter().all(|(value, (i, j))| {
        let mirrored = matrix.get(j as usize, i as usize).copied().unwrap_or(0.0);
        (value - mirrored).powi(2) <= ASYMMETRY.powi(2) * (diagonal[i as usize] * diagonal[j as usize]).abs()
    })
}
