//! Schemes that advance a body in time.

use mesh::Vector;

use crate::{Error, StepRule};

/// How a body is advanced in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TimeScheme {
    /// First order; damps all but the slowest vibrations.
    #[default]
    ImplicitEuler,
    /// Second order, with damping of fast vibrations as wanted.
    GeneralisedAlpha(GeneralisedAlpha),
    /// No inertia: each step ends in equilibrium.
    QuasiStatic,
}

impl TimeScheme {
    /// The step of length `dt` from displacement, velocity and acceleration at its start, one vector of each per vertex;
    /// acceleration is `None` where it is not known, at the start of a run.
    ///
    /// # Errors
    /// As [`StepRule::implicit_euler`] and [`StepRule::generalised_alpha`].
    pub fn step<const D: usize>(
        self,
        dt: f64,
        displacement: &[Vector<D>],
        velocity: &[Vector<D>],
        acceleration: Option<&[Vector<D>]>,
    ) -> Result<StepRule<D>, Error> {
        match self {
            Self::ImplicitEuler => StepRule::implicit_euler(dt, displacement, velocity),
            Self::GeneralisedAlpha(scheme) => {
                StepRule::generalised_alpha(scheme, dt, displacement, velocity, acceleration)
            }
            Self::QuasiStatic => StepRule::quasi_static(dt, displacement),
        }
    }
}

/// The generalised-α scheme of second order with the least damping of slow vibrations for a given one of the fastest.
///
/// Source: Chung and Hulbert 1993, A time integration algorithm for structural dynamics with improved numerical dissipation,
/// doi:10.1115/1.2900803.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralisedAlpha {
    rho_inf: f64,
}

impl GeneralisedAlpha {
    /// The scheme whose spectral radius for infinitely fast vibrations is `rho_inf`: 1 damps nothing (the midpoint rule for linear
    /// forces), 0 removes the fastest vibrations in one step.
    ///
    /// # Errors
    /// [`Error::Parameter`]: `rho_inf` not from 0 to 1.
    pub fn new(rho_inf: f64) -> Result<Self, Error> {
        if (0.0..=1.0).contains(&rho_inf) {
            Ok(Self { rho_inf })
        } else {
            Err(Error::Parameter { what: "spectral radius rho_inf", value: rho_inf, must: "from 0 to 1" })
        }
    }

    /// `ρ_∞`.
    pub fn rho_inf(self) -> f64 {
        self.rho_inf
    }

    /// Weight of the old acceleration in inertia: `α_m = (2 ρ_∞ - 1)/(ρ_∞ + 1)`.
    pub fn alpha_m(self) -> f64 {
        (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0)
    }

    /// Weight of the old displacement in forces: `α_f = ρ_∞/(ρ_∞ + 1)`.
    pub fn alpha_f(self) -> f64 {
        self.rho_inf / (self.rho_inf + 1.0)
    }

    /// Newmark's `γ = 1/2 - α_m + α_f`.
    pub fn gamma(self) -> f64 {
        0.5 - self.alpha_m() + self.alpha_f()
    }

    /// Newmark's `β = (1 - α_m + α_f)²/4`.
    pub fn beta(self) -> f64 {
        0.25 * (1.0 - self.alpha_m() + self.alpha_f()).powi(2)
    }
}
