//! A quadrature point of an interface piece with its shape values.

use mesh::{MAX_CELL_VERTICES, MAX_FACET_NODES, Point};

/// A quadrature point of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePoint<const D: usize> {
    /// Position.
    pub point: Point<D>,
    /// Weight of the rule times the measure of the piece.
    pub measure: f64,
    /// Quadrature weight: `measure` times [`mesh::Coordinates::weight`] (1, or `2π r` with rotational symmetry).
    pub weight: f64,
    /// Shape values of the fluid part; only the first `D + 1` are used.
    pub fluid: [f64; MAX_CELL_VERTICES],
    /// Barycentric coordinates in the facet of the body.
    pub in_facet: [f64; D],
    /// Shape values of the nodes of the body on the facet ([`mesh::BoundaryMesh::nodes`]); the others are zero.
    pub solid: [f64; MAX_FACET_NODES],
}
