//! Viscous work of the fluid.

use algebra::LocalSystem;
use mesh::Tensor;

use crate::{CellTerm, FluidCell};

/// `a^f(u, v) = 2 μ^f (D(u), ∇v)_{Ω^f}`
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units (cgs, per unit depth in 2D): residual dyn, tangent dyn·s/cm.
/// With g_i = ∇N_i (constant on a cell, P1):
///   residual_i = ∫ μ (∇u + ∇uᵀ) g_i,    tangent_ij = ∫ μ ( (g_i · g_j) I + g_j ⊗ g_i ).
pub struct Viscous {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl<const D: usize> CellTerm<D> for Viscous {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let weight = self.viscosity * cell.volume();
        let grad_u = cell.grad_u();
        let stress = (grad_u + grad_u.transpose()) * weight;
        for i in cell.nodes() {
            let g_i = cell.gradients[i];
            out.add_vector(cell.velocity(i), (stress * g_i).as_slice());
            for j in cell.nodes() {
                let g_j = cell.gradients[j];
                let k = (Tensor::<D>::identity() * g_i.dot(&g_j) + g_j * g_i.transpose()) * weight;
                out.add_block(cell.velocity(i), cell.velocity(j), D, k.as_slice());
            }
        }
    }
}
