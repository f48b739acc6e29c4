//! Loads on parts of the boundary of a body.

use std::sync::Arc;

use algebra::Term;
use body::TimeField;
use mesh::FacetId;

use crate::SolidFacet;
use crate::terms::{FollowerPressure, Traction};

/// A load on facets of the boundary of a body.
#[derive(Clone)]
pub struct Load<const D: usize> {
    /// Name for timings.
    pub name: &'static str,
    /// The facets.
    pub facets: Vec<FacetId>,
    /// Term of the weak form.
    pub term: Arc<dyn Term<SolidFacet<D>> + Send>,
    /// Whether the tangent of the term is constant.
    pub is_linear: bool,
}

impl<const D: usize> Load<D> {
    /// Creates a load that does not follow the motion: force per reference area at a reference position and time.
    pub fn traction(facets: Vec<FacetId>, traction: TimeField<D>) -> Self {
        Self { name: "solid traction", facets, term: Arc::new(Traction { traction }), is_linear: true }
    }

    /// Creates a pressure from outside along the current normal.
    pub fn pressure(facets: Vec<FacetId>, pressure: f64) -> Self {
        Self { name: "solid pressure", facets, term: Arc::new(FollowerPressure { pressure }), is_linear: false }
    }
}
