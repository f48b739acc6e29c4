//! Statics, step by step.

use super::{Row, TimeScheme, Weights};

/// No inertia: `d = d^n + Δt v`, `a = 0`. Each step ends in equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QuasiStatic;

impl TimeScheme for QuasiStatic {
    fn weights(&self, lengths: &[f64], _starts: bool) -> Weights {
        let displacement = Row { slope: lengths[0], displacement: [1.0, 0.0], ..Row::default() };
        Weights { displacement, ..Weights::default() }
    }
}
