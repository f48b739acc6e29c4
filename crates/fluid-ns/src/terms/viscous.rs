//! Viscous work of the fluid.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::FluidCell;

/// `a^f(u, v) = 2 μ^f (D(u), ∇v)_{Ω^f}`
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units: force (2D: per unit depth).
/// With `g_i = ∇N_i`, `V = ∫ 1`, and the velocity `u` at the stage:
///   residual_i = μ V (∇u + ∇uᵀ) g_i,    tangent_ij = μ V ( (g_i · g_j) I + g_j ⊗ g_i ).
pub struct Viscous {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Viscous {
    #[inline]
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let g = cell.gradients;
        let weight = self.viscosity * cell.moments.volume();
        let grad_u = cell.grad_velocity();
        let stress = (grad_u + grad_u.transpose()) * weight;
        (0..=D).for_each(|i| out.add_vector::<D>(cell.velocity_row(i), stress * g[i]));
        if !out.has_tangent() {
            return;
        }
        for j in 0..=D {
            for i in 0..=D {
                let block =
                    Tensor::from_diagonal_element(weight * g[i].dot(&g[j])) + g[j] * (g[i] * weight).transpose();
                out.add_block::<D, D>(cell.velocity_row(i), cell.velocity_row(j), block);
            }
        }
    }
}
