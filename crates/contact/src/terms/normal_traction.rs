//! Normal traction between slave and obstacle.

use algebra::LocalSystem;
use mesh::Tensor;

use crate::ContactSite;

/// `(-λ n^w, w^s - w^m)_{Γ^{s,n}}`; penalty: `+ (γ_C0/s) ([ε - Δ]₊, w_n^s - w_n^m)`
///
/// Source: paper, Eq. (7) for a rigid obstacle, Eq. (11) and the two-body form for a deformable one.
/// Couples: velocities of slave and master.   Domain: slave's boundary facets, measure at step n, positions at n+1.
/// Units (cgs, per unit depth in 2D): residual dyn/cm, tangent dyn·s/cm².
/// With the share s_a of a vertex in `r = x - Π(x)` (N_a at the slave, minus the barycentric coordinate β_a at the
/// master), G_a = ∂β_a/∂x (zero at the slave), C = ∂n/∂x, all vertices alike:
///   residual_a = ∫ -λ s_a n,
///   tangent_ab = c_d ∫ λ' s_a s_b n ⊗ n + λ (s_a G_b ⊗ n + s_b n ⊗ G_a - Δ (G_a · G_b) n ⊗ n - s_a s_b C),
/// the second derivative of the gap included: exact wherever the projection is smooth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalTraction;

impl NormalTraction {
    /// Adds residual and tangent at one quadrature point.
    #[inline]
    pub fn add<const D: usize>(&self, site: &ContactSite<D>, out: &mut LocalSystem) {
        let n = site.projection.normal;
        let n_n = n * n.transpose();
        let lambda = site.weight * site.traction.value;
        let slope = site.weight * site.traction.d_gap;
        for a in site.nodes() {
            out.add_vector(a.row, (n * (-lambda * a.share)).as_slice());
            if !out.wants_tangent() {
                continue;
            }
            for b in site.nodes() {
                let curvature = a.gradient.dot(&b.gradient) * site.at.gap;
                let k: Tensor<D> = n_n * (slope * a.share * b.share - lambda * curvature)
                    + b.gradient * n.transpose() * (lambda * a.share)
                    + n * a.gradient.transpose() * (lambda * b.share)
                    - site.projection.normal_gradient * (lambda * a.share * b.share);
                out.add_block(a.row, b.row, D, (k * b.displacement_per_velocity).as_slice());
            }
        }
    }
}
