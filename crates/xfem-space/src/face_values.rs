//! Jumps of normal derivatives over faces.

use cutcell::{CellState, CutMesh, PartFace, PartId};
use mesh::{
    FacetId, MAX_CELL_VERTICES, SimplexMesh, Tag, Tensor, Vector, diameter, facet_normal, mean, simplex_measure,
};

use crate::{PartValues, XfemSpace};

/// Dofs of the largest pair of neighbouring parts: the vertices of their face and one on either side.
const MAX_FACE_DOFS: usize = MAX_CELL_VERTICES + 1;

/// One pair of parts on one face: P1 functions have a constant jump of the normal derivative over the whole face.
///
/// A face on a symmetry plane pairs a part with its own mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceValue<const D: usize> {
    /// The face of the background.
    pub facet: FacetId,
    /// The two parts; twice the same one on a symmetry plane.
    pub parts: [PartId; 2],
    /// Whether one of the two cells is cut.
    pub is_ghost: bool,
    /// Measure `|F|` of the whole face.
    pub measure: f64,
    /// `∫_F 1` with the weight [`mesh::Coordinates::weight`]; the measure in Cartesian coordinates.
    pub weight: f64,
    /// Diameter `h_F`.
    pub diameter: f64,
    /// Unit normal, out of the first cell.
    pub normal: Vector<D>,
    /// Share of the face's integral that belongs to this domain: one, or a half on a symmetry plane.
    pub share: f64,
    /// Unit normal of a symmetry plane; `None` on other faces. The normal component of a vector changes its sign in the
    /// mirror image, so that its normal derivative has no jump.
    pub odd: Option<Vector<D>>,
    n_dofs: usize,
    dofs: [u32; MAX_FACE_DOFS],
    jumps: [f64; MAX_FACE_DOFS],
}

impl<const D: usize> FaceValue<D> {
    /// Returns the `D + 2` dofs of the two parts (`D + 1` on a symmetry plane); the first `D` lie on the face.
    #[inline]
    pub fn dofs(&self) -> &[u32] {
        &self.dofs[..self.n_dofs]
    }

    /// Returns the jump of the normal derivative of the shape function of each dof, first part minus second.
    #[inline]
    pub fn jumps(&self) -> &[f64] {
        &self.jumps[..self.n_dofs]
    }

    /// Returns the projection on the components that may have a jump: those along a symmetry plane, or all.
    pub fn along_plane(&self) -> Tensor<D> {
        Tensor::identity() - self.odd.map_or(Tensor::zeros(), |normal| normal * normal.transpose())
    }

    /// Returns the `D` dofs on the face.
    #[inline]
    pub fn face_dofs(&self) -> &[u32] {
        &self.dofs[..D]
    }

    fn new(background: &SimplexMesh<D>, facet: FacetId, parts: [PartId; 2], is_ghost: bool) -> Self {
        let points = &background.facet_points(facet)[..D];
        let (measure, coordinates) = (simplex_measure(points), background.coordinates());
        Self {
            facet,
            parts,
            is_ghost,
            measure,
            // The weight of the coordinates is linear: its mean is the value in the middle.
            weight: measure * coordinates.weight(&mean(points)),
            diameter: diameter(points),
            normal: facet_normal(points),
            share: 1.0,
            odd: None,
            n_dofs: D + 2,
            dofs: [0; MAX_FACE_DOFS],
            jumps: [0.0; MAX_FACE_DOFS],
        }
    }

    /// Adds the normal derivatives of a part, times `sign`; the dof off the face goes to the slot `opposite`.
    fn add_side(&mut self, parts: Parts<'_, D>, part: PartId, opposite: usize, sign: f64) {
        let (on_face, vertices) =
            (parts.background.facet(self.facet), parts.background.cell(parts.cut.part_cell(part)));
        let (dofs, gradients) = (parts.space.dofs(part), parts.values.gradients(part));
        for (local, vertex) in vertices.iter().enumerate() {
            let slot = on_face.iter().position(|v| v == vertex).unwrap_or(opposite);
            self.dofs[slot] = dofs[local];
            self.jumps[slot] += sign * gradients[local].dot(&self.normal);
        }
    }
}

/// The parts of a cut with their dofs and values.
#[derive(Clone, Copy)]
struct Parts<'a, const D: usize> {
    background: &'a SimplexMesh<D>,
    cut: &'a CutMesh<D>,
    space: &'a XfemSpace<D>,
    values: &'a PartValues<D>,
}

/// Returns the values on all part faces of a cut: once per pair of parts, over the whole face.
pub fn face_values<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    space: &XfemSpace<D>,
    values: &PartValues<D>,
) -> Vec<FaceValue<D>> {
    let parts = Parts { background, cut, space, values };
    let value = |face: &PartFace| {
        let mut value = FaceValue::new(background, face.facet, face.parts, face.is_ghost);
        value.add_side(parts, face.parts[0], D, 1.0);
        value.add_side(parts, face.parts[1], D + 1, -1.0);
        value
    };
    cut.part_faces().iter().map(value).collect()
}

/// Returns the values on the tagged symmetry plane with a unit normal. Jumps between the domain and its mirror image
/// are penalised as on any interior face.
pub fn symmetry_values<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    space: &XfemSpace<D>,
    values: &PartValues<D>,
    tag: Tag,
    normal: Vector<D>,
) -> Vec<FaceValue<D>> {
    let mut faces = Vec::new();
    let mut of_face: Vec<(FacetId, PartId)> = Vec::new();
    for piece in cut.boundary().iter().filter(|piece| background.facet_tag(piece.facet) == Some(tag)) {
        // The pieces of one face follow each other, in any order of parts.
        of_face.retain(|(facet, _)| *facet == piece.facet);
        if of_face.contains(&(piece.facet, piece.part)) {
            continue;
        }
        of_face.push((piece.facet, piece.part));
        let is_ghost = cut.cell_state(cut.part_cell(piece.part)) == CellState::Cut;
        let mut value = FaceValue::new(background, piece.facet, [piece.part; 2], is_ghost);
        value.share = 0.5;
        value.odd = Some(normal);
        value.n_dofs = D + 1;
        // The mirror image has the opposite normal derivative.
        value.add_side(Parts { background, cut, space, values }, piece.part, D, 2.0);
        faces.push(value);
    }
    faces
}
