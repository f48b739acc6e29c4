//! Wall-clock times of a step.

/// Wall-clock time of each part of a step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSeconds {
    /// Cutting the background.
    pub cut: f64,
    /// Preparation except the cut.
    pub space: f64,
    /// Transfer of the history, a part of `space`.
    pub transfer: f64,
    /// Search for contacts, a part of `space`.
    pub search: f64,
    /// Pattern and assembly, with the regimes of contacts and vapour.
    pub assembly: f64,
    /// Linear solver.
    pub linear: f64,
    /// Multipliers of contacts, between solves.
    pub multipliers: f64,
    /// Report of the step.
    pub report: f64,
}
