//! Statics, step by step.

use super::{ImplicitEuler, Row, TimeScheme, Weights};

/// No inertia: `d = d^n + Δt v`, `a = 0`. Each step ends in equilibrium; a fluid between bodies at rest is steady.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QuasiStatic;

impl TimeScheme for QuasiStatic {
    fn weights(&self, dt: f64, starts: bool) -> Weights {
        Weights { stage_acceleration: Row::default(), pressure_at_stage: true, ..ImplicitEuler.weights(dt, starts) }
    }
}
