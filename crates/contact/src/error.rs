//! What can be wrong with the description of a contact.

use mesh::{FacetId, VertexId};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter of a law, an obstacle or a form is out of its range. Correct the number.
    #[error("{what} is {value:e}, but must be {must}")]
    Parameter {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must satisfy.
        must: &'static str,
    },
    /// A field does not have the dofs of the body it is said to belong to.
    #[error("the field of the body has {found} dofs, but its positions ask for {expected}")]
    Field {
        /// Dofs of the field.
        found: usize,
        /// Dofs needed.
        expected: usize,
    },
    /// A facet that the boundary does not have.
    #[error("facet {facet} is not among the {n_facets} facets of the boundary")]
    UnknownFacet {
        /// The facet.
        facet: FacetId,
        /// Facets of the boundary.
        n_facets: usize,
    },
    /// A boundary names vertices that have no position.
    #[error("the boundary names vertex {vertex}, but there are positions for {n_positions} vertices only")]
    UnknownVertex {
        /// The vertex.
        vertex: VertexId,
        /// Positions given.
        n_positions: usize,
    },
    /// A deformable obstacle was given without its body or with another one, or a rigid obstacle with a body.
    #[error("a deformable obstacle needs the body whose boundary it is (the master), a rigid one must have none")]
    Master,
    /// Slave and master are the same field; a body cannot be its own obstacle.
    #[error("slave and master are the same body; self-contact is not supported")]
    SelfContact,
}

/// A parameter that must be finite and positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { what, value, must: "positive and finite" })
    }
}

/// A parameter that must be finite and not negative.
pub(crate) fn non_negative(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { what, value, must: "finite and not negative" })
    }
}
