//! How the parts of neighbouring cells meet on the faces of the background.

use mesh::{CellId, FacetId, Point, Vector, simplex_measure};

use crate::cell::{CellCut, FaceView};
use crate::clip::{Points, Polygon, face_difference, face_overlap};
use crate::cut_mesh::{for_each_face_simplex, measure};
use crate::exact::Plane;
use crate::overlay::Cutting;
use crate::tree::whole_cell;
use crate::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};

/// The faces of the background with the cells that were cut.
pub(crate) struct Faces<'a, const D: usize> {
    pub(crate) cutting: Cutting<'a, D>,
    /// Faces of the touched cells.
    pub(crate) views: &'a [[FaceView; 4]],
}

/// A cell on one side of a face, cut again.
enum Side<const D: usize> {
    /// In one piece that no facet touches.
    Whole(Option<PartId>),
    /// Cut, with the number of its first part.
    Cut(CellCut<D>, u32),
}

impl<const D: usize> Side<D> {
    fn part(&self, leaf: usize) -> Option<PartId> {
        match self {
            Self::Whole(part) => *part,
            Self::Cut(cut, first) => cut.fluid_part(leaf).map(|part| PartId(first + part)),
        }
    }
}

impl<const D: usize> Faces<'_, D> {
    /// Adds part faces, wet boundary, and the interface on faces.
    pub(crate) fn add_to(&self, cut: &mut CutMesh<D>) {
        let n_inside = cut.interface.len();
        self.add_faces(cut);
        let mut aligned: Vec<_> = cut.interface[n_inside..].iter().map(|piece| (piece.body, piece.facet)).collect();
        cut.report.n_aligned_pieces = aligned.len();
        aligned.sort_unstable();
        aligned.dedup();
        cut.report.n_aligned_facets = aligned.len();
    }

    fn add_faces(&self, cut: &mut CutMesh<D>) {
        let background = self.cutting.planes.background;
        for facet in background.facets() {
            let [first, second] = background.facet_to_cell(facet);
            let Some(first) = first else { continue };
            let Some(second) = second else {
                self.add_boundary(cut, facet, first);
                continue;
            };
            if self.is_untouched(first) && self.is_untouched(second) {
                if let (CellState::Fluid, CellState::Fluid) = (cut.cell_state(first), cut.cell_state(second)) {
                    let parts = [first, second].map(|cell| PartId(cut.cell_to_part[cell.index()]));
                    let measure = simplex_measure(&self.points(facet)[..D]);
                    cut.part_faces.push(PartFace { facet, parts, measure, is_ghost: false });
                }
                continue;
            }
            match [first, second].map(|cell| self.view(cut, cell, facet)) {
                [FaceView::Dry, FaceView::Dry] => {}
                // Without facets on the face, two single parts share all of it.
                [FaceView::Wet(a, measure), FaceView::Wet(b, _)] => {
                    let parts = [PartId(a), PartId(b)];
                    let is_ghost = self.is_ghost(cut, [first, second]);
                    cut.part_faces.push(PartFace { facet, parts, measure, is_ghost });
                }
                _ => self.join(cut, facet, [first, second]),
            }
        }
    }

    fn is_untouched(&self, cell: CellId) -> bool {
        self.cutting.touched.position(cell).is_none()
    }

    /// A face as seen from a cell, with the part numbered among all.
    fn view(&self, cut: &CutMesh<D>, cell: CellId, facet: FacetId) -> FaceView {
        let first_part = cut.cell_to_part[cell.index()];
        match (self.cutting.touched.position(cell), cut.cell_state(cell)) {
            (Some(k), _) => {
                let ids = self.cutting.planes.background.cell_to_facet(cell);
                let local = ids.iter().position(|&f| f == facet).unwrap_or(0);
                match self.views[k][local] {
                    FaceView::Wet(part, measure) => FaceView::Wet(first_part + part, measure),
                    other => other,
                }
            }
            (None, CellState::Fluid) => FaceView::Wet(first_part, simplex_measure(&self.points(facet)[..D])),
            (None, _) => FaceView::Dry,
        }
    }

    fn is_ghost(&self, cut: &CutMesh<D>, cells: [CellId; 2]) -> bool {
        cells.iter().any(|&cell| cut.cell_state(cell) == CellState::Cut)
    }

    fn points(&self, facet: FacetId) -> [Point<D>; 3] {
        let background = self.cutting.planes.background;
        let mut points = [Point::zeros(); 3];
        for (slot, &v) in points.iter_mut().zip(background.facet(facet)) {
            *slot = background.vertex(v);
        }
        points
    }

    /// One side of a face with all its pieces.
    fn side(&self, cut: &CutMesh<D>, cell: CellId) -> Side<D> {
        match self.cutting.touched.position(cell) {
            Some(k) => Side::Cut(self.cutting.cut(k), cut.cell_to_part[cell.index()]),
            None => Side::Whole(cut.parts(cell).next()),
        }
    }

    /// The pieces of a face of the background as seen from one of its cells; no part means body.
    fn fragments(&self, facet: FacetId, cell: CellId, side: &Side<D>) -> Vec<(Option<PartId>, Polygon<D>)> {
        match side {
            Side::Cut(from, _) => {
                from.faces(Plane::mesh(facet)).map(|(leaf, polygon)| (side.part(leaf), polygon)).collect()
            }
            Side::Whole(part) => {
                let local = self.cutting.planes.background.cell_to_facet(cell).iter().position(|&f| f == facet);
                vec![(*part, whole_cell(&self.cutting.planes, cell).face(local.unwrap_or(0)))]
            }
        }
    }

    fn add_boundary(&self, cut: &mut CutMesh<D>, facet: FacetId, cell: CellId) {
        let fragments = match (self.view(cut, cell, facet), cut.cell_state(cell)) {
            (FaceView::Dry, _) => return,
            (FaceView::Wet(part, _), CellState::Fluid) => {
                vec![(Some(PartId(part)), Points::from_slice(&self.points(facet)[..D]))]
            }
            _ => {
                let fragments = self.fragments(facet, cell, &self.side(cut, cell));
                fragments.into_iter().map(|(part, polygon)| (part, polygon.points())).collect()
            }
        };
        for (part, polygon) in fragments {
            let Some(part) = part else { continue };
            for_each_face_simplex(&polygon, |points| {
                let measure = simplex_measure(&points[..D]);
                cut.boundary.push(BoundaryPiece { facet, part, points, measure });
            });
        }
    }

    /// Pairs the pieces of an interior face seen from its two cells: fluid on both sides joins two parts, fluid on one
    /// side is interface.
    fn join(&self, cut: &mut CutMesh<D>, facet: FacetId, cells: [CellId; 2]) {
        let sides = cells.map(|cell| self.side(cut, cell));
        let mut pairs: Vec<([Option<PartId>; 2], Points<D>)> = Vec::new();
        for (first, polygon) in self.fragments(facet, cells[0], &sides[0]) {
            match &sides[1] {
                Side::Cut(from, _) => from.tree.locate(&self.cutting.planes, polygon, |leaf, polygon| {
                    pairs.push(([first, sides[1].part(leaf)], polygon.points()));
                }),
                Side::Whole(second) => pairs.push(([first, *second], polygon.points())),
            }
        }
        let face = SharedFace {
            facet,
            cells,
            normal: mesh::facet_normal(&self.points(facet)[..D]),
            is_ghost: self.is_ghost(cut, cells),
            first: cut.part_faces.len(),
        };
        for (parts, polygon) in pairs {
            match parts {
                [Some(first), Some(second)] => face.add(cut, [first, second], measure(&polygon)),
                [Some(part), None] => self.add_interface(cut, &face, &sides, 0, part, &polygon),
                [None, Some(part)] => self.add_interface(cut, &face, &sides, 1, part, &polygon),
                [None, None] => {}
            }
        }
    }

    /// Interface on a face of the background: fluid in cell `side`, a body in the other one, or a layer of fluid too
    /// thin to count and then the body.
    fn add_interface(
        &self,
        cut: &mut CutMesh<D>,
        face: &SharedFace<D>,
        sides: &[Side<D>; 2],
        side: usize,
        part: PartId,
        polygon: &[Point<D>],
    ) {
        let normal = if side == 0 { -face.normal } else { face.normal };
        let Cutting { planes, touched, thinnest: tolerance, .. } = self.cutting;
        let touching = face.cells.iter().filter_map(|&cell| touched.position(cell));
        let mut aligned: Vec<u32> = touching.flat_map(|k| touched.facets(k).iter().copied()).collect();
        aligned.sort_unstable();
        aligned.dedup();
        aligned.retain(|&f| planes.lies_on(f, Plane::mesh(face.facet)));
        let thin = match &sides[1 - side] {
            Side::Cut(beyond, _) => &beyond.thin[..],
            Side::Whole(_) => &[],
        };
        let on_face = aligned.iter().map(|&f| (f, Points::from_slice(planes.facets[f as usize].points())));
        let candidates = on_face.chain(thin.iter().map(|piece| (piece.facet, piece.polygon.clone())));
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
                    for_each_face_simplex(&overlap, |corners| {
                        cut.interface.push(InterfacePiece::new(face.cells[side], part, facet, corners));
                    });
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

/// How far from a face a facet in front of a layer of no thickness may lie, in thicknesses: a layer may be thicker at
/// one end.
const REACH: f64 = 16.0;

/// An interior face of the background while the parts on its two sides are joined.
struct SharedFace<const D: usize> {
    facet: FacetId,
    cells: [CellId; 2],
    /// Out of the first cell.
    normal: Vector<D>,
    is_ghost: bool,
    /// Number of part faces before this face.
    first: usize,
}

impl<const D: usize> SharedFace<D> {
    /// Adds to what two parts share on the face.
    fn add(&self, cut: &mut CutMesh<D>, parts: [PartId; 2], measure: f64) {
        match cut.part_faces[self.first..].iter_mut().find(|face| face.parts == parts) {
            Some(face) => face.measure += measure,
            None => cut.part_faces.push(PartFace { facet: self.facet, parts, measure, is_ghost: self.is_ghost }),
        }
    }
}
