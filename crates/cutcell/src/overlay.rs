//! Laying surfaces over a background mesh.

use mesh::{CellId, FacetId, Placed, Point, SimplexMesh};
use rayon::prelude::*;

use crate::cell::{CellCut, cover_by_facets, cut_cell, subtract_facing};
use crate::classify::depths;
use crate::clip::face_overlap;
use crate::cut_mesh::{for_each_face_simplex, local_facet};
use crate::surface::{self, Facet};
use crate::{BoundaryPiece, CellState, CutMesh, CutReport, Error, InterfacePiece, PartFace, PartId};

/// Settings of an overlay.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayOptions {
    /// Distance below which a point counts as lying on a plane, as a fraction of the mean cell size.
    pub relative_tolerance: f64,
}

impl OverlayOptions {
    /// A tolerance of 1e-13 cell sizes.
    pub fn new() -> Self {
        Self { relative_tolerance: 1e-13 }
    }
}

impl Default for OverlayOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl<const D: usize> CutMesh<D> {
    /// Cuts a background mesh by the closed surfaces of any number of bodies.
    ///
    /// Bodies may touch and overlap each other and stick out of the background; fluid is the background without
    /// their union. Facets on the boundary of the background border no fluid; facets on an interior face of the
    /// background belong to the cell on the fluid side.
    ///
    /// # Errors
    /// See [`Error`]: surfaces that are empty, open, non-manifold, turned inwards, or not finite.
    pub fn overlay(
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        options: &OverlayOptions,
    ) -> Result<Self, Error> {
        let facets = surface::collect(surfaces)?;
        let tolerance = tolerance(background, &facets, options);
        let touched = TouchedCells::new(background, &facets, tolerance);
        let depth = depths(background, &facets, &touched);
        let cuts: Vec<CellCut<D>> = touched
            .cells
            .par_iter()
            .enumerate()
            .map(|(k, &cell)| {
                let corners = background.simplex(cell);
                let first = background.cell(cell)[0];
                cut_cell(corners.points(), depth[first.index()], touched.facets(k), &facets, tolerance)
            })
            .collect();
        let mut builder = Builder { background, facets: &facets, tolerance, touched: &touched, cuts: &cuts };
        Ok(builder.build(&depth))
    }
}

fn tolerance<const D: usize>(background: &SimplexMesh<D>, facets: &[Facet<D>], options: &OverlayOptions) -> f64 {
    let volume: f64 = background.cells().map(|c| background.cell_volume(c)).sum();
    let size = mesh::equilateral_side::<D>(volume / background.n_cells() as f64);
    let reach = facets.iter().fold(0.0_f64, |r, f| r.max(f.low.amax()).max(f.high.amax()));
    // Coordinates themselves carry round-off.
    options.relative_tolerance * size + 4.0 * f64::EPSILON * reach
}

/// Cells that facets may touch, with those facets.
pub(crate) struct TouchedCells {
    pub(crate) cells: Vec<CellId>,
    offsets: Vec<u32>,
    facets: Vec<u32>,
    cell_to_touched: Vec<u32>,
}

const UNTOUCHED: u32 = u32::MAX;

impl TouchedCells {
    fn new<const D: usize>(background: &SimplexMesh<D>, facets: &[Facet<D>], tolerance: f64) -> Self {
        let mut pairs: Vec<(CellId, u32)> = Vec::new();
        let mut near = Vec::new();
        let margin = Point::<D>::repeat(2.0 * tolerance);
        for (index, facet) in facets.iter().enumerate() {
            near.clear();
            background.cell_index().cells_overlapping(&(facet.low - margin), &(facet.high + margin), &mut near);
            for &cell in &near {
                let corners = background.simplex(cell);
                let mut below = false;
                let mut above = false;
                for x in corners.points() {
                    let d = facet.distance(x, 2.0 * tolerance);
                    below |= d <= 0.0;
                    above |= d >= 0.0;
                }
                if below && above {
                    pairs.push((cell, index as u32));
                }
            }
        }
        pairs.sort_unstable();
        let mut touched = Self {
            cells: Vec::new(),
            offsets: vec![0],
            facets: pairs.iter().map(|p| p.1).collect(),
            cell_to_touched: vec![UNTOUCHED; background.n_cells()],
        };
        for group in pairs.chunk_by(|a, b| a.0 == b.0) {
            touched.cell_to_touched[group[0].0.index()] = touched.cells.len() as u32;
            touched.cells.push(group[0].0);
            touched.offsets.push(touched.offsets[touched.cells.len() - 1] + group.len() as u32);
        }
        touched
    }

