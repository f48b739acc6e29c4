//! Size fields: how large cells should be, and how an interval is divided accordingly.

use crate::{Error, Point};

/// Largest slope of a size field; steeper ones cannot be followed by well-shaped triangles.
const STEEPEST: f64 = 0.5;

/// Mean length of the edges of triangles over their size.
///
/// The size is the mean diameter of the cells (to 3 %), as `h` is the diameter of a cell in the analysis of finite elements; the
/// longest edges of the triangles of our meshes are longer than the mean edge by 1.08 to 1.09.
pub(super) const MEAN_EDGE: f64 = 0.92;

/// The size of cells as a function of position: the mean diameter of triangles, the sides of bricks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// The same size everywhere.
    Uniform {
        /// The size.
        h: f64,
    },
    /// Fine at low, coarse at high values of one coordinate, and linear in between with a slope of at most one half.
    ///
    /// Triangles follow slopes up to 0.1 closely; steeper ones keep their angles, but edges near the kink at `fine_until`
    /// may be up to twice as long as wanted.
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
    /// The same size everywhere.
    pub fn uniform(h: f64) -> Self {
        Self::Uniform { h }
    }

    /// Size at a point.
    ///
    /// # Panics
    /// If the size is graded along an axis that the space does not have.
    pub fn at<const D: usize>(&self, x: &Point<D>) -> f64 {
        self.along(|axis| x[axis])
    }

    /// Size where the coordinates are the given ones.
    pub(super) fn along(&self, coordinate: impl Fn(usize) -> f64) -> f64 {
        match *self {
            Self::Uniform { h } => h,
            Self::Graded { fine, fine_until, coarse, coarse_from, axis } => {
                let t = (coordinate(axis) - fine_until) / (coarse_from - fine_until);
                fine + (coarse - fine) * t.clamp(0.0, 1.0)
            }
        }
    }

    /// The smallest size anywhere.
    pub(super) fn finest(&self) -> f64 {
        match *self {
            Self::Uniform { h } => h,
            Self::Graded { fine, .. } => fine,
        }
    }

    /// Checks that the field makes sense in a space of the given dimension.
    pub(super) fn check(&self, dimension: usize) -> Result<(), Error> {
        match *self {
            Self::Uniform { h } => positive("size", h),
            Self::Graded { fine, fine_until, coarse, coarse_from, axis } => {
                positive("fine size", fine)?;
                positive("coarse size", coarse)?;
                if !fine_until.is_finite() {
                    return Err(Error::Generate { what: "fine_until", value: fine_until, must: "be finite" });
                }
                if coarse < fine {
                    return Err(Error::Generate {
                        what: "coarse size",
                        value: coarse,
                        must: "not be below the fine one",
                    });
                }
                let length = coarse_from - fine_until;
                let shortest = (coarse - fine) / STEEPEST;
                if !length.is_finite() || length <= 0.0 || length < shortest * (1.0 - 1e-9) {
                    let must = "exceed fine_until by at least twice the difference of the sizes";
                    return Err(Error::Generate { what: "coarse_from", value: coarse_from, must });
                }
                if axis >= dimension {
                    let must = "be below the dimension";
                    return Err(Error::Generate { what: "axis", value: axis as f64, must });
                }
                Ok(())
            }
        }
    }
}

/// Checks that a parameter is positive and finite.
pub(super) fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::Generate { what, value, must: "be positive and finite" })
}

/// Meshes with more cells are refused; they are mistakes rather than wishes.
const MOST_CELLS: f64 = 5e7;

/// Checks that a mesh of about so many cells is not absurdly large.
pub(super) fn affordable(n_cells: f64) -> Result<(), Error> {
    if n_cells <= MOST_CELLS {
        return Ok(());
    }
    Err(Error::Generate { what: "number of cells", value: n_cells, must: "be at most 5e7; increase the size" })
}

/// Divides `[min, max]` into intervals of length about `h(x)`; the end points are kept bitwise.
///
/// The nodes are equally spaced in the integral of `1/h`.
pub(super) fn divided(min: f64, max: f64, h: impl Fn(f64) -> f64) -> Result<Vec<f64>, Error> {
    const SAMPLES: usize = 4096;
    let step = (max - min) / SAMPLES as f64;
    let mut count = vec![0.0; SAMPLES + 1];
    for k in 0..SAMPLES {
        count[k + 1] = count[k] + step / h(min + (k as f64 + 0.5) * step);
    }
    affordable(count[SAMPLES])?;
    let n = count[SAMPLES].round().max(1.0) as usize;
    let mut nodes = vec![min];
    let mut k = 0;
    for i in 1..n {
        let wanted = count[SAMPLES] * i as f64 / n as f64;
        while count[k + 1] < wanted {
            k += 1;
        }
        nodes.push(min + step * (k as f64 + (wanted - count[k]) / (count[k + 1] - count[k])));
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
