//! Dofs and quadrature points on the boundary of the background.

use cutcell::{CutMesh, PartId};
use mesh::{FacetId, MAX_CELL_VERTICES, Point, SimplexMesh, SimplexRule, Tag, Vector, facet_normal};

use crate::XfemSpace;

/// Returns the dofs with a part that touches the tagged boundary, in ascending order. Vertices of the boundary that are
/// covered by a body have no dofs.
pub fn boundary_dofs<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    space: &XfemSpace<D>,
    tag: Tag,
) -> Vec<u32> {
    let mut dofs = Vec::new();
    for piece in cut.boundary().iter().filter(|piece| background.facet_tag(piece.facet) == Some(tag)) {
        let cell = background.cell(cut.part_cell(piece.part));
        for vertex in background.facet(piece.facet) {
            if let Some(local) = cell.iter().position(|v| v == vertex) {
                dofs.push(space.dofs(piece.part)[local]);
            }
        }
    }
    dofs.sort_unstable();
    dofs.dedup();
    dofs
}

/// A quadrature point on the boundary of the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryPoint<const D: usize> {
    /// The boundary face.
    pub facet: FacetId,
    /// The part inside.
    pub part: PartId,
    /// Position.
    pub point: Point<D>,
    /// Unit normal out of the domain.
    pub normal: Vector<D>,
    /// Quadrature weight times the measure of the piece and the weight [`mesh::Coordinates::weight`].
    pub weight: f64,
    /// Shape values; only the first `D + 1` are used.
    pub shape: [f64; MAX_CELL_VERTICES],
}

/// Returns the points of a rule of the given degree on all wet boundary pieces with the tag.
pub fn boundary_points<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    tag: Tag,
    degree: usize,
) -> Vec<BoundaryPoint<D>> {
    let coordinates = background.coordinates();
    let rule = SimplexRule::of_degree(D - 1, degree + coordinates.degree());
    let mut points = Vec::new();
    for piece in cut.boundary().iter().filter(|piece| background.facet_tag(piece.facet) == Some(tag)) {
        let normal = facet_normal(&background.facet_points(piece.facet)[..D]);
        let simplex = background.simplex(cut.part_cell(piece.part));
        for (barycentric, weight) in rule.points().iter().zip(rule.weights()) {
            let point: Point<D> = piece.points[..D].iter().zip(barycentric).map(|(x, l)| x * *l).sum();
            points.push(BoundaryPoint {
                facet: piece.facet,
                part: piece.part,
                point,
                normal,
                weight: weight * piece.measure * coordinates.weight(&point),
                shape: simplex.barycentric(&point).unwrap_or_default(),
            });
        }
    }
    points
}
