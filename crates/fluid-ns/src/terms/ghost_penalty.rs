//! Ghost penalty.

use crate::FluidFace;

/// `g_h(u, v) = γ_g μ^f h_F ([∇u]n, [∇v]n)_F`: keeps the mortar coercive and bounds the condition number of the
/// unscaled matrix for parts of any size.
///
/// Source: paper, form after Eq. (4); Burman 2010, DOI 10.1016/j.crma.2010.10.006.
/// Couples: velocity × velocity, each component by itself.   Domain: faces of cut cells, whole face. In films the
/// weight is reduced by the factor `1 - χ`.
/// Units: weight viscosity × length.
pub struct GhostPenalty {
    /// `γ_g`.
    pub gamma_ghost: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl GhostPenalty {
    /// Returns the weight `c_F` of a face.
    pub fn weight<const D: usize>(&self, face: &FluidFace<'_, D>) -> f64 {
        let weight = if face.value.is_ghost { self.gamma_ghost * self.viscosity * face.value.diameter } else { 0.0 };
        (1.0 - face.film) * weight
    }
}