    /// Facets of the touched cell at position `k`.
    pub(crate) fn facets(&self, k: usize) -> &[u32] {
        &self.facets[self.offsets[k] as usize..self.offsets[k + 1] as usize]
    }

    /// Position of a cell among the touched cells.
    pub(crate) fn position(&self, cell: CellId) -> Option<usize> {
        let k = self.cell_to_touched[cell.index()];
        (k != UNTOUCHED).then_some(k as usize)
    }
}

/// Puts the cuts of single cells together.
struct Builder<'a, const D: usize> {
    background: &'a SimplexMesh<D>,
    facets: &'a [Facet<D>],
    tolerance: f64,
    touched: &'a TouchedCells,
    cuts: &'a [CellCut<D>],
}

impl<const D: usize> Builder<'_, D> {
    fn build(&mut self, depth: &[i32]) -> CutMesh<D> {
        let n_cells = self.background.n_cells();
        let mut cut = CutMesh {
            cell_to_state: Vec::with_capacity(n_cells),
            cell_to_part: Vec::with_capacity(n_cells + 1),
            part_to_cell: Vec::with_capacity(n_cells),
            part_to_volume: Vec::with_capacity(n_cells),
            part_to_piece: Vec::with_capacity(n_cells + 1),
            pieces: Vec::new(),
            covered_pieces: Vec::new(),
            interface: Vec::new(),
            part_faces: Vec::with_capacity(self.background.n_facets()),
            boundary: Vec::new(),
            report: CutReport { smallest_fraction: 1.0, ..CutReport::default() },
        };
        cut.part_to_piece.push(0);
        for cell in self.background.cells() {
            cut.cell_to_part.push(cut.part_to_cell.len() as u32);
            let state = match self.touched.position(cell) {
                Some(k) => self.add_touched_cell(&mut cut, cell, &self.cuts[k]),
                None if depth[self.background.cell(cell)[0].index()] > 0 => CellState::Covered,
                None => CellState::Fluid,
            };
            match state {
                CellState::Fluid => {
                    cut.part_to_cell.push(cell);
                    cut.part_to_volume.push(self.background.cell_volume(cell));
                    cut.part_to_piece.push(cut.pieces.len() as u32);
                    cut.report.n_fluid_cells += 1;
                }
                CellState::Covered => cut.report.n_covered_cells += 1,
                CellState::Cut => cut.report.n_cut_cells += 1,
            }
            cut.cell_to_state.push(state);
            let n_parts = cut.part_to_cell.len() - cut.cell_to_part[cell.index()] as usize;
            cut.report.max_parts = cut.report.max_parts.max(n_parts);
        }
        cut.cell_to_part.push(cut.part_to_cell.len() as u32);
        self.add_faces(&mut cut);
        // Pieces on faces of the background were found face by face.
        cut.interface.sort_by_key(|piece| (piece.cell, piece.body, piece.facet));
        cut
    }

    fn add_touched_cell(&self, cut: &mut CutMesh<D>, cell: CellId, from: &CellCut<D>) -> CellState {
        if let [leaf] = from.leaves.as_slice() {
            return if leaf.is_fluid() { CellState::Fluid } else { CellState::Covered };
        }
        if from.leaves.iter().all(|leaf| !leaf.is_fluid()) {
            return CellState::Covered;
        }
        let first_part = cut.part_to_cell.len() as u32;
        let cell_volume = self.background.cell_volume(cell);
        for part in 0..from.n_parts {
            let mut volume = 0.0;
            for leaf in from.leaves.iter().filter(|leaf| leaf.is_fluid() && leaf.part == part) {
                volume += leaf.polytope.volume();
                cut.pieces.push(leaf.polytope.clone());
            }
            cut.part_to_cell.push(cell);
            cut.part_to_volume.push(volume);
            cut.part_to_piece.push(cut.pieces.len() as u32);
            cut.report.smallest_fraction = cut.report.smallest_fraction.min(volume / cell_volume);
        }
        for leaf in from.leaves.iter().filter(|leaf| !leaf.is_fluid()) {
            cut.covered_pieces.push((cell, leaf.polytope.clone()));
        }
        for wet in &from.wet {
            let facet = &self.facets[wet.facet as usize];
            for_each_face_simplex(&wet.polygon, |corners| {
                cut.interface.push(InterfacePiece::new(cell, PartId(first_part + wet.part), facet, corners));
            });
        }
        CellState::Cut
    }

    fn add_faces(&self, cut: &mut CutMesh<D>) {
        let mut fragments: [Vec<Fragment<D>>; 2] = [Vec::new(), Vec::new()];
        let mut overlap = Vec::new();
        for facet in self.background.facets() {
            let [first, second] = self.background.facet_to_cell(facet);
            let Some(first) = first else { continue };
            let touched = self.touched.position(first).is_some()
                || second.is_some_and(|cell| self.touched.position(cell).is_some());
            match second {
                None => {
                    self.fragments(cut, first, facet, &mut fragments[0]);
                    for fragment in fragments[0].iter() {
                        if let Some(part) = fragment.part {
                            for_each_face_simplex(&fragment.polygon, |points| {
                                let measure = mesh::simplex_measure(&points[..D]);
                                cut.boundary.push(BoundaryPiece { facet, part, points, measure });
                            });
                        }
                    }
                }
                Some(second) if !touched => {
                    if let (CellState::Fluid, CellState::Fluid) = (cut.cell_state(first), cut.cell_state(second)) {
                        let parts = [first, second].map(|cell| PartId(cut.cell_to_part[cell.index()]));
                        let measure = mesh::simplex_measure(&self.facet_points(facet)[..D]);
                        cut.part_faces.push(PartFace { facet, parts, measure, is_ghost: false });
                    }
                }
                Some(second) => {
                    self.fragments(cut, first, facet, &mut fragments[0]);
                    self.fragments(cut, second, facet, &mut fragments[1]);
                    self.join(cut, facet, [first, second], &fragments, &mut overlap);
                }
            }
        }
    }

    /// The pieces of a face of the background as seen from one of its cells.
    fn fragments(&self, cut: &CutMesh<D>, cell: CellId, facet: FacetId, out: &mut Vec<Fragment<D>>) {
        out.clear();
        let first_part = cut.cell_to_part[cell.index()];
        match (cut.cell_state(cell), self.touched.position(cell)) {
            (CellState::Cut, Some(k)) => {
                let local = self.background.cell_to_facet(cell).iter().position(|&f| f == facet);
                for leaf in &self.cuts[k].leaves {
                    for (face, (label, _)) in leaf.polytope.faces().enumerate() {
                        if local_facet(label) == local && local.is_some() {
                            let part = leaf.is_fluid().then_some(PartId(first_part + leaf.part));
                            out.push(Fragment { part, polygon: leaf.polytope.face_points(face).collect() });
                        }
                    }
                }
            }
            (state, _) => {
                let part = (state == CellState::Fluid).then_some(PartId(first_part));
                out.push(Fragment { part, polygon: self.facet_points(facet)[..D].to_vec() });
            }
        }
    }

    /// Pairs the fragments of an interior face seen from its two cells: fluid on both sides joins two parts, fluid
    /// on one side is interface.
    fn join(
        &self,
        cut: &mut CutMesh<D>,
        facet: FacetId,
        cells: [CellId; 2],
        fragments: &[Vec<Fragment<D>>; 2],
        overlap: &mut Vec<Point<D>>,
    ) {
        // Out of the first cell.
        let normal = mesh::facet_normal(&self.facet_points(facet)[..D]);
        let mut face = SharedFace {
            facet,
            cells,
            normal,
            is_ghost: cells.iter().any(|&cell| cut.cell_state(cell) == CellState::Cut),
            first: cut.part_faces.len(),
        };
        for a in &fragments[0] {
            for b in &fragments[1] {
                if a.part.is_none() && b.part.is_none() {
                    continue;
                }
                let measure = face_overlap(&a.polygon, &b.polygon, &normal, self.tolerance, overlap);
                if measure <= 0.0 {
                    continue;
                }
                match (a.part, b.part) {
                    (Some(first), Some(second)) => face.add(cut, [first, second], measure),
                    (Some(part), None) => self.add_aligned(cut, &mut face, 0, part, overlap.clone()),
                    (None, Some(part)) => self.add_aligned(cut, &mut face, 1, part, overlap.clone()),
                    (None, None) => {}
                }
            }
        }
    }

    /// Interface on a face of the background: fluid in cell `side`, body in the other.
    fn add_aligned(
        &self,
        cut: &mut CutMesh<D>,
        face: &mut SharedFace<D>,
        side: usize,
        part: PartId,
        polygon: Vec<Point<D>>,
    ) {
        let normal = if side == 0 { -face.normal } else { face.normal };
        let mut candidates: Vec<u32> = face
            .cells
            .iter()
            .filter_map(|&cell| self.touched.position(cell))
            .flat_map(|k| self.touched.facets(k).iter().copied())
            .collect();
        candidates.sort_unstable();
        candidates.dedup();
        let mut rest =
            cover_by_facets(polygon, &normal, &candidates, self.facets, self.tolerance, |index, face_piece| {
                for_each_face_simplex(&face_piece, |corners| {
                    let piece = InterfacePiece::new(face.cells[side], part, &self.facets[index as usize], corners);
                    cut.report.n_aligned_pieces += 1;
                    cut.interface.push(piece);
                });
            });
        // A tail of no thickness along the face, with fluid behind it.
        let other = face.cells[1 - side];
        if let Some(k) = self.touched.position(other).filter(|_| !rest.is_empty()) {
            let beyond = &self.cuts[k];
            for bare in beyond.bare.iter().filter(|bare| bare.normal.dot(&normal) < 0.0) {
                let before = measure(&rest);
                if subtract_facing(&mut rest, &normal, bare, self.tolerance) {
                    let behind = PartId(cut.cell_to_part[other.index()] + beyond.leaves[bare.leaf].part);
                    let parts = if side == 0 { [part, behind] } else { [behind, part] };
                    face.add(cut, parts, before - measure(&rest));
                }
            }
        }
        cut.report.uncovered_measure += measure(&rest);
    }

    fn facet_points(&self, facet: FacetId) -> [Point<D>; 3] {
        let mut points = [Point::zeros(); 3];
        for (slot, v) in points.iter_mut().zip(self.background.facet(facet)) {
            *slot = self.background.vertex(*v);
        }
        points
    }
}

/// Sum of the measures of convex faces.
fn measure<const D: usize>(polygons: &[Vec<Point<D>>]) -> f64 {
    let mut sum = 0.0;
    for polygon in polygons {
        for_each_face_simplex(polygon, |corners| sum += mesh::simplex_measure(&corners[..D]));
    }
    sum
}

/// An interior face of the background while the parts on its two sides are joined.
struct SharedFace<const D: usize> {
    facet: FacetId,
    cells: [CellId; 2],
    normal: mesh::Vector<D>,
    is_ghost: bool,
    /// Number of part faces before this face.
    first: usize,
}

impl<const D: usize> SharedFace<D> {
    /// Adds to what two parts share on the face.
    fn add(&mut self, cut: &mut CutMesh<D>, parts: [PartId; 2], measure: f64) {
        match cut.part_faces[self.first..].iter_mut().find(|face| face.parts == parts) {
            Some(face) => face.measure += measure,
            None => cut.part_faces.push(PartFace { facet: self.facet, parts, measure, is_ghost: self.is_ghost }),
        }
    }
}

/// A convex piece of a face of the background seen from one cell; no part means body.
struct Fragment<const D: usize> {
    part: Option<PartId>,
    polygon: Vec<Point<D>>,
}
