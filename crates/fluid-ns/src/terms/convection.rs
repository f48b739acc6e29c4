//! Convection.

use algebra::LocalSystem;
use mesh::Tensor;

use crate::{CellTerm, FluidCell};

/// `c(u, u, v) = ρ^f (u·∇u, v)_{Ω^f}`, optionally with the skew part `+ ρ^f/2 ((∇·u) u, v)`.
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units (cgs, per unit depth in 2D): residual dyn, tangent dyn·s/cm.
/// tangent_ij = ∫ ρ N_i ( N_j ∇u + (u·g_j) I ), exact.
pub struct Convection {
    /// Density `ρ^f`.
    pub density: f64,
    /// Whether to add the skew part, which makes the term conserve kinetic energy.
    pub skew: bool,
}

impl<const D: usize> CellTerm<D> for Convection {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let grad_u = cell.grad_u();
        let half_divergence = if self.skew { 0.5 * grad_u.trace() } else { 0.0 };
        for q in cell.points() {
            let weight = self.density * q.weight;
            let force = (grad_u * q.velocity + q.velocity * half_divergence) * weight;
            for i in cell.nodes() {
                out.add_vector(cell.velocity(i), (force * q.shape[i]).as_slice());
            }
            for j in cell.nodes() {
                let g_j = cell.gradients[j];
                let along = q.velocity.dot(&g_j) + half_divergence * q.shape[j];
                let mut k = grad_u * q.shape[j] + Tensor::identity() * along;
                if self.skew {
                    k += q.velocity * g_j.transpose() * 0.5;
                }
                for i in cell.nodes() {
                    out.add_block(cell.velocity(i), cell.velocity(j), D, (k * (weight * q.shape[i])).as_slice());
                }
            }
        }
    }
}
