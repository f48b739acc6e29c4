//! Times of one step.

use algebra::time::{TimeScheme, Weights};

/// End and length of a time step or substep, with the weights of the time scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// Time at the end.
    pub end: f64,
    /// Length of the step.
    pub length: f64,
    /// Weights of the time scheme for this step, the same for all fields.
    pub weights: Weights,
}

impl StepTime {
    /// Creates a step of a scheme. `is_first`: the acceleration at the start is unknown, as in the first step of a run.
    pub fn new(scheme: &dyn TimeScheme, end: f64, length: f64, is_first: bool) -> Self {
        Self { end, length, weights: scheme.weights(length, is_first) }
    }

    /// Returns the time of the stage.
    pub fn stage(&self) -> f64 {
        let alpha = self.weights.alpha_f;
        if alpha == 0.0 { self.end } else { self.end - alpha * self.length }
    }

    /// Returns the rounding error of a velocity: that of a position of size `largest`, over the length of the step; for
    /// [`BlockLayout::set_rounding`](algebra::BlockLayout::set_rounding).
    pub fn rounding(&self, largest: f64) -> f64 {
        f64::EPSILON * largest / self.length
    }

    /// Returns whether the geometry of the step is extrapolated; otherwise it is the geometry at the start.
    pub fn extrapolates(&self) -> bool {
        self.weights.extrapolated[0].velocity != 0.0
    }

    /// Returns the time of the geometry of the step: its start for implicit Euler, its stage for generalised-α.
    pub fn geometry_time(&self) -> f64 {
        // Positions are extrapolated by `Δ v`, so that the weight of the velocity is the time `Δ` from the start.
        self.end - self.length + self.weights.extrapolated[0].velocity
    }
}
