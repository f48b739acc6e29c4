//! The generalised-α scheme.

use std::f64::consts::FRAC_1_SQRT_2;

use super::{Row, TimeScheme, Weights};

/// Second order, with the least damping of slow vibrations for a given damping of the fastest ones.
///
/// Newmark's rules for the end of the step,
///
/// `v^{n+1} = v^n + Δt ((1-γ) a^n + γ a^{n+1})`, `d^{n+1} = d^n + Δt v^n + Δt² ((1/2-β) a^n + β a^{n+1})`,
///
/// and a stage at `v = (1-α_f) v^{n+1} + α_f v^n`, with the displacement alike, and the acceleration alike with `α_m`.
/// The same rules advance fluid, elastic and rigid bodies. They are of second order for equations of first order, too.
///
/// Geometry is extrapolated to the stage. If `a^n` is unknown, the acceleration is constant over the step. Then no
/// equation has to be solved for `a^n`, motion under constant acceleration stays exact, and the order is kept.
///
/// The shifted displacement `Y = d + (1/2 - α_f) Δt v + (γ/2 - β) Δt² a` changes by `Δt v` over a step.
///
/// With `r = (1-ρ_∞)/(1+ρ_∞)`, `w = Δt a` and `V = v - r/2 w`, the energy of the scheme for mass `M` and stiffness `K`
/// is
///
/// `1/2 |v + r/2 w|²_M + r²/4 |w|²_M + 1/2 |Y|²_K + r²/8 |Δt V|²_K`,
///
/// and a step without forces loses `3/4 r³ |Δw|²_M + r³/4 |Δt ΔV|²_K` of it, where `Δw` and `ΔV` are changes over the
/// step. It is the mean of the energies of two motions: `d` and `d + r Δt v - r²/2 Δt² a` with the velocities
/// `v + (1/2 ∓ 1/√2) r w`.
///
/// Source: Chung and Hulbert 1993, A time integration algorithm for structural dynamics with improved numerical
/// dissipation, doi:10.1115/1.2900803; for fluids, Jansen, Whiting and Hulbert 2000, doi:10.1016/S0045-7825(00)00203-6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralisedAlpha {
    rho_inf: f64,
}

impl GeneralisedAlpha {
    /// Creates the scheme whose spectral radius for infinitely fast vibrations is `rho_inf`: 1 damps nothing (the
    /// midpoint rule for linear forces), 0 removes the fastest vibrations in one step. `None` if it is not from 0 to 1.
    pub fn new(rho_inf: f64) -> Option<Self> {
        (0.0..=1.0).contains(&rho_inf).then_some(Self { rho_inf })
    }
}

impl TimeScheme for GeneralisedAlpha {
    fn weights(&self, dt: f64, starts: bool) -> Weights {
        let alpha_m = if starts { 0.0 } else { (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0) };
        let alpha_f = self.rho_inf / (self.rho_inf + 1.0);
        // Newmark's rules with a^n = a^{n+1} equal his rules with a^n = 0, β = 1/2 and γ = 1.
        let beta = if starts { 0.5 } else { 0.25 * (1.0 - alpha_m + alpha_f).powi(2) };
        let gamma = if starts { 1.0 } else { 0.5 - alpha_m + alpha_f };

        let (d, v, a, unknown) = (Row::DISPLACEMENT, Row::VELOCITY, Row::ACCELERATION, Row::UNKNOWN);
        let v_end = (unknown - v * alpha_f) * (1.0 - alpha_f).recip();
        let a_end = (v_end - v) * (gamma * dt).recip() - a * ((1.0 - gamma) / gamma);
        let d_end = d + v * dt + (a * (0.5 - beta) + a_end * beta) * dt.powi(2);
        // Of second order although without acceleration, which contains the noise of the fastest vibrations.
        let ahead = |dt: f64| d + v * dt;
        let r = (1.0 - self.rho_inf) / (1.0 + self.rho_inf);
        let motion = |d: Row, share: f64| [d, v + a * (share * r * dt)];
        let moved = d + v * (r * dt) - a * (0.5 * (r * dt).powi(2));
        // A constant acceleration cancels in the change of the shifted displacement.
        let shift = |d: Row, v: Row, a: Row| d + v * ((0.5 - alpha_f) * dt) + a * ((0.5 * gamma - beta) * dt.powi(2));
        Weights {
            stage_displacement: d_end * (1.0 - alpha_f) + d * alpha_f,
            stage_acceleration: a_end * (1.0 - alpha_m) + a * alpha_m,
            displacement: d_end,
            velocity: v_end,
            acceleration: a_end,
            extrapolated: [ahead((1.0 - alpha_f) * dt), ahead(dt)],
            shifted: [shift(d, v, a), shift(d_end, v_end, a_end)],
            of_energy: [motion(d, 0.5 - FRAC_1_SQRT_2), motion(moved, 0.5 + FRAC_1_SQRT_2)],
            conserves: true,
            pressure_at_stage: true,
            alpha_f,
        }
    }
}
