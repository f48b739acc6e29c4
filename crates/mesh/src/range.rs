//! Ranges of parameters.

/// A parameter outside of its range.
///
/// The error types of `mesh`, `contact`, `solid-rigid`, `solid-svk` and `solver` contain it, so that range errors have
/// the same wording.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{what} is {value:?}, but must be {must}")]
pub struct ParameterError {
    /// The parameter.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
    /// The range, as the end of the phrase "must be ...".
    pub must: &'static str,
}

/// Returns `value` if the condition holds.
///
/// # Errors
/// [`ParameterError`] with `what` and `must` otherwise.
pub fn require(holds: bool, what: &'static str, value: f64, must: &'static str) -> Result<f64, ParameterError> {
    if holds { Ok(value) } else { Err(ParameterError { what, value, must }) }
}

/// Returns `value` if it is finite and positive.
///
/// # Errors
/// [`ParameterError`] otherwise, also for NaN.
pub fn positive(what: &'static str, value: f64) -> Result<f64, ParameterError> {
    require(value.is_finite() && value > 0.0, what, value, "positive and finite")
}

/// Returns `value` if it is finite and not negative.
///
/// # Errors
/// [`ParameterError`] otherwise, also for NaN.
pub fn non_negative(what: &'static str, value: f64) -> Result<f64, ParameterError> {
    require(value.is_finite() && value >= 0.0, what, value, "finite and not negative")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_their_limits_and_a_sentence() {
        assert_eq!((positive("a", 0.1), non_negative("a", 0.0)), (Ok(0.1), Ok(0.0)));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(positive("a", bad).is_err());
            assert_eq!(non_negative("a", bad).is_err(), bad != 0.0);
        }
        let message = positive("density", -0.5).unwrap_err().to_string();
        assert_eq!(message, "density is -0.5, but must be positive and finite");
    }
}
