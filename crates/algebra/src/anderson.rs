//! Acceleration of fixed-point iterations.

use std::collections::VecDeque;

/// Vectors shorter than this, relative to their length before it was projected, are dependent on others.
const DEPENDENT: f64 = 1e-8;
/// Factor of the length of the change at which the history is discarded.
const LARGEST_GROWTH: f64 = 2.0;

/// Anderson's acceleration of the iteration `x ← g(x)`.
///
/// The next iterate is the combination of the images of the last iterates, with coefficients whose sum is one, in which
/// the combination of the changes `g(x) - x` is smallest. A linear iteration with `n` different factors of contraction,
/// at most as many as the depth, ends after `n + 1` iterations, however close to one they are. Where the changes grow,
/// the history is discarded.
///
/// Source: Walker and Ni 2011, Anderson acceleration for fixed-point iterations, doi:10.1137/10078356X.
#[derive(Clone, Debug)]
pub struct Anderson {
    /// Largest number of differences.
    depth: usize,
    /// Whether an iterate was combined from several images.
    is_accelerated: bool,
    /// Iterate whose image is given next; empty at the start.
    iterate: Vec<f64>,
    /// Change and image of the iterate before, if there is one.
    before: Option<[Vec<f64>; 2]>,
    /// Differences of changes and images from iterate to iterate, the last one first.
    differences: VecDeque<[Vec<f64>; 2]>,
}

impl Anderson {
    /// Creates the acceleration with the largest number of differences.
    pub fn new(depth: usize) -> Self {
        Self { depth, is_accelerated: false, iterate: Vec::new(), before: None, differences: VecDeque::new() }
    }

    /// Returns whether an iterate was combined from several images.
    pub fn is_accelerated(&self) -> bool {
        self.is_accelerated
    }

    /// Discards the history: the map is another one from now on.
    pub fn forget(&mut self) {
        self.before = None;
        self.differences.clear();
    }

    /// Returns the next iterate, given the image of the one before. The first iterate is the first image.
    pub fn next(&mut self, image: Vec<f64>) -> &[f64] {
        if self.iterate.is_empty() {
            self.iterate = image;
            return &self.iterate;
        }
        let change = minus(&image, &self.iterate);
        if let Some([change_before, image_before]) = &self.before {
            if norm(&change) > LARGEST_GROWTH * norm(change_before) {
                self.differences.clear();
            } else {
                self.differences.push_front([minus(&change, change_before), minus(&image, image_before)]);
                self.differences.truncate(self.depth);
            }
        }
        // The same combinations of differences of changes, made orthonormal, and of images.
        let mut basis: Vec<[Vec<f64>; 2]> = Vec::with_capacity(self.differences.len());
        for difference in &self.differences {
            let mut pair = difference.clone();
            let length = norm(&pair[0]);
            basis.iter().for_each(|of| project(&mut pair, of));
            let rest = norm(&pair[0]);
            if rest > DEPENDENT * length {
                pair.iter_mut().flatten().for_each(|entry| *entry /= rest);
                basis.push(pair);
            }
        }
        self.is_accelerated |= !basis.is_empty();
        let mut pair = [change.clone(), image.clone()];
        basis.iter().for_each(|of| project(&mut pair, of));
        let [_, next] = pair;
        self.before = Some([change, image]);
        self.iterate = next;
        &self.iterate
    }
}

/// Subtracts from a pair the multiple of another one, of unit length, that makes the first vectors orthogonal.
fn project(pair: &mut [Vec<f64>; 2], of: &[Vec<f64>; 2]) {
    let along: f64 = pair[0].iter().zip(&of[0]).map(|(a, b)| a * b).sum();
    for (vector, of) in pair.iter_mut().zip(of) {
        vector.iter_mut().zip(of).for_each(|(entry, of)| *entry -= along * of);
    }
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_iteration_ends_after_as_many_iterations_as_it_has_factors() {
        let factors = [0.999, 0.97, 0.5, -0.3, 0.97];
        let g = |x: &[f64]| -> Vec<f64> { x.iter().zip(factors).map(|(x, factor)| 1.0 + factor * (x - 1.0)).collect() };
        let mut x = vec![0.0, 3.0, 2.0, -1.0, 7.0];
        let mut anderson = Anderson::new(5);
        for _ in 0..7 {
            x = anderson.next(g(&x)).to_vec();
        }
        assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-6), "{x:?}");
        assert_eq!(anderson.next(x.clone()), x, "nothing changes at the fixed point");
        assert!(anderson.is_accelerated());
        let mut plain = Anderson::new(0);
        let x = (0..4).fold(vec![0.0; 5], |x, _| plain.next(g(&x)).to_vec());
        assert!((x[2] - 0.9375).abs() < 1e-15 && !plain.is_accelerated(), "{x:?}");
    }

    #[test]
    fn growing_changes_start_the_iteration_again() {
        let mut anderson = Anderson::new(5);
        assert_eq!(anderson.next(vec![0.0]), [0.0]);
        assert_eq!(anderson.next(vec![1.0]), [1.0]);
        // The change grows from 1 to 4: the image is the next iterate.
        assert_eq!(anderson.next(vec![5.0]), [5.0]);
        // A secant step with the changes 4 and 1.
        assert!((anderson.next(vec![6.0])[0] - (6.0 + 1.0 / 3.0)).abs() < 1e-15);
    }
}
