//! Size fields: the size of cells as a function of position, and the division of intervals.

use crate::{ParameterError, Point, positive, require};

/// Largest slope of a size field that well-shaped triangles can follow.
pub(super) const STEEPEST: f64 = 0.5;

/// Ratio of the mean length of edges to the size.
///
/// The size is the mean diameter of the cells (to 3 %), since `h` is the diameter in the analysis of finite elements.
/// In generated meshes, the longest edge of a triangle is 1.08 to 1.09 times the mean edge.
pub(super) const MEAN_EDGE: f64 = 0.92;

/// The size of cells as a function of position: the mean diameter of triangles, the sides of bricks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// The same size everywhere.
    Uniform {
        /// The size.
        h: f64,
    },
    /// Fine at low and coarse at high values of one coordinate, linear in between with a slope of at most one half.
    ///
    /// Triangles follow slopes up to 0.1 closely. At larger slopes, angles stay good, but edges near `fine_until` may
    /// be up to twice as long as specified.
    Graded {
        /// Size up to `fine_until`.
        fine: f64,
        /// Coordinate up to which cells are fine.
        fine_until: f64,
        /// Size from `coarse_from` on.
        coarse: f64,
        /// Coordinate from which on cells are coarse.
        coarse_from: f64,
        /// Index of the coordinate.
        axis: usize,
    },
}

impl Size {
    /// Returns the uniform size `h`.
    pub fn uniform(h: f64) -> Self {
        Self::Uniform { h }
    }

    /// Returns the size at a point.
    ///
    /// # Panics
    /// If the size is graded along an axis that the space does not have.
    pub fn at<const D: usize>(&self, x: &Point<D>) -> f64 {
        self.along(|axis| x[axis])
    }

    /// Returns the size at the point with the given coordinates.
    pub(super) fn along(&self, coordinate: impl Fn(usize) -> f64) -> f64 {
        match *self {
            Self::Uniform { h } => h,
            Self::Graded { fine, fine_until, coarse, coarse_from, axis } => {
                let t = (coordinate(axis) - fine_until) / (coarse_from - fine_until);
                fine + (coarse - fine) * t.clamp(0.0, 1.0)
            }
        }
    }

    /// Returns the smallest size.
    pub(super) fn finest(&self) -> f64 {
        match *self {
            Self::Uniform { h } => h,
            Self::Graded { fine, .. } => fine,
        }
    }

    /// Returns the largest size.
    pub(super) fn coarsest(&self) -> f64 {
        match *self {
            Self::Uniform { h } => h,
            Self::Graded { coarse, .. } => coarse,
        }
    }

    /// Checks the parameters of the field for a space of the given dimension.
    pub(super) fn check(&self, dimension: usize) -> Result<(), ParameterError> {
        match *self {
            Self::Uniform { h } => positive("size", h).map(|_| ()),
            Self::Graded { fine, fine_until, coarse, coarse_from, axis } => {
                positive("fine size", fine)?;
                positive("coarse size", coarse)?;
                require(fine_until.is_finite(), "fine_until", fine_until, "finite")?;
                require(coarse >= fine, "coarse size", coarse, "at least the fine size")?;
                let length = coarse_from - fine_until;
                let shortest = (coarse - fine) / STEEPEST;
                let is_long_enough = length.is_finite() && length > 0.0 && length >= shortest * (1.0 - 1e-9);
                let must = "larger than fine_until by at least twice the difference of the sizes";
                require(is_long_enough, "coarse_from", coarse_from, must)?;
                require(axis < dimension, "axis", axis as f64, "below the dimension").map(|_| ())
            }
        }
    }
}

/// Largest number of cells that a generator accepts.
const MOST_CELLS: f64 = 5e7;

/// Checks that a mesh of about `n_cells` cells is not too large.
pub(super) fn affordable(n_cells: f64) -> Result<f64, ParameterError> {
    require(n_cells <= MOST_CELLS, "number of cells", n_cells, "at most 5e7 (increase the size)")
}

