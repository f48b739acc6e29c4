//! Internal work of the solid in axisymmetric coordinates.

use std::sync::Arc;

use algebra::{LocalSystem, Term};
use mesh::{Tensor, Vector};

use crate::cell::row;
use crate::deformation::{SpaceTensor, THETA, in_plane, into_space};
use crate::{Material, SolidPoint};

/// `(P(F), ∇w)_{Ω̂^s} + (P_θθ(F), w_R/R)_{Ω̂^s}`, with the deformation gradient in space
/// `F = F_Rz + (1 + d_R/R) e_θ ⊗ e_θ`
///
/// Source: `a^s` of the paper in cylindrical coordinates, without swirl.
/// It replaces [`InternalWork`](crate::terms::InternalWork), because all entries of `P` depend on the hoop stretch.
/// Couples: solid velocity × solid velocity.   Domain: reference cells in axisymmetric coordinates; none in Cartesian
/// ones.
/// Units: force of the whole circle.
/// With g_i = ∇N_i, h_i = N_i/R and the weight w of a quadrature point, and `d = d_pred + c_d v`:
///   residual_i = w (P g_i + P_θθ h_i e_R),    column b of tangent_ij = w c_d (dP g_i + dP_θθ h_i e_R)
/// with the derivative dP in the direction `e_b ⊗ g_j + δ_bR h_j e_θ ⊗ e_θ`.
#[derive(Clone, Debug)]
pub struct HoopWork<const D: usize> {
    /// Material law of each group of cells.
    pub materials: Vec<Arc<dyn Material<D>>>,
}

impl<const D: usize> Term<SolidPoint<'_, D>> for HoopWork<D> {
    fn add(&self, point: &SolidPoint<'_, D>, out: &mut LocalSystem) {
        let Some((radial, shapes)) = point.hoop else { return };
        let (law, f) = (self.materials[point.group].in_space(), point.deformation.in_space());
        let force = |p: &SpaceTensor, i: usize| {
            let mut force = in_plane::<D>(p) * point.gradients[i];
            force[radial] += p[(THETA, THETA)] * shapes[i];
            force
        };
        let p = law.first_piola(&f) * point.weight;
        (0..shapes.len()).for_each(|i| out.add_vector::<D>(row::<D>(i), force(&p, i)));
        if !out.has_tangent() {
            return;
        }
        let scale = point.weight * point.displacement_slope;
        for j in 0..shapes.len() {
            for b in 0..D {
                let mut along = Tensor::<D>::zeros();
                along.set_row(b, &point.gradients[j].transpose());
                let stretch = if b == radial { shapes[j] } else { 0.0 };
                let dp = law.first_piola_derivative(&f, &into_space(&along, stretch)) * scale;
                for i in 0..shapes.len() {
                    let column: Vector<D> = force(&dp, i);
                    out.add_block::<D, 1>(row::<D>(i), row::<D>(j) + b, column);
                }
            }
        }
    }
}
