//! Internal work of the solid.

use std::sync::Arc;

use algebra::{LocalSystem, Term};

use crate::cell::row;
use crate::{Material, SolidPoint};

/// `a^s(d, w) = (P(F), ∇w)_{Ω̂^s}`, `F = I + ∇d`
///
/// Source: paper, Sec. 2.1 and forms after Eq. (4); the law of Sec. 4.1 is that of `S = F⁻¹ P`.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
/// With g_i = ∇N_i and the weight w of a quadrature point, and `d = d_pred + c_d v`:
///   residual_i = w P g_i,    column b of tangent_ij = w c_d dP\[e_b ⊗ g_j\] g_i.
#[derive(Clone, Debug)]
pub struct InternalWork<const D: usize> {
    /// Material law of each group of cells.
    pub materials: Vec<Arc<dyn Material<D>>>,
}

impl<const D: usize> Term<SolidPoint<'_, D>> for InternalWork<D> {
    #[inline]
    fn add(&self, point: &SolidPoint<'_, D>, out: &mut LocalSystem) {
        let material = &self.materials[point.group];
        let f = &point.deformation.gradient;
        let p = point.weight * material.first_piola(f);
        for (i, g) in point.gradients.iter().enumerate() {
            out.add_vector::<D>(row::<D>(i), p * g);
        }
        if !out.has_tangent() {
            return;
        }
        let scale = point.weight * point.displacement_slope;
        material.for_each_stiffness(f, point.gradients, &mut |i, j, block| {
            let block = block * scale;
            out.add_block::<D, D>(row::<D>(i), row::<D>(j), block);
            if i != j {
                out.add_block::<D, D>(row::<D>(j), row::<D>(i), block.transpose());
            }
        });
    }
}
