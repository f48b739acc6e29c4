//! A matrix in its scales.

use sprs::CsMatI;

use super::{Equilibration, LinearError, MatrixView};

/// An equilibrated copy of a matrix: `R A C`.
#[derive(Default)]
pub(super) struct Scaled {
    pub(super) scales: Equilibration,
    /// None before the first matrix, and after one that could not be scaled.
    pub(super) matrix: Option<CsMatI<f64, u32>>,
}

impl Scaled {
    /// Takes a matrix.
    ///
    /// # Errors
    /// See [`Equilibration::new`].
    ///
    /// # Panics
    /// It is not square or not compressed by columns.
    pub(super) fn set(&mut self, matrix: MatrixView<'_>) -> Result<&CsMatI<f64, u32>, LinearError> {
        assert!(matrix.is_csc() && matrix.rows() == matrix.cols(), "a square matrix compressed by columns");
        self.matrix = None;
        self.scales.compute(matrix)?;
        let (rows, mut values) = (matrix.indices().to_vec(), matrix.data().to_vec());
        self.scales.scale(matrix, &mut values);
        let scaled = CsMatI::new_csc(matrix.shape(), matrix.proper_indptr().to_vec(), rows, values);
        Ok(self.matrix.insert(scaled))
    }

    /// `R b`.
    pub(super) fn scale_rhs(&self, rhs: &[f64], scaled: &mut Vec<f64>) {
        scaled.clear();
        scaled.extend(rhs.iter().zip(self.scales.row()).map(|(b, r)| b * r));
    }

    /// `x = C y`.
    pub(super) fn unscale(&self, solution: &[f64], x: &mut [f64]) {
        for ((x, y), c) in x.iter_mut().zip(solution).zip(self.scales.column()) {
            *x = y * c;
        }
    }
}
