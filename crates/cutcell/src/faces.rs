//! Connection of parts on the faces of the background.

use mesh::{CellId, FacetId, Point, Vector, simplex_measure};

use crate::cell::{CellCut, FaceView, Kept};
use crate::clip::{FacePoints, face_difference, face_overlap};
use crate::cut_mesh::{for_each_face_simplex, measure};
use crate::cutting::Cutting;
use crate::exact::Plane;
use crate::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};

/// The faces of the background with the cells that were cut.
pub(crate) struct Faces<'a, const D: usize> {
    cutting: &'a Cutting<'a, D>,
    /// Faces of the touched cells, as seen from them.
    views: Vec<[FaceView; 4]>,
}

impl<'a, const D: usize> Faces<'a, D> {
    /// Collects the faces of the touched cells.
    pub(crate) fn new(cutting: &'a Cutting<'a, D>, kept: &[&Kept<D>]) -> Self {
        let views = kept.iter().flat_map(|kept| kept.cells.iter().map(|cell| cell.faces)).collect();
        Self { cutting, views }
    }

    /// Adds part faces, wet boundary, and the interface on faces. Where needed, cells are cut again in `sides`.
    pub(crate) fn add_to(&self, cut: &mut CutMesh<D>, sides: &mut [CellCut<D>; 2]) {
        let n_inside = cut.interface.len();
        self.add_faces(cut, sides);
        let mut aligned: Vec<_> = cut.interface[n_inside..].iter().map(|piece| (piece.body, piece.facet)).collect();
        cut.report.n_aligned_pieces = aligned.len();
        aligned.sort_unstable();
        aligned.dedup();
        cut.report.n_aligned_facets = aligned.len();
        // Restores the order of cells, since these pieces were added face by face.
        if cut.report.n_aligned_pieces > 0 {
            cut.interface.sort_by_key(|piece| (piece.cell, piece.body, piece.facet));
        }
    }

    fn add_faces(&self, cut: &mut CutMesh<D>, sides: &mut [CellCut<D>; 2]) {
        let background = self.cutting.planes.background;
        for facet in background.facets() {
            let [first, second] = background.facet_to_cell(facet);
            let Some(first) = first else { continue };
            let Some(second) = second else {
                self.add_boundary(cut, facet, first, &mut sides[0]);
                continue;
            };
            let cells = [first, second];
            if cells.iter().all(|&cell| self.cutting.touched.position(cell).is_none()) {
                self.add_untouched(cut, facet, cells);
                continue;
            }
            match cells.map(|cell| self.view(cut, cell, facet)) {
                [FaceView::Dry, FaceView::Dry] => {}
                // Without facets on the face, the single parts on its two sides share the whole face.
                [FaceView::Wet(a, measure), FaceView::Wet(b, _)] => {
                    let parts = [PartId(a), PartId(b)];
                    cut.part_faces.push(PartFace { facet, parts, measure, is_ghost: is_ghost(cut, cells) });
                }
                _ => self.join(cut, facet, cells, sides),
            }
        }
    }

    /// Adds a face between untouched cells, which is wet or dry as a whole.
    fn add_untouched(&self, cut: &mut CutMesh<D>, facet: FacetId, cells: [CellId; 2]) {
        if cells.iter().all(|&cell| cut.cell_state(cell) == CellState::Fluid) {
            let parts = cells.map(|cell| PartId(cut.cell_to_part[cell.index()]));
            let measure = self.cutting.planes.background.facet_measure(facet);
            cut.part_faces.push(PartFace { facet, parts, measure, is_ghost: false });
        }
    }

    /// Returns a face as seen from a cell, with the global index of the part.
    fn view(&self, cut: &CutMesh<D>, cell: CellId, facet: FacetId) -> FaceView {
        let background = self.cutting.planes.background;
        let first_part = cut.cell_to_part[cell.index()];
        match (self.cutting.touched.position(cell), cut.cell_state(cell)) {
            (Some(k), _) => match self.views[k][self.local(cell, facet)] {
                FaceView::Wet(part, measure) => FaceView::Wet(first_part + part, measure),
                other => other,
            },
            (None, CellState::Fluid) => FaceView::Wet(first_part, background.facet_measure(facet)),
            (None, _) => FaceView::Dry,
        }
    }

    /// Returns the local number of a face in one of its cells.
    fn local(&self, cell: CellId, facet: FacetId) -> usize {
        self.cutting.planes.background.cell_to_facet(cell).iter().position(|&f| f == facet).unwrap_or(0)
    }

    /// Cuts the cell on one side of a face again.
    fn cut_side(&self, cut: &CutMesh<D>, cell: CellId, side: &mut CellCut<D>) {
        match self.cutting.touched.position(cell) {
            Some(k) => side.cut(self.cutting, k),
            None => side.set_whole(&self.cutting.planes, cell, cut.cell_state(cell) == CellState::Fluid),
        }
    }

    fn add_boundary(&self, cut: &mut CutMesh<D>, facet: FacetId, cell: CellId, side: &mut CellCut<D>) {
        match (self.view(cut, cell, facet), cut.cell_state(cell)) {
            (FaceView::Dry, _) => {}
            (FaceView::Wet(part, _), CellState::Fluid) => {
                add_wet_boundary(cut, facet, PartId(part), &self.cutting.planes.background.facet_points(facet)[..D]);
            }
            _ => {
                self.cut_side(cut, cell, side);
                let first_part = cut.cell_to_part[cell.index()];
                for (leaf, face) in side.faces(Plane::mesh(facet)) {
                    if let Some(part) = side.fluid_part(leaf) {
                        let polygon: FacePoints<D> = face.map(|side| side.corner.x).collect();
                        add_wet_boundary(cut, facet, PartId(first_part + part), &polygon);
                    }
                }
            }
        }
    }

