//! Row and column scales that bring the largest entry of every row and column near one.

use super::{LinearError, MatrixView};

/// Passes of the iteration; the largest entries are then within a few per cent of one, before rounding.
const N_PASSES: usize = 4;

/// Ruiz equilibration in the maximum norm: `R A C` has rows and columns with largest entries near one.
///
/// The scales are powers of two, so that scaling a matrix or a vector commits no rounding error.
///
/// Source: Ruiz 2001, A scaling algorithm to equilibrate both rows and columns norms in matrices, RAL-TR-2001-034.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equilibration {
    row: Vec<f64>,
    column: Vec<f64>,
    row_max: Vec<f64>,
}

impl Equilibration {
    /// Creates scales of given values.
    pub(super) fn of_scales(row: &[f64], column: &[f64]) -> Self {
        Self { row: row.to_vec(), column: column.to_vec(), row_max: Vec::new() }
    }

    /// Computes the scales of a square matrix, in place.
    ///
    /// # Errors
    /// `EmptyRow`, `EmptyColumn`: a row or column of zeros. `NotFinite`: an entry that is not a finite number.
    pub(crate) fn compute(&mut self, matrix: MatrixView<'_>) -> Result<(), LinearError> {
        let Self { row, column, row_max } = self;
        for scale in [&mut *row, column] {
            scale.clear();
            scale.resize(matrix.rows(), 1.0);
        }
        for pass in 0..N_PASSES {
            row_max.clear();
            row_max.resize(row.len(), 0.0);
            for (j, entries) in matrix.outer_iterator().enumerate() {
                let mut column_max: f64 = 0.0;
                for (i, value) in entries.iter() {
                    let scaled = row[i] * value.abs() * column[j];
                    // A comparison with NaN is false, so test finiteness on the first pass.
                    if pass == 0 && !scaled.is_finite() {
                        return Err(LinearError::NotFinite { row: i });
                    }
                    column_max = column_max.max(scaled);
                    row_max[i] = row_max[i].max(scaled);
                }
                if column_max == 0.0 {
                    return Err(LinearError::EmptyColumn { column: j });
                }
                column[j] /= column_max.sqrt();
            }
            for (i, max) in row_max.iter().enumerate() {
                if *max == 0.0 {
                    return Err(LinearError::EmptyRow { row: i });
                }
                row[i] /= max.sqrt();
            }
        }
        row.iter_mut().chain(column).for_each(|scale| *scale = power_of_two_below(*scale));
        Ok(())
    }

    /// Writes the values of `R A C`, in the order of the entries of `A`.
    pub(crate) fn scale(&self, matrix: MatrixView<'_>, values: &mut [f64]) {
        let mut values = values.iter_mut();
        for (column, c) in matrix.outer_iterator().zip(&self.column) {
            for ((i, value), scaled) in column.iter().zip(&mut values) {
                *scaled = self.row[i] * value * c;
            }
        }
    }

    /// Returns the row scales R.
    pub fn row(&self) -> &[f64] {
        &self.row
    }

    /// Returns the column scales C: the unknowns of the scaled system are `C⁻¹ x`.
    pub fn column(&self) -> &[f64] {
        &self.column
    }
}

/// Returns the largest power of two that is not above a positive normal number.
fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(x.to_bits() & EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_powers_of_two_and_flatten_the_matrix() {
        // [ 1e9  2e4 ]
        // [ 3e4  1e-3 ]
        let (ptr, rows, values) = ([0, 2, 4], [0, 1, 0, 1], [1e9, 3e4, 2e4, 1e-3]);
        let matrix = MatrixView::new_csc((2, 2), &ptr, &rows, &values);
        let mut scales = Equilibration::default();
        scales.compute(matrix).unwrap();
        for s in scales.row().iter().chain(scales.column()) {
            assert_eq!(s.log2().fract(), 0.0);
        }
        for (value, (i, j)) in matrix.iter() {
            assert!(value * scales.row()[i as usize] * scales.column()[j as usize] < 2.0);
        }
        for i in 0..2 {
            let largest = (0..2)
                .map(|j| matrix.get(i, j).copied().unwrap_or(0.0) * scales.row()[i] * scales.column()[j])
                .fold(0.0, f64::max);
            assert!(largest > 0.1, "{largest}");
        }
    }

    #[test]
    fn powers_of_two() {
        assert_eq!(power_of_two_below(1.0), 1.0);
        assert_eq!(power_of_two_below(1.99), 1.0);
        assert_eq!(power_of_two_below(0.3), 0.25);
        assert_eq!(power_of_two_below(1e9), 536_870_912.0);
    }
}
