//! Times of one step.

use algebra::time::{TimeScheme, Weights};

/// End and length of a time step, or of a part of one, with the weights of the time scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// Time at the end.
    pub end: f64,
    /// Length of the step.
    pub length: f64,
    /// Rows of the scheme, the same for all fields.
    pub weights: Weights,
}

impl StepTime {
    /// Creates a step of a scheme; `starts` is true if no acceleration is known.
    pub fn new(scheme: &dyn TimeScheme, end: f64, length: f64, starts: bool) -> Self {
        Self { end, length, weights: scheme.weights(length, starts) }
    }

    /// Returns the time of the stage.
    pub fn stage(&self) -> f64 {
        let alpha = self.weights.alpha_f;
        if alpha == 0.0 { self.end } else { self.end - alpha * self.length }
    }

    /// Returns the time to which geometry is extrapolated: that of the start for implicit Euler.
    pub fn of_geometry(&self) -> f64 {
        self.end - self.length + self.weights.extrapolated[0].velocity
    }
}
