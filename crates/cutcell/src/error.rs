//! Errors of surfaces.

use mesh::{BodyId, FacetId, VertexId};

/// Errors of [`crate::CutMesh::overlay`]. Degenerate positions are not errors; see [`crate::CutReport`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A surface without facets.
    #[error("body {body} has a surface without facets")]
    Empty {
        /// The body.
        body: BodyId,
    },
    /// A coordinate is NaN or infinite.
    #[error("body {body}: vertex {vertex} of facet {facet} has a coordinate that is NaN or infinite")]
    NotFinite {
        /// The body.
        body: BodyId,
        /// The facet.
        facet: FacetId,
        /// The vertex.
        vertex: VertexId,
    },
    /// A coordinate is so large that the round-off of the facet is comparable to the background.
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
    /// The surface is not closed. Every side of a facet must be shared with exactly one other facet.
    #[error("body {body}: the surface is open at facet {facet}, near vertex {vertex} at {point:?}")]
    Open {
        /// The body.
        body: BodyId,
        /// A facet at the hole.
        facet: FacetId,
        /// A vertex at the hole.
        vertex: VertexId,
        /// Where it is.
        point: [f64; 3],
    },
    /// More than two facets share a side.
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
    /// The normals point into the body. Reverse the facets.
    #[error(
        "body {body}: the surface is oriented inwards (it encloses the volume {volume:e}), see facet {facet} at \
         {point:?}; reverse the order of the vertices of all facets"
    )]
    Inward {
        /// The body.
        body: BodyId,
        /// A facet with inward normal.
        facet: FacetId,
        /// A vertex of that facet, the outermost along the first axis.
        point: [f64; 3],
        /// The signed volume.
        volume: f64,
    },
    /// The surface intersects itself.
    #[error("body {body}: the surface intersects itself, facet {other} pierces facet {facet} near {point:?}")]
    SelfIntersection {
        /// The body.
        body: BodyId,
        /// The facet that is pierced.
        facet: FacetId,
        /// The facet that pierces it.
        other: FacetId,
        /// The middle of the piercing side.
        point: [f64; 3],
    },
    /// The text of a [`crate::Capsule`] is malformed.
    #[error("capsule, line {line}: {what}")]
    Capsule {
        /// The line, counted from 1; zero if the error has no line.
        line: usize,
        /// The reason.
        what: String,
    },
}