    /// Intersects the pieces of an interior face on its two sides: fluid on both sides connects two parts, fluid on one
    /// side is interface.
    fn join(&self, cut: &mut CutMesh<D>, facet: FacetId, cells: [CellId; 2], sides: &mut [CellCut<D>; 2]) {
        cells.iter().zip(sides.iter_mut()).for_each(|(&cell, side)| self.cut_side(cut, cell, side));
        let first_parts = cells.map(|cell| cut.cell_to_part[cell.index()]);
        let plane = Plane::mesh(facet);
        let [first, second] = sides;
        let mut pairs: Vec<([Option<PartId>; 2], FacePoints<D>)> = Vec::new();
        for (leaf, face) in first.faces(plane) {
            let part = first.fluid_part(leaf).map(|part| PartId(first_parts[0] + part));
            second.locate(&self.cutting.planes, plane, face, |polygon, other| {
                let other = other.map(|part| PartId(first_parts[1] + part));
                pairs.push(([part, other], polygon));
            });
        }
        let face = SharedFace {
            facet,
            cells,
            normal: mesh::facet_normal(&self.cutting.planes.background.facet_points(facet)[..D]),
            is_ghost: is_ghost(cut, cells),
            first: cut.part_faces.len(),
        };
        for (parts, polygon) in pairs {
            match parts {
                [Some(first), Some(second)] => face.add(cut, [first, second], measure(&polygon)),
                [Some(part), None] => self.add_interface(cut, &face, &sides[1], 0, part, &polygon),
                [None, Some(part)] => self.add_interface(cut, &face, &sides[0], 1, part, &polygon),
                [None, None] => {}
            }
        }
    }

    /// Adds interface on a face of the background. On one side (`side`) is fluid, on the other (`beyond`) a body, or a
    /// layer too thin to be kept.
    fn add_interface(
        &self,
        cut: &mut CutMesh<D>,
        face: &SharedFace<D>,
        beyond: &CellCut<D>,
        side: usize,
        part: PartId,
        polygon: &[Point<D>],
    ) {
        let normal = if side == 0 { -face.normal } else { face.normal };
        let &Cutting { planes, touched, thinnest: tolerance, .. } = self.cutting;
        let touching = face.cells.iter().filter_map(|&cell| touched.position(cell));
        let mut aligned: Vec<u32> = touching.flat_map(|k| touched.facets(k).iter().copied()).collect();
        aligned.sort_unstable();
        aligned.dedup();
        aligned.retain(|&f| planes.lies_on(f, Plane::mesh(face.facet)));
        let on_face = aligned.iter().map(|&f| (f, FacePoints::from_slice(planes.facets[f as usize].points())));
        let candidates = on_face.chain(beyond.thin());
        let mut rest = vec![polygon.to_vec()];
        let mut overlap = Vec::new();
        for (index, by) in candidates {
            let facet = &planes.facets[index as usize];
            let is_near = |x: &Point<D>| normal.dot(&(x - polygon[0])).abs() <= REACH * tolerance;
            if facet.normal.dot(&normal) <= 0.0 || !by.iter().all(is_near) {
                continue;
            }
            let mut left = Vec::new();
            for polygon in rest {
                if face_overlap(&polygon, &by, &normal, tolerance, &mut overlap) > 0.0 {
                    let corners: Vec<_> = overlap.iter().map(|&x| facet.point(x)).collect();
                    InterfacePiece::push_fan(face.cells[side], part, facet, &corners, &mut cut.interface);
                    face_difference(&polygon, &by, &normal, tolerance, &mut left);
                } else {
                    left.push(polygon);
                }
            }
            rest = left;
        }
        cut.report.uncovered_measure += rest.iter().map(|polygon| measure(polygon)).sum::<f64>();
    }
}

/// Largest distance from a face of a facet behind a layer that is left out, in units of the tolerance. A layer may be
/// thicker at one end.
const REACH: f64 = 16.0;

/// An interior face of the background, with the parts on its two sides.
struct SharedFace<const D: usize> {
    facet: FacetId,
    cells: [CellId; 2],
    /// Unit normal, out of the first cell.
    normal: Vector<D>,
    is_ghost: bool,
    /// Index of the first part face on this face.
    first: usize,
}

impl<const D: usize> SharedFace<D> {
    /// Adds to the measure that two parts share.
    fn add(&self, cut: &mut CutMesh<D>, parts: [PartId; 2], measure: f64) {
        match cut.part_faces[self.first..].iter_mut().find(|face| face.parts == parts) {
            Some(face) => face.measure += measure,
            None => cut.part_faces.push(PartFace { facet: self.facet, parts, measure, is_ghost: self.is_ghost }),
        }
    }
}

fn is_ghost<const D: usize>(cut: &CutMesh<D>, cells: [CellId; 2]) -> bool {
    cells.iter().any(|&cell| cut.cell_state(cell) == CellState::Cut)
}

fn add_wet_boundary<const D: usize>(cut: &mut CutMesh<D>, facet: FacetId, part: PartId, polygon: &[Point<D>]) {
    for_each_face_simplex(polygon, |points| {
        let measure = simplex_measure(&points[..D]);
        cut.boundary.push(BoundaryPiece { facet, part, points, measure });
    });
}
