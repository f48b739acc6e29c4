//! Errors of meshes.

use crate::{CellId, FacetId, ParameterError, VertexId};

/// Errors of mesh construction and generation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// The length of the connectivity is not a multiple of the vertices per cell.
    #[error("the connectivity has {length} entries, but must have a multiple of {stride}, the vertices per cell")]
    Stride {
        /// Entries given.
        length: usize,
        stride: usize,
    },
    /// The mesh has no cells.
    #[error("the mesh has no cells")]
    Empty,
    /// A cell has a vertex that does not exist.
    #[error("cell {cell} has vertex {vertex}, but the mesh has only {n_vertices} vertices")]
    UnknownVertex { cell: CellId, vertex: VertexId, n_vertices: usize },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is NaN or infinite")]
    NotFinite { vertex: VertexId },
    /// A cell has no volume or is inverted.
    #[error("cell {cell} has volume {volume:e}, but it must be positive (reorder its vertices)")]
    Orientation {
        cell: CellId,
        /// Its signed volume.
        volume: f64,
    },
    /// Axisymmetric coordinates with a vertex on the wrong side of the axis.
    #[error(
        "vertex {vertex} has the radius {radius:e}, but axisymmetric coordinates need radii of zero and more (the first coordinate)"
    )]
    BehindAxis {
        vertex: VertexId,
        /// Its radius.
        radius: f64,
    },
    /// Axisymmetric coordinates in space.
    #[error("axisymmetric coordinates need a mesh in the plane, this one is in space")]
    AxisInSpace,
    /// More than two cells share a facet.
    #[error("facet {facet} is shared by more than two cells ({cells:?} and another one)")]
    NonManifold {
        facet: FacetId,
        /// Two of the cells.
        cells: [CellId; 2],
    },
    /// A parameter of a generator is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The triangulation failed.
    #[error("cannot triangulate: {reason}")]
    Triangulation { reason: String },
    /// The shape has no generator in this dimension.
    #[error("there is no generator for {shape} in dimension {dimension}")]
    Dimension { shape: &'static str, dimension: usize },
}
