//! How the parts of neighbouring cells meet on the faces of the background.

use mesh::{CellId, FacetId, Point, Vector, simplex_measure};

use crate::cell::CellCut;
use crate::clip::{Polygon, face_difference, face_overlap};
use crate::cut_mesh::{for_each_face_simplex, measure};
use crate::exact::{Plane, Planes};
use crate::touched::TouchedCells;
use crate::tree::whole_cell;
use crate::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};

/// The faces of the background with the cells that were cut.
pub(crate) struct Faces<'a, const D: usize> {
    pub(crate) planes: Planes<'a, D>,
    pub(crate) touched: &'a TouchedCells,
    pub(crate) cuts: &'a [CellCut<D>],
    /// Thickness of what counts as nothing.
    pub(crate) tolerance: f64,
}

impl<const D: usize> Faces<'_, D> {
    /// Adds part faces, wet boundary, and the interface on faces.
    pub(crate) fn add_to(&self, cut: &mut CutMesh<D>) {
        let background = self.planes.background;
        for facet in background.facets() {
            let [first, second] = background.facet_to_cell(facet);
            let Some(first) = first else { continue };
            match second {
                None => {
                    for (part, polygon) in self.fragments(cut, facet, first) {
                        let Some(part) = part else { continue };
                        for_each_face_simplex(&polygon.points(), |points| {
                            let measure = simplex_measure(&points[..D]);
                            cut.boundary.push(BoundaryPiece { facet, part, points, measure });
                        });
                    }
                }
                Some(second) if self.is_untouched(first) && self.is_untouched(second) => {
                    if let (CellState::Fluid, CellState::Fluid) = (cut.cell_state(first), cut.cell_state(second)) {
                        let parts = [first, second].map(|cell| PartId(cut.cell_to_part[cell.index()]));
                        let measure = simplex_measure(&self.points(facet)[..D]);
                        cut.part_faces.push(PartFace { facet, parts, measure, is_ghost: false });
                    }
                }
                Some(second) => self.join(cut, facet, [first, second]),
            }
        }
    }

    fn is_untouched(&self, cell: CellId) -> bool {
        self.touched.position(cell).is_none()
    }

    fn points(&self, facet: FacetId) -> [Point<D>; 3] {
        let mut points = [Point::zeros(); 3];
        for (slot, &v) in points.iter_mut().zip(self.planes.background.facet(facet)) {
            *slot = self.planes.background.vertex(v);
        }
        points
    }

    /// The part of a leaf of a cut cell.
    fn part_of(&self, cut: &CutMesh<D>, cell: CellId, from: &CellCut<D>, leaf: usize) -> Option<PartId> {
        from.fluid_part(leaf).map(|part| PartId(cut.cell_to_part[cell.index()] + part))
    }

    /// The pieces of a face of the background as seen from one of its cells; no part means body.
    fn fragments(&self, cut: &CutMesh<D>, facet: FacetId, cell: CellId) -> Vec<(Option<PartId>, Polygon<D>)> {
        match self.touched.position(cell) {
            Some(k) => {
                let faces = self.cuts[k].faces(Plane::mesh(facet));
                faces.map(|(leaf, polygon)| (self.part_of(cut, cell, &self.cuts[k], leaf), polygon)).collect()
            }
            None => {
                let local = self.planes.background.cell_to_facet(cell).iter().position(|&f| f == facet);
                vec![(cut.parts(cell).next(), whole_cell(&self.planes, cell).face(local.unwrap_or(0)))]
            }
        }
    }

    /// Pairs the pieces of an interior face seen from its two cells: fluid on both sides joins two parts, fluid on one
    /// side is interface.
    fn join(&self, cut: &mut CutMesh<D>, facet: FacetId, cells: [CellId; 2]) {
        let mut pairs: Vec<([Option<PartId>; 2], Vec<Point<D>>)> = Vec::new();
        for (first, polygon) in self.fragments(cut, facet, cells[0]) {
            match self.touched.position(cells[1]) {
                Some(k) => self.cuts[k].tree.locate(&self.planes, polygon, |leaf, polygon| {
                    let second = self.part_of(cut, cells[1], &self.cuts[k], leaf);
                    pairs.push(([first, second], polygon.points()));
                }),
                None => pairs.push(([first, cut.parts(cells[1]).next()], polygon.points())),
            }
        }
        let face = SharedFace {
            facet,
            cells,
            normal: mesh::facet_normal(&self.points(facet)[..D]),
            is_ghost: cells.iter().any(|&cell| cut.cell_state(cell) == CellState::Cut),
            first: cut.part_faces.len(),
        };
        for (parts, polygon) in pairs {
            match parts {
                [Some(first), Some(second)] => face.add(cut, [first, second], measure(&polygon)),
                [Some(part), None] => self.add_interface(cut, &face, 0, part, polygon),
                [None, Some(part)] => self.add_interface(cut, &face, 1, part, polygon),
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
        side: usize,
        part: PartId,
        polygon: Vec<Point<D>>,
    ) {
        let normal = if side == 0 { -face.normal } else { face.normal };
        let touching = face.cells.map(|cell| self.touched.position(cell));
        let mut aligned: Vec<u32> =
            touching.iter().flatten().flat_map(|&k| self.touched.facets(k).iter().copied()).collect();
        aligned.sort_unstable();
        aligned.dedup();
        aligned.retain(|&f| self.planes.lies_on(f, Plane::mesh(face.facet)));
        let thin = touching[1 - side].map_or(&[][..], |k| &self.cuts[k].thin);
        let on_face = aligned.iter().map(|&f| (f, self.planes.facets[f as usize].points()));
        let candidates = on_face.chain(thin.iter().map(|piece| (piece.facet, piece.polygon.as_slice())));
        let mut rest = vec![polygon];
        let mut overlap = Vec::new();
        for (index, by) in candidates {
            let facet = &self.planes.facets[index as usize];
            if facet.normal.dot(&normal) <= 0.0 {
                continue;
            }
            let mut left = Vec::new();
            for polygon in rest {
                if face_overlap(&polygon, by, &normal, self.tolerance, &mut overlap) > 0.0 {
                    for_each_face_simplex(&overlap, |corners| {
                        cut.interface.push(InterfacePiece::new(face.cells[side], part, facet, corners));
                        cut.report.n_aligned_pieces += 1;
                    });
                    face_difference(&polygon, by, &normal, self.tolerance, &mut left);
                } else {
                    left.push(polygon);
                }
            }
            rest = left;
        }
        cut.report.uncovered_measure += rest.iter().map(|polygon| measure(polygon)).sum::<f64>();
    }
}

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
