//! Statics, step by step.

use super::{ImplicitEuler, Row, TimeScheme, Weights};

/// No inertia: `d = d^n + Δt v`, `a = 0`. Each step ends in equilibrium; a fluid between bodies at rest is steady.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QuasiStatic;

impl TimeScheme for QuasiStatic {
    fn weights(&self, dt: f64, starts: bool) -> Weights {
        let none = Row::default();
        let euler = ImplicitEuler.weights(dt, starts);
        Weights { stage_acceleration: none, acceleration: none, pressure_at_stage: true, ..euler }
    }
}
