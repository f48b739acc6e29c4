//! Jumps of normal derivatives over faces.

use cutcell::CutMesh;
use mesh::{FacetId, MAX_CELL_VERTICES, SimplexMesh, Vector, facet_normal, simplex_measure};

use crate::{PartValues, XfemSpace};

/// Dofs of the largest pair of neighbouring parts: the vertices of their face and one on either side.
const MAX_FACE_DOFS: usize = MAX_CELL_VERTICES + 1;

/// One pair of parts on one face: P1 functions have a constant jump of the normal derivative over the whole face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceValue<const D: usize> {
    /// The face of the background.
    pub facet: FacetId,
    /// Whether one of the two cells is cut.
    pub is_ghost: bool,
    /// Measure `|F|` of the whole face.
    pub measure: f64,
    /// Diameter `h_F`.
    pub diameter: f64,
    /// Unit normal, out of the first cell.
    pub normal: Vector<D>,
    dofs: [u32; MAX_FACE_DOFS],
    jumps: [f64; MAX_FACE_DOFS],
}

impl<const D: usize> FaceValue<D> {
    /// The `D + 2` dofs of the two parts; the first `D` lie on the face.
    #[inline]
    pub fn dofs(&self) -> &[u32] {
        &self.dofs[..D + 2]
    }

    /// Jump of the normal derivative of the shape function of each dof, first part minus second.
    #[inline]
    pub fn jumps(&self) -> &[f64] {
        &self.jumps[..D + 2]
    }

    /// The `D` dofs on the face.
    #[inline]
    pub fn face_dofs(&self) -> &[u32] {
        &self.dofs[..D]
    }
}

/// All faces between parts, as seen by face terms: once per pair of parts, over the whole face.
#[derive(Clone, Debug)]
pub struct FaceValues<const D: usize> {
    faces: Vec<FaceValue<D>>,
}

impl<const D: usize> FaceValues<D> {
    /// The values on all part faces of a cut.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>, space: &XfemSpace<D>, values: &PartValues<D>) -> Self {
        let faces = cut
            .part_faces()
            .iter()
            .map(|face| {
                let vertices = background.facet(face.facet);
                let mut points = [mesh::Point::<D>::zeros(); MAX_CELL_VERTICES];
                for (slot, v) in points.iter_mut().zip(vertices) {
                    *slot = background.vertex(*v);
                }
                let normal = facet_normal(&points[..D]);
                let mut dofs = [0; MAX_FACE_DOFS];
                let mut jumps = [0.0; MAX_FACE_DOFS];
                for (side, sign) in [(0, 1.0), (1, -1.0)] {
                    let part = face.parts[side];
                    let cell = background.cell(cut.part_cell(part));
                    let gradients = values.gradients(part);
                    for (local, vertex) in cell.iter().enumerate() {
                        let slot = vertices.iter().position(|v| v == vertex).unwrap_or(D + side);
                        dofs[slot] = space.dofs(part)[local];
                        jumps[slot] += sign * gradients[local].dot(&normal);
                    }
                }
                let mut diameter = 0.0_f64;
                for i in 0..D {
                    for j in 0..i {
                        diameter = diameter.max((points[i] - points[j]).norm());
                    }
                }
                FaceValue {
                    facet: face.facet,
                    is_ghost: face.is_ghost,
                    measure: simplex_measure(&points[..D]),
                    diameter,
                    normal,
                    dofs,
                    jumps,
                }
            })
            .collect();
        Self { faces }
    }

    /// The faces in order.
    pub fn as_slice(&self) -> &[FaceValue<D>] {
        &self.faces
    }
}
