//! Errors in the description of a solid.

use mesh::{CellId, FacetId, VertexId};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// A parameter of a material, a load or a time step is out of range.
    #[error(transparent)]
    Parameter(#[from] mesh::ParameterError),
    /// A cell is so thin, or its edges are so curved, that its map from the reference simplex has no inverse. Improve
    /// the mesh.
    #[error("cell {cell} is degenerate: its shape functions have no gradients")]
    DegenerateCell { cell: CellId },
    /// A vertex or node that the mesh does not have.
    #[error("vertex {vertex} is not among the {n_vertices} nodes of the mesh")]
    UnknownVertex { vertex: VertexId, n_vertices: usize },
    /// Masses of elements of order 2 cannot be lumped: those of their vertices are zero or negative.
    #[error("masses are redistributed for elements of order 1 only")]
    MassOfOrder,
    /// A node without mass that has no node with mass near it. Leave the mass of some nodes inside of the body, or
    /// refine the mesh.
    #[error("vertex {vertex} is not near any node that keeps its mass")]
    NoMassNear { vertex: VertexId },
    /// A list of groups that does not belong to the mesh.
    #[error("{found} cells have a group, but the mesh has {n_cells} cells")]
    Groups {
        /// Entries of the list.
        found: usize,
        n_cells: usize,
    },
    /// A group of cells without density and material. Give the form one of each for every group.
    #[error("the mesh has {n_groups} groups of cells, but only {found} have a material")]
    MissingMaterial { found: usize, n_groups: usize },
    /// A facet that the boundary does not have.
    #[error("facet {facet} is not among the {n_facets} facets of the boundary")]
    UnknownFacet { facet: FacetId, n_facets: usize },
    /// A part of the boundary that the mesh does not have. Check the spelling against `SimplexMesh::tag_names`.
    #[error("the mesh has no boundary part \"{name}\"")]
    UnknownTag { name: String },
}
