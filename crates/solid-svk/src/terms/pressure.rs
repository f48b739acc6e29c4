//! Uniform pressure on the moving boundary.

use algebra::{LocalSystem, Term};
use mesh::{Tensor, area_vector};

use crate::SolidFacet;
use crate::cell::row;

/// `(p n, v)_{Γ(d)} = (p J F⁻ᵀ N, v)_{Γ̂}`: a pressure `p` from outside, against the current normal `n`
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: solid velocity × solid velocity.   Domain: given boundary facets, current configuration.
/// Units: force (2D: per unit depth).
/// With the tangents `a_k = ∂x/∂ξ_k` at a quadrature point of weight w in the local coordinates ξ, the area vector is
/// multilinear, `A_c = det(e_c, a_1, .., a_{D-1})`:
///   residual_i = p w N_i A,    column b of tangent_ij = c_d p N_i (w Σ_k ∂N_j/∂ξ_k ∂A/∂a_k · e_b + N_j ∂w/∂x_b A)
/// where `c_d` is [`SolidFacet::displacement_slope`]. The second term is that of axisymmetric coordinates, in which the
/// weight `w ~ x_R` depends on the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerPressure {
    /// Pressure from outside.
    pub pressure: f64,
}

impl<const D: usize> Term<SolidFacet<D>> for FollowerPressure {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        // Column 0 is a place for the unit vector.
        let mut tangents = Tensor::<D>::zeros();
        (1..D).for_each(|k| tangents.set_column(k, &facet.tangents[k - 1]));
        let (shape, scale) = (&facet.shape, self.pressure * facet.weight);
        let unweighted = area_vector(&tangents) * self.pressure;
        let area = area_vector(&tangents) * scale;
        for i in facet.nodes() {
            out.add_vector::<D>(row::<D>(i), area * shape.values[i]);
        }
        for k in 1..D {
            for b in 0..D {
                let mut varied = tangents;
                varied.column_mut(k).fill(0.0);
                varied[(b, k)] = facet.displacement_slope * scale;
                let by_tangent = area_vector(&varied);
                for (i, j) in facet.nodes().flat_map(|i| facet.nodes().map(move |j| (i, j))) {
                    let column = by_tangent * (shape.values[i] * shape.derivatives[j][k - 1]);
                    out.add_block::<D, 1>(row::<D>(i), row::<D>(j) + b, column);
                }
            }
        }
        for (b, by_position) in facet.weight_gradient.iter().enumerate().filter(|(_, by_position)| **by_position != 0.0)
        {
            let by_weight = unweighted * (facet.displacement_slope * by_position);
            for (i, j) in facet.nodes().flat_map(|i| facet.nodes().map(move |j| (i, j))) {
                let column = by_weight * (shape.values[i] * shape.values[j]);
                out.add_block::<D, 1>(row::<D>(i), row::<D>(j) + b, column);
            }
        }
    }
}