/// Divides `[min, max]` into intervals of length about `h(x)`, equally spaced in the integral of `1/h`. The end points
/// are exact.
///
/// The slope of `h` must be at most [`STEEPEST`]: then no minimum lies between two samples.
pub(super) fn divided(min: f64, max: f64, h: impl Fn(f64) -> f64) -> Result<Vec<f64>, ParameterError> {
    const SAMPLES: usize = 4096;
    /// Least size relative to the length of its sample.
    const LEAST: f64 = 2.0;
    let step = (max - min) / SAMPLES as f64;
    affordable((0..SAMPLES).map(|k| step / h(min + (k as f64 + 0.5) * step)).sum())?;
    // Samples in units of the step: begin, length, and the integral up to the end. Where the size is small, they are
    // halved.
    let mut samples: Vec<(f64, f64, f64)> = Vec::with_capacity(SAMPLES);
    let mut total = 0.0;
    let mut pending: Vec<(f64, f64)> = (0..SAMPLES).rev().map(|k| (k as f64, 1.0)).collect();
    while let Some((begin, length)) = pending.pop() {
        let size = h(min + (begin + 0.5 * length) * step);
        let half = 0.5 * length;
        if size < LEAST * length * step {
            pending.extend([(begin + half, half), (begin, half)]);
        } else {
            total += length * step / size;
            samples.push((begin, length, total));
        }
    }
    affordable(total)?;
    let n = total.round().max(1.0) as usize;
    let mut nodes = vec![min];
    let (mut k, mut before) = (0, 0.0);
    for i in 1..n {
        let target = total * i as f64 / n as f64;
        while samples[k].2 < target {
            before = samples[k].2;
            k += 1;
        }
        let (begin, length, until) = samples[k];
        nodes.push(min + step * (begin + length * ((target - before) / (until - before))));
    }
    nodes.push(max);
    Ok(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADED: Size = Size::Graded { fine: 0.1, fine_until: 4.5, coarse: 0.5, coarse_from: 10.0, axis: 1 };

    #[test]
    fn graded_size_is_linear_between_its_ends() {
        let at = |y: f64| GRADED.at(&Point::<2>::new(3.0, y));
        assert_eq!((at(0.0), at(4.5), at(10.0), at(15.0)), (0.1, 0.1, 0.5, 0.5));
        assert!((at(7.25) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn interval_lengths_follow_the_size() {
        let nodes = divided(0.0, 15.0, |y| GRADED.along(|_| y)).unwrap();
        assert_eq!((nodes[0], nodes[nodes.len() - 1]), (0.0, 15.0));
        for pair in nodes.windows(2) {
            let ratio = (pair[1] - pair[0]) / GRADED.along(|_| 0.5 * (pair[0] + pair[1]));
            assert!((0.95..1.05).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn no_minimum_of_the_size_is_missed() {
        let h = |x: f64| 1e-7 + 0.3 * (x - 0.4321).abs();
        let nodes = divided(0.0, 1.0, h).unwrap();
        for pair in nodes.windows(2) {
            let ratio = (pair[1] - pair[0]) / h(0.5 * (pair[0] + pair[1]));
            assert!((0.8..1.3).contains(&ratio), "{ratio} at {}", pair[0]);
        }
    }

    #[test]
    fn senseless_sizes_are_errors() {
        for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Size::uniform(h).check(2).is_err());
        }
        assert!(GRADED.check(2).is_ok());
        assert!(GRADED.check(1).is_err());
        let graded = |coarse, coarse_from| Size::Graded { fine: 0.1, fine_until: 1.0, coarse, coarse_from, axis: 0 };
        assert!(graded(0.5, 1.8).check(2).is_ok());
        for (coarse, coarse_from) in [(0.5, 1.7), (0.5, 1.0), (0.1, 1.0), (0.5, f64::NAN), (0.05, 3.0), (f64::NAN, 3.0)]
        {
            assert!(graded(coarse, coarse_from).check(2).is_err());
        }
        assert!(divided(0.0, 1.0, |_| 1e-9).is_err());
    }
}
