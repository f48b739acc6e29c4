//! The generalised-α scheme.

use super::{Row, TimeScheme, Weights};

/// Second order, with the least damping of slow vibrations for a given damping of the fastest ones.
///
/// Newmark's rules for the end of the step, solved for `d` and `a`,
///
/// `v = v^n + Δt ((1-γ) a^n + γ a)`, `d = d^n + Δt v^n + Δt² ((1/2-β) a^n + β a)`,
///
/// and a stage between the ends of the step. Where `a^n` is unknown, acceleration is taken as constant over the step. No
/// equation has to be solved for it then, motion under constant acceleration stays exact, and the order is kept.
///
/// Source: Chung and Hulbert 1993, A time integration algorithm for structural dynamics with improved numerical dissipation,
/// doi:10.1115/1.2900803.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralisedAlpha {
    rho_inf: f64,
}

impl GeneralisedAlpha {
    /// Creates the scheme whose spectral radius for infinitely fast vibrations is `rho_inf`: 1 damps nothing (the midpoint
    /// rule for linear forces), 0 removes the fastest vibrations in one step. `None` if it is not from 0 to 1.
    pub fn new(rho_inf: f64) -> Option<Self> {
        (0.0..=1.0).contains(&rho_inf).then_some(Self { rho_inf })
    }

    /// Returns `α_m = (2 ρ_∞ - 1)/(ρ_∞ + 1)`.
    fn alpha_m(self) -> f64 {
        (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0)
    }

    /// Returns `α_f = ρ_∞/(ρ_∞ + 1)`.
    fn alpha_f(self) -> f64 {
        self.rho_inf / (self.rho_inf + 1.0)
    }
}

impl TimeScheme for GeneralisedAlpha {
    fn weights(&self, lengths: &[f64], starts: bool) -> Weights {
        let (dt, alpha_m, alpha_f) = (lengths[0], self.alpha_m(), self.alpha_f());
        // Newmark's rules with a^n = a are those with a^n = 0, β = 1/2 and γ = 1.
        let beta = if starts { 0.5 } else { 0.25 * (1.0 - alpha_m + alpha_f).powi(2) };
        let gamma = if starts { 1.0 } else { 0.5 - alpha_m + alpha_f };
        let ratio = beta / gamma;
        Weights {
            displacement: Row {
                slope: dt * ratio,
                displacement: [1.0, 0.0],
                velocity: [dt * (1.0 - ratio), 0.0],
                acceleration: dt * dt * (0.5 - ratio),
            },
            acceleration: Row {
                slope: (gamma * dt).recip(),
                velocity: [-(gamma * dt).recip(), 0.0],
                acceleration: -(1.0 - gamma) / gamma,
                ..Row::default()
            },
            alpha_f,
            alpha_m: if starts { 0.0 } else { alpha_m },
        }
    }
}
