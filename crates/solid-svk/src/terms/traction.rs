//! Dead load on a part of the boundary.

use algebra::{LocalSystem, Term};
use body::TimeField;

use crate::SolidFacet;
use crate::cell::row;

/// `-(t, w)_{Γ̂}`, with a traction `t` per reference area that does not follow the motion
///
/// Source: paper, Eq. (4), Neumann data of the structure on the reference configuration.
/// Couples: solid velocity.   Domain: given boundary facets, reference configuration.
/// Units: force (2D: per unit depth).
/// With the reference area w of a quadrature point X:
///   residual_i = -w N_i t(X),    tangent = 0.
pub struct Traction<const D: usize> {
    /// Force per reference area at a reference position and time.
    pub traction: TimeField<D>,
}

impl<const D: usize> Term<SolidFacet<D>> for Traction<D> {
    #[inline]
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem) {
        let load = (self.traction)(&facet.reference, facet.time) * -facet.reference_weight;
        for i in facet.nodes() {
            out.add_vector::<D>(row::<D>(i), load * facet.shape.values[i]);
        }
    }
}
