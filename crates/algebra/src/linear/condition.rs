//! How well a matrix is conditioned.

use sprs::CsMatI;

use super::factors::Factors;
use super::{Equilibration, LinearError, MatrixView, Unknowns};

/// Relative change from one iteration to the next at which an eigenvalue counts as found, and most iterations.
const CHANGE: f64 = 1e-4;
const MOST_ITERATIONS: usize = 300;

/// Condition number `‖R A C‖ ‖(R A C)⁻¹‖` of the equilibrated matrix in the Euclidean norm, to a few per cent: from below,
/// by power iterations with `A` and `Aᵀ` and with their inverses.
///
/// A measure for people, not for solvers: it takes two factorisations and hundreds of solves.
///
/// # Errors
/// See [`LinearError`]; a matrix that is singular to working precision has a large number and no error.
pub fn condition_number(matrix: MatrixView<'_>, unknowns: Unknowns<'_>) -> Result<f64, LinearError> {
    let scales = Equilibration::new(matrix)?;
    let mut values = matrix.data().to_vec();
    scales.scale(matrix, &mut values);
    let (pointers, rows) = (matrix.proper_indptr().to_vec(), matrix.indices().to_vec());
    let scaled: CsMatI<f64, u32> = CsMatI::new_csc(matrix.shape(), pointers, rows, values);
    let transposed = scaled.transpose_view().to_csc();
    let (mut factors, mut of_transposed) = (Factors::default(), Factors::default());
    factors.factorize(&scaled, unknowns.nodes)?;
    of_transposed.factorize(&transposed, unknowns.nodes)?;

    let n = matrix.rows();
    let mut between = vec![0.0; n];
    let largest = largest_eigenvalue(n, |x| {
        between.fill(0.0);
        sprs::prod::mul_acc_mat_vec_csc(scaled.view(), &*x, between.as_mut_slice());
        x.fill(0.0);
        sprs::prod::mul_acc_mat_vec_csc(transposed.view(), between.as_slice(), &mut *x);
        Ok(())
    })?;
    let largest_of_inverse = largest_eigenvalue(n, |x| {
        of_transposed.substitute(x)?;
        factors.substitute(x)
    })?;
    Ok((largest * largest_of_inverse).sqrt())
}

/// Largest eigenvalue of a symmetric positive map that works in place, by the power method from a fixed start.
fn largest_eigenvalue(
    n: usize,
    mut apply: impl FnMut(&mut [f64]) -> Result<(), LinearError>,
) -> Result<f64, LinearError> {
    // Any vector with a part of every eigenvector: no symmetry, no zeros.
    let mut x: Vec<f64> = (0..n).map(|k| 1.0 + ((k * k + 3 * k) as f64).sin()).collect();
    normalise(&mut x);
    let mut eigenvalue = 0.0;
    for _ in 0..MOST_ITERATIONS {
        apply(&mut x)?;
        let before = std::mem::replace(&mut eigenvalue, normalise(&mut x));
        if !eigenvalue.is_finite() || (eigenvalue - before).abs() <= CHANGE * eigenvalue {
            break;
        }
    }
    Ok(eigenvalue)
}

/// Scales a vector to length one; returns the length that it had.
fn normalise(x: &mut [f64]) -> f64 {
    let length = x.iter().map(|v| v * v).sum::<f64>().sqrt();
    x.iter_mut().for_each(|v| *v /= length);
    length
}
