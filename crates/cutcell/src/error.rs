//! What makes a surface unfit for cutting.

use mesh::{BodyId, FacetId, VertexId};

/// Errors of [`crate::CutMesh::overlay`]. Degenerate placements are no errors; see [`crate::CutReport`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A surface without facets.
    #[error("body {body} has a surface without facets")]
    Empty {
        /// The body.
        body: BodyId,
    },
    /// A coordinate is NaN or infinite.
    #[error("body {body}: vertex {vertex} of facet {facet} has a coordinate that is not a finite number")]
    NotFinite {
        /// The body.
        body: BodyId,
        /// The facet.
        facet: FacetId,
        /// The vertex.
        vertex: VertexId,
    },
    /// A coordinate is so large that nothing in the background could be told apart from there.
    #[error(
        "body {body}: vertex {vertex} of facet {facet} at {point:?} is too far from the background (beyond {limit:e}): move or scale it"
    )]
    TooFar {
        /// The body.
        body: BodyId,
        /// The facet.
        facet: FacetId,
        /// The vertex.
        vertex: VertexId,
        /// Where it is.
        point: [f64; 3],
        /// Largest coordinate of the background times [`crate::FARTHEST`].
        limit: f64,
    },
    /// The surface has a rim. Close it: every rim of a facet must be shared with one other facet.
    #[error("body {body}: the surface is open at facet {facet}, near vertex {vertex} at {point:?}")]
    Open {
        /// The body.
        body: BodyId,
        /// A facet at the rim.
        facet: FacetId,
        /// A vertex at the rim.
        vertex: VertexId,
        /// Where it is.
        point: [f64; 3],
    },
    /// More than two facets meet in one rim.
    #[error("body {body}: more than two facets meet at facet {facet}, vertex {vertex} at {point:?}")]
    NonManifold {
        /// The body.
        body: BodyId,
        /// One of the facets.
        facet: FacetId,
        /// A vertex they share.
        vertex: VertexId,
        /// Where it is.
        point: [f64; 3],
    },
    /// The normals point into the body. Flip the facets.
    #[error(
        "body {body}: the surface is oriented inwards (it encloses the volume {volume:e}), see facet {facet} at \
         {point:?}; flip its facets"
    )]
    Inward {
        /// The body.
        body: BodyId,
        /// A facet that shows it.
        facet: FacetId,
        /// A vertex of that facet, the outermost along the first axis.
        point: [f64; 3],
        /// The signed volume.
        volume: f64,
    },
    /// The surface runs into itself.
    #[error("body {body}: the surface intersects itself, facet {other} pierces facet {facet} near {point:?}")]
    SelfIntersection {
        /// The body.
        body: BodyId,
        /// The facet that is pierced.
        facet: FacetId,
        /// The facet that pierces it.
        other: FacetId,
        /// The middle of the rim that pierces.
        point: [f64; 3],
    },
    /// The text of a [`crate::Capsule`] is malformed.
    #[error("capsule, line {line}: {what}")]
    Capsule {
        /// The line, from 1; zero if it is no line in particular.
        line: usize,
        /// What is wrong.
        what: String,
    },
}
