//! Equilibrated linear systems.

use sprs::CsMatI;

use super::{Equilibration, LinearError, MatrixView};
use crate::BlockLayout;

/// An equilibrated copy `R A C` of a matrix `A`, with its scales.
#[derive(Default)]
pub struct ScaledMatrix {
    scales: Equilibration,
    /// `None` before the first matrix, and after one that has no scales.
    matrix: Option<CsMatI<f64, u32>>,
}

impl ScaledMatrix {
    /// Equilibrates a matrix.
    ///
    /// # Errors
    /// A row or column of zeros, or an entry that is not finite.
    ///
    /// # Panics
    /// The matrix is not square or not compressed by columns.
    pub fn new(matrix: MatrixView<'_>) -> Result<Self, LinearError> {
        let mut scaled = Self::default();
        scaled.set(matrix)?;
        Ok(scaled)
    }

    /// Sets the matrix as [`ScaledMatrix::new`] does, in recycled memory.
    ///
    /// # Errors
    /// As [`ScaledMatrix::new`]; there is no matrix then.
    pub fn set(&mut self, matrix: MatrixView<'_>) -> Result<(), LinearError> {
        assert!(matrix.is_csc() && matrix.rows() == matrix.cols(), "a square matrix compressed by columns");
        let old = self.matrix.take();
        self.scales.compute(matrix)?;
        let has_pattern =
            |m: &CsMatI<f64, u32>| m.proper_indptr() == matrix.proper_indptr() && m.indices() == matrix.indices();
        let mut scaled = old.filter(has_pattern).unwrap_or_else(|| matrix.to_owned());
        self.scales.scale(matrix, scaled.data_mut());
        self.matrix = Some(scaled);
        Ok(())
    }

    /// Returns the row and column scales.
    pub fn scales(&self) -> &Equilibration {
        &self.scales
    }

    /// Returns the system of this matrix.
    ///
    /// # Errors
    /// [`LinearError::NotFactorized`]: there is no matrix.
    ///
    /// # Panics
    /// The layout does not have the size of the matrix.
    pub fn system<'m>(&'m self, layout: &'m BlockLayout) -> Result<LinearSystem<'m>, LinearError> {
        let matrix = self.matrix.as_ref().ok_or(LinearError::NotFactorized)?;
        assert_eq!(matrix.rows(), layout.len(), "unknowns of the layout");
        Ok(LinearSystem { matrix, scales: &self.scales, layout })
    }
}

/// A linear system: an equilibrated matrix, its scales, and the fields of its unknowns.
///
/// `matrix` is `R A C`. Right-hand sides and solutions of a solver are those of `A`.
#[derive(Clone, Copy)]
pub struct LinearSystem<'m> {
    /// The equilibrated matrix `R A C`, compressed by columns with sorted rows.
    pub matrix: &'m CsMatI<f64, u32>,
    /// Row scales `R` and column scales `C`.
    pub scales: &'m Equilibration,
    /// Fields, nodes and keys of the unknowns.
    pub layout: &'m BlockLayout,
}

impl LinearSystem<'_> {
    /// Returns the number of unknowns.
    pub fn len(&self) -> usize {
        self.matrix.rows()
    }

    /// Returns whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the scaled right-hand side `R b`.
    ///
    /// # Errors
    /// [`LinearError::NotFinite`]: an entry of `b` is not finite.
    ///
    /// # Panics
    /// `rhs` or `x`, the place of the solution, has the wrong length.
    pub(super) fn scale_rhs(&self, rhs: &[f64], x: &[f64], scaled: &mut Vec<f64>) -> Result<(), LinearError> {
        let n = self.len();
        assert!(rhs.len() == n && x.len() == n, "length of right-hand side and solution");
        if let Some(row) = rhs.iter().position(|b| !b.is_finite()) {
            return Err(LinearError::NotFinite { row });
        }
        scaled.clear();
        scaled.extend(rhs.iter().zip(self.scales.row()).map(|(b, r)| b * r));
        Ok(())
    }

    /// Writes the solution `x = C y` of the unscaled system.
    pub(super) fn unscale(&self, solution: &[f64], x: &mut [f64]) {
        for ((x, y), c) in x.iter_mut().zip(solution).zip(self.scales.column()) {
            *x = y * c;
        }
    }
}
