//! Errors of surfaces.

use mesh::{BodyId, FacetId, ParameterError, VertexId};

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
    /// A facet has a vertex without a position.
    #[error("body {body}: facet {facet} has the vertex {vertex}, but there are {n_positions} positions")]
    MissingPosition {
        body: BodyId,
        facet: FacetId,
        vertex: VertexId,
        /// Number of positions of the surface.
        n_positions: usize,
    },
    /// The surface is not closed. Every side of a facet must be shared with exactly one other facet.
    #[error(
        "body {}: the surface is open at facet {}, near vertex {} at {:?}{}",
        .at.body, .at.facet, .at.vertex, .at.point, same_place(*.twin)
    )]
    Open {
        /// A vertex of a facet at the hole.
        at: SurfaceVertex,
        /// Another vertex with the same position. Facets are neighbours only if they have vertices in common.
        twin: Option<VertexId>,
    },
    /// A facet and its neighbour are oriented differently. Reverse the order of the vertices of one of them.
    #[error(
        "body {}: facet {} is not oriented as its neighbour at vertex {} at {:?}; reverse the order of the vertices of one of them",
        .at.body, .at.facet, .at.vertex, .at.point
    )]
    Turned {
        /// One of the facets, and a vertex that both have.
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
    /// A number of the options is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
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

/// Returns the cause of a hole where two vertices have one position.
fn same_place(twin: Option<VertexId>) -> String {
    let cause = |twin| {
        format!("; vertex {twin} has the same position: facets are neighbours only if they refer to the same vertex")
    };
    twin.map(cause).unwrap_or_default()
}
