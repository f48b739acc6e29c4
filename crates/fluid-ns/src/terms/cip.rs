//! Continuous interior penalty.

use crate::FluidFace;

/// Scaling of the velocity penalty. It is a numerical viscosity; the paper does not state it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CipProfile {
    /// `c_F = γ_u ρ h_F² |u*·n|_F`, which vanishes under refinement.
    Consistent {
        /// `γ_u`, 0.05 in the standard set.
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
/// `τ_F = (ρ s + ρ |u*|_F/h_F + μ/h_F²)^{-1}` and the rate `s`, `1/Δt` with implicit Euler. It provides the inf-sup
/// condition, and is the ghost penalty of the pressure.
///
/// Source: paper, `s_h` in Eq. (4); scaling as in Burman, Fernández, Hansbo 2006, DOI 10.1137/040617686, with the time
/// step in `τ_F` in addition, which reduces the penalty for small steps.
/// Couples: pressure × pressure.   Domain: interior faces of active parts, whole face, and planes of symmetry, where
/// the jump is that of `∇p - f` ([`FluidFaces`](crate::FluidFaces)). In films the weight is reduced by the factor
/// `1 - χ`, because the term [`Film`](crate::terms::Film) stabilises the pressure there; where a film ends at an edge,
/// with the larger share of the two parts.
/// Units: weight length²/viscosity × length.
pub struct CipPressure {
    /// `γ_p`.
    pub gamma_pressure: f64,
    /// Density `ρ^f`.
    pub density: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
    /// Rate `s`: derivative of acceleration with respect to velocity, or the inverse of a fixed time. Zero if steady.
    pub rate: f64,
}

impl CipPressure {
    /// Returns the weight `c_F` of a face.
    pub fn weight<const D: usize>(&self, face: &FluidFace<'_, D>) -> f64 {
        let h = face.value.diameter;
        let inverse_tau = self.density * self.rate + self.density * face.speed / h + self.viscosity / (h * h);
        (1.0 - face.film_of_pressure) * self.gamma_pressure * h / inverse_tau
    }
}
