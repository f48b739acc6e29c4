//! Implicit Euler.

use super::{Row, TimeScheme, Weights};

/// First order, dissipative: `d = d^n + Δt v`, `a = (v - v^n)/Δt`.
///
/// Source: paper, fully discrete problem, with velocity as the unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImplicitEuler;

impl TimeScheme for ImplicitEuler {
    fn weights(&self, lengths: &[f64], _starts: bool) -> Weights {
        let dt = lengths[0];
        Weights {
            displacement: Row { slope: dt, displacement: [1.0, 0.0], ..Row::default() },
            acceleration: Row { slope: dt.recip(), velocity: [-dt.recip(), 0.0], ..Row::default() },
            ..Weights::default()
        }
    }
}
