//! Errors in the description of a contact.

use mesh::{BodyId, FacetId};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// A parameter of a law, an obstacle or a form is out of range.
    #[error(transparent)]
    Parameter(#[from] mesh::ParameterError),
    /// A facet that the boundary does not have.
    #[error("facet {facet} is not among the {n_facets} facets of the boundary")]
    UnknownFacet { facet: FacetId, n_facets: usize },
    /// The obstacle is deformable and its master is missing or another body, or the obstacle is rigid and has a master.
    #[error(
        "a deformable obstacle needs the body to which its boundary belongs (the master); a rigid one must not have any"
    )]
    Master,
    /// A contact names a body that does not exist.
    #[error("body {body} is not among the {n_bodies} bodies of the setup")]
    UnknownBody { body: BodyId, n_bodies: usize },
    /// A body is the master of itself without [`crate::OwnSurface`].
    #[error("slave and master are the same body; contact of a body with itself needs its own surface as the obstacle")]
    SelfContact,
}
