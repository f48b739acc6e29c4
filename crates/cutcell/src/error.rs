//! Errors of surfaces.

use mesh::{BodyId, FacetId, VertexId};

/// Errors of [`crate::CutMesh::overlay`]. Degenerate positions are not errors; see [`crate::CutReport`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// A surface without facets.
    #[error("body {body} has a surface without facets")]
    Empty { body: BodyId },
    /// A coordinate is NaN or infinite.
    #[error("body {}: vertex {} of facet {} has a coordinate that is NaN or infinite", .at.body, .at.vertex, .at.facet)]
    NotFinite { at: SurfaceVertex },
    /// A coordinate is so large that the round-off of the facet is comparable to the background.
    #[error(
        "body {}: vertex {} of facet {} at {:?} is too far from the background (beyond {limit:e}): move or scale it",
        .at.body, .at.vertex, .at.facet, .at.point
    )]
    TooFar {
        at: SurfaceVertex,
        /// Largest coordinate of the background times [`crate::FARTHEST`].
        limit: f64,
    },
    /// The surface is not closed. Every side of a facet must be shared with exactly one other facet.
    #[error(
        "body {}: the surface is open at facet {}, near vertex {} at {:?}",
        .at.body, .at.facet, .at.vertex, .at.point
    )]
    Open {
        /// A vertex of a facet at the hole.
        at: SurfaceVertex,
    },
    /// More than two facets share a side.
    #[error(
        "body {}: more than two facets meet at facet {}, vertex {} at {:?}",
        .at.body, .at.facet, .at.vertex, .at.point
    )]
    NonManifold {
        /// A vertex that they share, and one of the facets.
        at: SurfaceVertex,
    },
    /// The normals point into the body. Reverse the facets.
    #[error(
        "body {body}: the surface is oriented inwards (it encloses the volume {volume:e}), see facet {facet} at \
         {point:?}; reverse the order of the vertices of all facets"
    )]
    Inward {
        body: BodyId,
        /// A facet with inward normal.
        facet: FacetId,
        /// A vertex of that facet, the outermost along the first axis.
        point: [f64; 3],
        /// The signed volume.
        volume: f64,
    },
    /// A connected part of a surface is oriented inwards, but is not a hole in the body.
    #[error(
        "body {body}: a part of the surface is oriented inwards (it encloses the volume {volume:e}) and is not a hole, because it \
         lies outside of the other parts, see facet {facet} at {point:?}; move it into the body, or reverse the order of the vertices of its facets"
    )]
    InwardPart {
        body: BodyId,
        /// A facet of the part with inward normal.
        facet: FacetId,
        /// A vertex of that facet, the outermost along the first axis.
        point: [f64; 3],
        /// The signed volume of the part.
        volume: f64,
    },
    /// The surface intersects itself.
    #[error("body {body}: the surface intersects itself, facet {other} pierces facet {facet} near {point:?}")]
    SelfIntersection {
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
        what: String,
    },
}

/// A vertex of a facet of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceVertex {
    /// The body.
    pub body: BodyId,
    /// The facet.
    pub facet: FacetId,
    /// The vertex.
    pub vertex: VertexId,
    /// Position.
    pub point: [f64; 3],
}
