//! Implicit Euler.

use super::{Row, TimeScheme, Weights};

/// First order, dissipative: `d = d^n + Δt v`, `a = (v - v^n)/Δt`, on the geometry at the start of the step.
///
/// Source: paper, fully discrete problem, with velocity as the unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImplicitEuler;

impl TimeScheme for ImplicitEuler {
    fn weights(&self, dt: f64, _starts: bool) -> Weights {
        let (d, v) = (Row::DISPLACEMENT, Row::UNKNOWN);
        let end = d + v * dt;
        let acceleration = (v - Row::VELOCITY) * dt.recip();
        Weights {
            stage_displacement: end,
            stage_acceleration: acceleration,
            displacement: end,
            velocity: v,
            acceleration,
            extrapolated: [d, d],
            shifted: [d, end],
            of_energy: [[d, Row::VELOCITY]; 2],
            conserves: false,
            pressure_at_stage: false,
            alpha_f: 0.0,
        }
    }
}
