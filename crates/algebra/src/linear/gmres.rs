//! Restarted flexible GMRES.

use sprs::CsMatI;

use super::{LinearError, LinearReport};

/// Stopping criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GmresSettings {
    /// Largest accepted residual, relative to the right-hand side (Euclidean norms).
    pub tolerance: f64,
    /// Basis vectors that are kept before the iteration starts again.
    pub restart: usize,
    /// Largest number of iterations.
    pub max_iterations: usize,
}

/// A linear map: writes the image of its first argument into the second.
pub type LinearMap<'a> = dyn FnMut(&[f64], &mut [f64]) -> Result<(), LinearError> + 'a;

/// Flexible GMRES with right preconditioning: the preconditioner may change from iteration to iteration.
///
/// The basis is orthogonalised by modified Gram-Schmidt, twice, so that it stays orthogonal to working precision.
/// Convergence is tested with the residual of the solution, not of the recurrence. The memory of the basis is kept.
///
/// Source: Saad 1993, A flexible inner-outer preconditioned GMRES algorithm, doi:10.1137/0914028; Giraud, Langou and
/// Rozložník 2005, doi:10.1016/j.camwa.2005.08.009, for the second orthogonalisation.
#[derive(Clone, Debug, Default)]
pub struct Gmres {
    /// Orthonormal basis of the residuals.
    basis: Vec<Vec<f64>>,
    /// The preconditioned basis, of which corrections are made.
    directions: Vec<Vec<f64>>,
    /// Upper triangle of the rotated Hessenberg matrix, one column per direction.
    columns: Vec<Vec<f64>>,
    rotations: Vec<[f64; 2]>,
    /// The rotated right-hand side of the least-squares problem.
    target: Vec<f64>,
}

impl Gmres {
    /// Solves with a matrix compressed by columns, from zero.
    ///
    /// # Errors
    /// [`LinearError::NotConverged`], with the last iterate in `x`; errors of the preconditioner.
    pub fn solve(
        &mut self,
        matrix: &CsMatI<f64, u32>,
        precondition: &mut LinearMap<'_>,
        rhs: &[f64],
        x: &mut Vec<f64>,
        settings: &GmresSettings,
    ) -> Result<LinearReport, LinearError> {
        x.clear();
        x.resize(rhs.len(), 0.0);
        let size = norm(rhs);
        let mut report = LinearReport::default();
        if size == 0.0 {
            return Ok(report);
        }
        if !size.is_finite() {
            return Err(LinearError::NotConverged { iterations: 0, residual: f64::INFINITY });
        }
        let bound = settings.tolerance * size;
        let mut residual = vec![0.0; rhs.len()];
        loop {
            multiply(matrix, x, &mut residual);
            residual.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
            let left = norm(&residual);
            report.backward_error = left / size;
            if left <= bound {
                return Ok(report);
            }
            if report.iterations >= settings.max_iterations || !left.is_finite() {
                let LinearReport { iterations, backward_error: residual } = report;
                return Err(LinearError::NotConverged { iterations, residual });
            }
            let most = settings.restart.min(settings.max_iterations - report.iterations);
            let n = self.cycle(matrix, precondition, &residual, left, bound, most)?;
            // A direction in the kernel of the matrix counts as an iteration, although it does not reduce the residual.
            report.iterations += n.max(1);
            self.correct(x, n);
        }
    }

    /// Builds a basis of at most `most` vectors from a residual of norm `size`, until the residual of the least-squares
    /// problem is below the bound; returns the number of directions.
    fn cycle(
        &mut self,
        matrix: &CsMatI<f64, u32>,
        precondition: &mut LinearMap<'_>,
        residual: &[f64],
        size: f64,
        bound: f64,
        most: usize,
    ) -> Result<usize, LinearError> {
        set(&mut self.basis, 0, residual.iter().map(|r| r / size));
        self.rotations.clear();
        self.target.clear();
        self.target.push(size);
        for k in 0..most {
            set(&mut self.directions, k, std::iter::repeat_n(0.0, residual.len()));
            precondition(&self.basis[k], &mut self.directions[k])?;
            set(&mut self.basis, k + 1, std::iter::repeat_n(0.0, residual.len()));
            let (known, next) = self.basis.split_at_mut(k + 1);
            let next = &mut next[0];
            multiply(matrix, &self.directions[k], next);
            let before = norm(next);
            let mut column = vec![0.0; k + 1];
            for _ in 0..2 {
                for (v, h) in known.iter().zip(&mut column) {
                    let share = dot(v, next);
                    *h += share;
                    next.iter_mut().zip(v).for_each(|(w, v)| *w -= share * v);
                }
            }
            let mut below = norm(next);
            // For a vector in the span of the basis the remainder is round-off and must not become a direction.
            let is_exhausted = below <= f64::EPSILON * before;
            if is_exhausted {
                below = 0.0;
            } else {
                next.iter_mut().for_each(|w| *w /= below);
            }
            for (i, [c, s]) in self.rotations.iter().enumerate() {
                (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
            }
            let length = column[k].hypot(below);
            if length == 0.0 {
                // The direction is in the kernel of the matrix.
                return Ok(k);
            }
            let (c, s) = (column[k] / length, below / length);
            column[k] = length;
            self.rotations.push([c, s]);
            let last = self.target[k];
            self.target[k] = c * last;
            self.target.push(-s * last);
            set(&mut self.columns, k, column.into_iter());
            if (s * last).abs() <= bound || is_exhausted {
                return Ok(k + 1);
            }
        }
        Ok(most)
    }

    /// Adds the combination of the first `n` directions with the least residual.
    fn correct(&self, x: &mut [f64], n: usize) {
        let mut weights = self.target[..n].to_vec();
        for k in (0..n).rev() {
            weights[k] /= self.columns[k][k];
            for i in 0..k {
                weights[i] -= self.columns[k][i] * weights[k];
            }
        }
        for (direction, weight) in self.directions.iter().zip(&weights) {
            x.iter_mut().zip(direction).for_each(|(x, d)| *x += weight * d);
        }
    }
}

/// Writes the product of a matrix and a vector.
fn multiply(matrix: &CsMatI<f64, u32>, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    sprs::prod::mul_acc_mat_vec_csc(matrix.view(), x, y);
}

/// Puts values into entry `k` of a list of vectors, in its memory if there is one.
fn set(list: &mut Vec<Vec<f64>>, k: usize, values: impl Iterator<Item = f64>) {
    if list.len() <= k {
        list.push(Vec::new());
    }
    list[k].clear();
    list[k].extend(values);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the Euclidean norm, also where the squares overflow or underflow.
pub(super) fn norm(a: &[f64]) -> f64 {
    let plain = dot(a, a).sqrt();
    if (1e-140..1e140).contains(&plain) {
        return plain;
    }
    let largest = a.iter().fold(0.0, |largest: f64, v| if v.is_nan() { *v } else { largest.max(v.abs()) });
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * a.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt()
}
