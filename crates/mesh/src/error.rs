//! What can be wrong with a mesh.

use crate::{CellId, FacetId, VertexId};

/// Errors of mesh construction and generation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The connectivity is not a whole number of cells.
    #[error("connectivity has {length} entries, which is no multiple of {stride} vertices per cell")]
    Stride {
        /// Entries given.
        length: usize,
        /// Vertices per cell.
        stride: usize,
    },
    /// A mesh without cells.
    #[error("the mesh has no cells")]
    Empty,
    /// A cell names a vertex that is not there.
    #[error("cell {cell} names vertex {vertex}, but there are only {n_vertices} vertices")]
    UnknownVertex {
        /// The cell.
        cell: CellId,
        /// The vertex it names.
        vertex: VertexId,
        /// Vertices in the mesh.
        n_vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// A cell without volume, or turned inside out. Reorder its vertices.
    #[error("cell {cell} has volume {volume:e}; cells need positive volume (reorder its vertices)")]
    Orientation {
        /// The cell.
        cell: CellId,
        /// Its signed volume.
        volume: f64,
    },
    /// Three or more cells share a facet.
    #[error("facet {facet} is shared by more than two cells ({cells:?} and another)")]
    NonManifold {
        /// The facet.
        facet: FacetId,
        /// Two of the cells.
        cells: [CellId; 2],
    },
    /// A generator was asked for a shape or size that makes no sense.
    #[error("cannot generate a mesh: {what} is {value}, but must {must}")]
    Generate {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must satisfy.
        must: &'static str,
    },
    /// The triangulation failed.
    #[error("cannot triangulate: {reason}")]
    Triangulation {
        /// The reason given by the triangulator.
        reason: String,
    },
    /// A generator that is not there in this dimension.
    #[error("there is no generator for {shape} in dimension {dimension}")]
    Dimension {
        /// The shape.
        shape: &'static str,
        /// The dimension asked for.
        dimension: usize,
    },
}
