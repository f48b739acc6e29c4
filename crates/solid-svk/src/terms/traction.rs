//! Dead load on a part of the boundary.

use algebra::LocalSystem;
use mesh::Vector;

use crate::{FacetTerm, SolidFacet};

/// `-(t, w)_{Γ̂}`, with a traction `t` per reference area that keeps its direction
///
/// Source: paper, Eq. (4), Neumann data of the structure on the reference configuration.
/// Couples: solid velocity × nothing.   Domain: given boundary facets, reference configuration.
/// Units (cgs, per unit depth in 2D): residual dyn/cm.
///   residual_i = -|F|/D t,    tangent = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traction<const D: usize> {
    /// Force per reference area, dyn/cm².
    pub traction: Vector<D>,
}

impl<const D: usize> FacetTerm<D> for Traction<D> {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        let load = self.traction * (-facet.reference_measure / D as f64);
        for i in facet.nodes() {
            out.add_vector(facet.velocity(i), load.as_slice());
        }
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "solid traction"
    }
}
