//! Dead load on a part of the boundary.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::SolidFacet;

/// `-(t, w)_{Γ̂}`, with a traction `t` per reference area that keeps its direction
///
/// Source: paper, Eq. (4), Neumann data of the structure on the reference configuration.
/// Couples: solid velocity × nothing.   Domain: given boundary facets, reference configuration.
/// Units: force (2D: per unit depth).
///   residual_i = -|F|/D t,    tangent = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traction<const D: usize> {
    /// Force per reference area.
    pub traction: Vector<D>,
}

impl<const D: usize> Term<SolidFacet<D>> for Traction<D> {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        let load = self.traction * (-facet.reference_measure / D as f64);
        for i in facet.nodes() {
            out.add_vector::<D>(facet.row(i), load);
        }
    }
}
