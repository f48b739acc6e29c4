//! Continuous interior penalty.

use crate::FluidFace;

/// Scaling of the velocity penalty. It is a numerical viscosity; the paper does not state it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CipProfile {
    /// `c_F = γ_u ρ h_F² |u*·n|_F`, which vanishes under refinement.
    Consistent {
        /// `γ_u`, 0.1 by experience.
        gamma_u: f64,
    },
    /// `c_F = γ_1 ρ |F| |u*·n|_F L^{3-D}` with the measure of the face instead of `h_F²`, L one unit of length.
    /// In 2D the weight is h instead of h²: a calibration to the paper's results, not a consistent scaling.
    Paper {
        /// `γ_1`, 0.7 by calibration.
        gamma_1: f64,
    },
}

/// Velocity part of `s_h`: `c_F ([∇u]n, [∇v]n)_F` against oscillations where convection dominates.
///
/// Source: paper, `s_h` in Eq. (4), form and constants not given there; Burman, Fernández, Hansbo 2006,
/// DOI 10.1137/040617686 (consistent profile).
/// Couples: velocity × velocity, each component by itself.   Domain: interior faces of active parts, whole face.
/// Units: `c_F` viscosity × length.
pub struct CipVelocity {
    /// The scaling.
    pub profile: CipProfile,
    /// Density `ρ^f`.
    pub density: f64,
}

impl CipVelocity {
    /// Returns the weight `c_F` of a face.
    pub fn weight<const D: usize>(&self, face: &FluidFace<'_, D>) -> f64 {
        let scale = match self.profile {
            CipProfile::Consistent { gamma_u } => gamma_u * face.value.diameter * face.value.diameter,
            CipProfile::Paper { gamma_1 } => gamma_1 * face.value.measure,
        };
        scale * self.density * face.normal_speed
    }
}

/// Pressure part of `s_h`: `γ_p h_F τ_F ([∇p]·n, [∇q]·n)_F` with
/// `τ_F = (ρ √(|a*|_F/h_F) + ρ |u*|_F/h_F + μ/h_F²)^{-1}`; where the acceleration `a*` is not known, with `ρ/Δt` in place of the first
/// share. It gives the inf-sup condition, and is the pressure's ghost penalty.
///
/// The three shares are those of inertia, convection and viscosity: rates at which the flow changes over a cell. Fluid that accelerates
/// from rest passes a cell in a time of about `√(h/|a|)`. With `Δt` in `τ_F` the equations that are discrete in space change with the
/// step, by a part of the error of the mesh: on a given mesh, a scheme of second order is then of first order at best.
///
/// Source: paper, `s_h` in Eq. (4); scaling as in Burman, Fernández, Hansbo 2006, DOI 10.1137/040617686, where there is no inertia.
/// Stability without the step in the parameter: Burman and Fernández 2009, SIAM J. Numer. Anal. 47, 409.
/// Couples: pressure × pressure.   Domain: interior faces of active parts, whole face.
/// Units: weight length²/viscosity × length.
pub struct CipPressure {
    /// `γ_p`.
    pub gamma_pressure: f64,
    /// Density `ρ^f`.
    pub density: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
    /// Derivative of acceleration with respect to velocity: `1/Δt` for implicit Euler, zero for a steady problem. It counts where
    /// accelerations are not known.
    pub rate: f64,
}

impl CipPressure {
    /// Returns the weight `c_F` of a face.
    pub fn weight<const D: usize>(&self, face: &FluidFace<'_, D>) -> f64 {
        let h = face.value.diameter;
        let inertial = face.acceleration.map_or(self.rate, |acceleration| (acceleration / h).sqrt());
        let inverse_tau = self.density * (inertial + face.speed / h) + self.viscosity / (h * h);
        self.gamma_pressure * h / inverse_tau
    }
}
