//! Accuracy of the linear solves inside Newton's method.

/// Relative residual to which an iterative method solves for a correction (in the norms of
/// [`crate::LinearSolver::solve`]). Direct methods do not use it.
///
/// It is 0.9 times the ratio by which the last correction reduced the nonlinear residual, to the power of the golden
/// ratio. A linear system is then solved about as accurately as it approximates the nonlinear one.
///
/// Source: Eisenstat and Walker 1996, Choosing the forcing terms in an inexact Newton method, doi:10.1137/0917003,
/// choice 2 with its safeguard; Kelley 1995, Iterative methods for linear and nonlinear equations,
/// doi:10.1137/1.9781611970944, Eq. (6.20), for the last correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forcing {
    /// Value for the first correction.
    pub first: f64,
    /// Largest value, for all corrections.
    pub largest: f64,
}

impl Forcing {
    /// Factor of choice 2.
    const GAMMA: f64 = 0.9;
    /// Exponent of choice 2.
    const EXPONENT: f64 = 1.618_033_988_749_895;
    /// The safeguard bounds the next value from below if that bound exceeds this value.
    const SAFEGUARD: f64 = 0.1;

    /// Returns the forcing of the next correction. `last` holds the forcing of the previous correction and the ratio by
    /// which that correction reduced the residual. A reduction of the residual to the fraction `enough` suffices.
    pub(crate) fn next(self, last: Option<(f64, f64)>, enough: f64) -> f64 {
        let forcing = last.map_or(self.first, |(forcing, reduction)| {
            let target = Self::GAMMA * reduction.powf(Self::EXPONENT);
            let floor = Self::GAMMA * forcing.powf(Self::EXPONENT);
            if floor > Self::SAFEGUARD { target.max(floor) } else { target }
        });
        forcing.max(0.5 * enough).min(self.largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forcing_falls_with_the_residual_but_not_too_fast_nor_too_far() {
        let forcing = Forcing { first: 0.5, largest: 0.9 };
        assert_eq!(forcing.next(None, 0.0), 0.5);
        // The safeguard: after a solve with a large tolerance the next tolerance is bounded from below.
        assert!((forcing.next(Some((0.5, 1e-3)), 0.0) - 0.9 * 0.5_f64.powf(Forcing::EXPONENT)).abs() < 1e-15);
        // After an accurate solve the safeguard is inactive.
        assert!((forcing.next(Some((0.2, 0.01)), 0.0) - 0.9 * 0.01_f64.powf(Forcing::EXPONENT)).abs() < 1e-15);
        assert_eq!(forcing.next(Some((0.2, 1e-9)), 0.3), 0.15);
        assert_eq!(forcing.next(Some((0.2, 1.5)), 0.0), 0.9);
    }
}
