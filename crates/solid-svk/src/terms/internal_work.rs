//! Internal work of the solid.

use std::sync::Arc;

use algebra::LocalSystem;
use mesh::{Tensor, Vector};

use crate::kinematics::deformation_gradient;
use crate::{Material, SolidCell, SolidTerm};

/// `a^s(d, w) = (P(F), ∇w)_{Ω̂^s}`, `F = I + ∇d`
///
/// Source: paper, Sec. 2.1 and forms after Eq. (4); the law of Sec. 4.1 is that of `S = F⁻¹ P`.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units (cgs, per unit depth in 2D): residual dyn/cm, tangent dyn·s/cm².
/// With g_i = ∇N_i (constant on a cell, P1), H = e_b ⊗ g_j and `d = d_pred + c_d v`:
///   residual_i = |K| P g_i,    column b of tangent_ij = |K| c_d dP\[H\] g_i.
#[derive(Clone, Debug)]
pub struct InternalWork<const D: usize> {
    /// Material law.
    pub material: Arc<dyn Material<D>>,
}

impl<const D: usize> SolidTerm<D> for InternalWork<D> {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let f = deformation_gradient(&cell.grad_displacement());
        let p = cell.volume * self.material.first_piola(&f);
        let scale = cell.volume * cell.displacement_per_velocity;
        for i in cell.nodes() {
            out.add_vector(cell.velocity(i), (p * cell.gradients[i]).as_slice());
        }
        if !out.wants_tangent() {
            return;
        }
        for j in cell.nodes() {
            for b in 0..D {
                let mut e_b = Vector::<D>::zeros();
                e_b[b] = 1.0;
                let h: Tensor<D> = e_b * cell.gradients[j].transpose();
                let dp = scale * self.material.first_piola_derivative(&f, &h);
                for i in cell.nodes() {
                    let column = dp * cell.gradients[i];
                    out.add_block(cell.velocity(i), cell.velocity(j) + b, D, column.as_slice());
                }
            }
        }
    }
}
