//! Convection.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::FluidCell;

/// `c(u, u, v) = ρ^f (u·∇u, v)_{Ω^f}`, optionally with the skew part `+ ρ^f/2 ((∇·u) u, v)`
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units: force (2D: per unit depth).
/// With `g_i = ∇N_i`, `m_ij = ∫ N_i N_j`, `w_i = ρ ∫ N_i u`, `(∇u)_ab = ∂u_a/∂x_b`, `G = ∇u + σ (∇·u) I`, the velocity
/// `u` at the stage, and `σ = 1/2` with the skew part, else 0:
///   residual_i = G w_i,    tangent_ij = ρ m_ij G + (w_i·g_j) I + σ w_i ⊗ g_j.
pub struct Convection {
    /// Density `ρ^f`.
    pub density: f64,
    /// Whether to add the skew part. The term tested with `u` is then the flux of kinetic energy through the boundary.
    pub skew: bool,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Convection {
    #[inline]
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let (g, grad_u) = (cell.gradients, cell.grad_velocity());
        let skew = if self.skew { 0.5 } else { 0.0 };
        let transport = grad_u + Tensor::identity() * (skew * grad_u.trace());
        for i in 0..=D {
            let w_i = cell.moments.weighted(i, &cell.velocities) * self.density;
            out.add_vector::<D>(cell.velocity_row(i), transport * w_i);
            if !out.has_tangent() {
                continue;
            }
            for (j, g_j) in g[..=D].iter().enumerate() {
                let mut block = transport * (self.density * cell.moments.at(i, j));
                block += Tensor::from_diagonal_element(w_i.dot(g_j));
                if self.skew {
                    block += w_i * (g_j * skew).transpose();
                }
                out.add_block::<D, D>(cell.velocity_row(i), cell.velocity_row(j), block);
            }
        }
    }
}
