//! Condition number of a matrix.

use super::factors::Factors;
use super::{LinearError, LinearSystem, MatrixView, ScaledMatrix};
use crate::BlockLayout;

/// Relative change of an eigenvalue from one iteration to the next at which the iteration ends.
const CHANGE: f64 = 1e-4;
/// Largest number of iterations.
const MOST_ITERATIONS: usize = 300;

/// The scales in which a matrix `A` is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// The matrix without scaling.
    None,
    /// `R A C` of [`super::Equilibration`], the matrix that the solvers factorise.
    Equilibrated,
}

/// Returns the condition number `‖A‖ ‖A⁻¹‖` in the Euclidean norm, of a matrix or of the equilibrated one, to a few per
/// cent. It is approached from below, by power iterations with `A` and `Aᵀ` and with their inverses. The factors are
/// those of the equilibrated matrix in both cases.
///
/// Diagnostic: two factorisations and hundreds of solves.
///
/// # Errors
/// See [`LinearError`]; a matrix that is singular to working precision has a large number and no error.
pub fn condition_number(matrix: MatrixView<'_>, layout: &BlockLayout, scaling: Scaling) -> Result<f64, LinearError> {
    let scaled = ScaledMatrix::new(matrix)?;
    let LinearSystem { matrix: scaled, scales, .. } = scaled.system(layout)?;
    let nodes = layout.nodes();
    let (mut factors, mut of_transposed) = (Factors::default(), Factors::default());
    factors.factorize(scaled, &nodes)?;
    of_transposed.factorize(&scaled.transpose_view().to_csc(), &nodes)?;

    let is_scaled = scaling == Scaling::Equilibrated;
    let measured = if is_scaled { scaled.view() } else { matrix };
    let transposed = measured.transpose_view().to_csc();
    // A⁻¹ = C (R A C)⁻¹ R; the inverse of R A C itself needs no scales.
    let scale = |x: &mut [f64], scales: &[f64]| {
        if !is_scaled {
            x.iter_mut().zip(scales).for_each(|(x, s)| *x *= s);
        }
    };
    let n = matrix.rows();
    let mut between = vec![0.0; n];
    let largest = largest_eigenvalue(n, |x| {
        between.fill(0.0);
        sprs::prod::mul_acc_mat_vec_csc(measured, &*x, between.as_mut_slice());
        x.fill(0.0);
        sprs::prod::mul_acc_mat_vec_csc(transposed.view(), between.as_slice(), &mut *x);
        Ok(())
    })?;
    let largest_of_inverse = largest_eigenvalue(n, |x| {
        scale(x, scales.column());
        of_transposed.substitute(x)?;
        scale(x, scales.row());
        scale(x, scales.row());
        factors.substitute(x)?;
        scale(x, scales.column());
        Ok(())
    })?;
    Ok((largest * largest_of_inverse).sqrt())
}

/// Returns the largest eigenvalue of a symmetric positive map that works in place, by the power method from a fixed
/// start.
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
