//! What can be wrong with the description of a solid.

use mesh::{CellId, FacetId};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter of a material, a load or a time step is out of its range. Correct the number.
    #[error("{what} is {value:e}, but must be {must}")]
    Parameter {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must satisfy.
        must: &'static str,
    },
    /// A cell is so thin that the gradients of its shape functions are not finite. Improve the mesh.
    #[error("cell {cell} is degenerate: its shape functions have no gradients")]
    DegenerateCell {
        /// The cell.
        cell: CellId,
    },
    /// A list of values does not match the number of vertices, or a field the number of its dofs.
    #[error("{what} has {found} entries, but {expected} are needed")]
    Length {
        /// The list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
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
    /// A part of the boundary that the mesh does not have. Check the spelling against `SimplexMesh::tag_names`.
    #[error("the mesh has no boundary part \"{name}\"")]
    UnknownTag {
        /// The name.
        name: String,
    },
}

/// A parameter that must be finite and positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { what, value, must: "positive and finite" })
    }
}

/// A list that must have a given length.
pub(crate) fn length(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { what, found, expected }) }
}
