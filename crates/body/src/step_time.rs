//! Times of one step.

/// Start, end and length of a time step, or of a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct StepTime {
    /// Time at the start.
    pub start: f64,
    /// Time at the end. It may differ from `start + length` by rounding, so that multiples of a step are exact.
    pub end: f64,
    /// Lengths of this step and of those before, newest first.
    pub lengths: Vec<f64>,
}

impl StepTime {
    /// Returns the length of the step.
    pub fn length(&self) -> f64 {
        self.lengths[0]
    }

    /// Returns the time of the stage that lies the fraction `alpha` of the step before its end.
    pub fn stage(&self, alpha: f64) -> f64 {
        if alpha == 0.0 { self.end } else { self.end - alpha * self.length() }
    }
}
