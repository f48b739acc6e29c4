//! Dead load on a part of the boundary.

use algebra::{LocalSystem, Term};
use body::TimeField;

use crate::SolidFacet;

/// `-(t, w)_{Γ̂}`, with a traction `t` per reference area that does not follow the motion
///
/// Source: paper, Eq. (4), Neumann data of the structure on the reference configuration.
/// Couples: solid velocity × nothing.   Domain: given boundary facets, reference configuration.
/// Units: force (2D: per unit depth).
///   residual_i = -|F|/D t(X_i),    tangent = 0: the rule with the vertices as points, of second order.
pub struct Traction<const D: usize> {
    /// Force per reference area at a reference position and time.
    pub traction: TimeField<D>,
}

impl<const D: usize> Term<SolidFacet<D>> for Traction<D> {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        for i in facet.nodes() {
            let load = (self.traction)(&facet.reference[i], facet.time) * (-facet.reference_measure / D as f64);
            out.add_vector::<D>(facet.row(i), load);
        }
    }
}
