//! Internal work of the solid.

use std::sync::Arc;

use algebra::{LocalSystem, Term};

use crate::kinematics::deformation_gradient;
use crate::{Material, SolidCell};

/// `a^s(d, w) = (P(F), ∇w)_{Ω̂^s}`, `F = I + ∇d`
///
/// Source: paper, Sec. 2.1 and forms after Eq. (4); the law of Sec. 4.1 is that of `S = F⁻¹ P`.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
/// With g_i = ∇N_i (constant on a cell, P1) and `d = d_pred + c_d v`:
///   residual_i = |K| P g_i,    column b of tangent_ij = |K| c_d dP\[e_b ⊗ g_j\] g_i.
#[derive(Clone, Debug)]
pub struct InternalWork<const D: usize> {
    /// Material law.
    pub material: Arc<dyn Material<D>>,
}

impl<const D: usize> Term<SolidCell<'_, D>> for InternalWork<D> {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let f = deformation_gradient(&cell.grad_displacement());
        let p = cell.volume * self.material.first_piola(&f);
        let scale = cell.volume * cell.displacement_slope;
        for i in cell.nodes() {
            cell.add(i, p * cell.gradients[i], out);
        }
        if !out.has_tangent() {
            return;
        }
        self.material.for_each_stiffness(&f, cell.gradients, &mut |i, j, block| {
            let block = block * scale;
            out.add_block::<D, D>(cell.row(i), cell.row(j), block);
            if i != j {
                out.add_block::<D, D>(cell.row(j), cell.row(i), block.transpose());
            }
        });
    }
}
