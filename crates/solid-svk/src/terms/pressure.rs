//! Uniform pressure on the moving boundary.

use algebra::{LocalSystem, Term};
use mesh::{Tensor, Vector, det};

use crate::SolidFacet;

/// `(p n, w)_{Γ(d)} = (p J F⁻ᵀ N, w)_{Γ̂}`: a pressure `p` that presses along the current normal
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: solid velocity × solid velocity.   Domain: given boundary facets, current configuration.
/// Units: force (2D: per unit depth).
/// With the edges a_k = x_k - x_0 of the facet, the area vector is multilinear,
/// `(|F| n)_c = det(e_c, a_1, .., a_{D-1})/(D - 1)!`:
///   residual_i = p/D |F| n,    column b of tangent_ik = c_d p/D ∂(|F| n)/∂x_k · e_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerPressure {
    /// Pressure from outside.
    pub pressure: f64,
}

impl<const D: usize> Term<SolidFacet<D>> for FollowerPressure {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        // Column 0 is a place for the unit vector.
        let mut edges = Tensor::<D>::zeros();
        for k in 1..D {
            edges.set_column(k, &(facet.points[k] - facet.points[0]));
        }
        let per_node = self.pressure / (D * (1..D).product::<usize>()) as f64;
        let load = per_node * area_vector(&edges);
        for i in facet.nodes() {
            out.add_vector::<D>(facet.row(i), load);
        }
        for k in 1..D {
            for b in 0..D {
                let mut e_b = Vector::<D>::zeros();
                e_b[b] = facet.displacement_slope * per_node;
                let mut varied = edges;
                varied.set_column(k, &e_b);
                let column = area_vector(&varied);
                for i in facet.nodes() {
                    out.add_block::<D, 1>(facet.row(i), facet.row(k) + b, column);
                    out.add_block::<D, 1>(facet.row(i), facet.row(0) + b, -column);
                }
            }
        }
    }
}

/// Returns `det(e_c, a_1, ..)` for each c, with the edges in columns 1 to D - 1.
#[inline]
fn area_vector<const D: usize>(edges: &Tensor<D>) -> Vector<D> {
    Vector::from_fn(|c, _| {
        let mut columns = *edges;
        columns.column_mut(0).fill(0.0);
        columns[(c, 0)] = 1.0;
        det(&columns)
    })
}
