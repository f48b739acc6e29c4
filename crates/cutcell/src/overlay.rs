//! Laying surfaces over a background mesh.

use mesh::{CellId, Placed, SimplexMesh};
use rayon::prelude::*;

use crate::cell::{CellCut, CellPieces, FaceView};
use crate::classify::depths;
use crate::cut_mesh::for_each_face_simplex;
use crate::exact::Planes;
use crate::faces::Faces;
use crate::report::SLIVER;
use crate::surface::{self, Facet};
use crate::touched::TouchedCells;
use crate::{CellState, CutMesh, CutReport, Error, InterfacePiece, PartId};

/// Settings of an overlay.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayOptions {
    /// Thickness up to which a fluid part is left out, as a fraction of the mean cell size: bodies this close to each
    /// other touch, and a facet this close to a face of the background lies on it.
    pub relative_tolerance: f64,
    /// Whether surfaces that intersect themselves are refused. The check costs about as much as the cut of a fine surface;
    /// a simulation that checked its surfaces once may go without.
    pub refuse_self_intersections: bool,
}

impl OverlayOptions {
    /// A tolerance of 1e-13 cell sizes; surfaces that intersect themselves are refused.
    pub fn new() -> Self {
        Self { relative_tolerance: 1e-13, refuse_self_intersections: true }
    }

    /// The same without the check for self-intersections.
    #[must_use]
    pub fn without_self_intersection_check(self) -> Self {
        Self { refuse_self_intersections: false, ..self }
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
    /// See [`Error`]: surfaces that are empty, open, non-manifold, turned inwards, self-intersecting, or not finite.
    pub fn overlay(
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        options: &OverlayOptions,
    ) -> Result<Self, Error> {
        let facets = surface::collect(surfaces, options)?;
        let touched = TouchedCells::new(background, &facets);
        let depth = depths(background, &facets, &touched);
        Ok(Self::from_facets(background, &facets, &touched, &depth, options))
    }

    /// Cuts by facets, with the number of bodies around each vertex of the background.
    pub(crate) fn from_facets(
        background: &SimplexMesh<D>,
        facets: &[Facet<D>],
        touched: &TouchedCells,
        depth: &[i32],
        options: &OverlayOptions,
    ) -> Self {
        let extent = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
        let planes = Planes { background, facets, resolution: 2.0 * f64::EPSILON * extent };
        let volume: f64 = background.cells().map(|c| background.cell_volume(c)).sum();
        let size = mesh::equilateral_side::<D>(volume / background.n_cells() as f64);
        // Coordinates themselves carry round-off.
        let thinnest = options.relative_tolerance * size + 4.0 * planes.resolution;
        let cutting = Cutting { planes, touched, depth, thinnest };
        let cuts: Vec<CellPieces<D>> = (0..touched.cells.len())
            .into_par_iter()
            .map(|k| cutting.cut(k).into_pieces(&planes, touched.cells[k]))
            .collect();
        let views: Vec<[FaceView; 4]> = cuts.iter().map(|pieces| pieces.faces).collect();
        let mut cut = Self::empty(background);
        // Touched cells come in the order of all cells.
        let mut cuts = cuts.into_iter();
        for cell in background.cells() {
            cut.cell_to_part.push(cut.part_to_cell.len() as u32);
            let state = match touched.position(cell).and_then(|_| cuts.next()) {
                Some(pieces) => cut.add_touched_cell(&planes, cell, pieces),
                None if depth[background.cell(cell)[0].index()] > 0 => CellState::Covered,
                None => CellState::Fluid,
            };
            cut.close_cell(background, cell, state);
        }
        cut.cell_to_part.push(cut.part_to_cell.len() as u32);
        Faces { cutting, views: &views }.add_to(&mut cut);
        // Pieces on faces of the background were found face by face.
        cut.interface.sort_by_key(|piece| (piece.cell, piece.body, piece.facet));
        cut
    }

    fn empty(background: &SimplexMesh<D>) -> Self {
        let n_cells = background.n_cells();
        Self {
            cell_to_state: Vec::with_capacity(n_cells),
            cell_to_part: Vec::with_capacity(n_cells + 1),
            part_to_cell: Vec::with_capacity(n_cells),
            part_to_volume: Vec::with_capacity(n_cells),
            part_to_piece: {
                let mut offsets = Vec::with_capacity(n_cells + 1);
                offsets.push(0);
                offsets
            },
            pieces: Vec::new(),
            covered_pieces: Vec::new(),
            interface: Vec::new(),
            part_faces: Vec::with_capacity(background.n_facets()),
            boundary: Vec::new(),
            report: CutReport { smallest_fraction: 1.0, ..CutReport::default() },
        }
    }

    /// Adds the parts of a cell that facets may cross; for an uncut one only says what it is.
    fn add_touched_cell(&mut self, planes: &Planes<'_, D>, cell: CellId, from: CellPieces<D>) -> CellState {
        self.report.n_left_out += from.n_left_out;
        if from.volumes.is_empty() {
            return CellState::Covered;
        }
        if from.pieces.is_empty() {
            return CellState::Fluid;
        }
        let first_part = self.part_to_cell.len() as u32;
        let cell_volume = planes.background.cell_volume(cell);
        let mut pieces = from.pieces.into_iter().peekable();
        for (part, &volume) in from.volumes.iter().enumerate() {
            while let Some((_, piece)) = pieces.next_if(|(of, _)| *of == Some(part as u32)) {
                self.pieces.push(piece);
            }
            self.part_to_cell.push(cell);
            self.part_to_volume.push(volume);
            self.part_to_piece.push(self.pieces.len() as u32);
            let fraction = volume / cell_volume;
            self.report.smallest_fraction = self.report.smallest_fraction.min(fraction);
            self.report.n_slivers += usize::from(fraction < SLIVER);
        }
        self.covered_pieces.extend(pieces.map(|(_, piece)| (cell, piece)));
        for wet in &from.wet {
            let facet = &planes.facets[wet.facet as usize];
            for_each_face_simplex(&wet.polygon, |corners| {
                self.interface.push(InterfacePiece::new(cell, PartId(first_part + wet.part), facet, corners));
            });
        }
        CellState::Cut
    }

    /// Notes the state of a cell whose parts were added.
    fn close_cell(&mut self, background: &SimplexMesh<D>, cell: CellId, state: CellState) {
        match state {
            CellState::Fluid => {
                self.part_to_cell.push(cell);
                self.part_to_volume.push(background.cell_volume(cell));
                self.part_to_piece.push(self.pieces.len() as u32);
                self.report.n_fluid_cells += 1;
            }
            CellState::Covered => self.report.n_covered_cells += 1,
            CellState::Cut => self.report.n_cut_cells += 1,
        }
        self.cell_to_state.push(state);
        let n_parts = self.part_to_cell.len() - self.cell_to_part[cell.index()] as usize;
        self.report.max_parts = self.report.max_parts.max(n_parts);
    }
}

/// All that it takes to cut a cell.
#[derive(Clone, Copy)]
pub(crate) struct Cutting<'a, const D: usize> {
    pub(crate) planes: Planes<'a, D>,
    pub(crate) touched: &'a TouchedCells,
    depth: &'a [i32],
    /// Thickness of what counts as nothing.
    pub(crate) thinnest: f64,
}

impl<const D: usize> Cutting<'_, D> {
    /// Cuts the touched cell at position `k`; the same every time.
    pub(crate) fn cut(&self, k: usize) -> CellCut<D> {
        let cell = self.touched.cells[k];
        let first = self.planes.background.cell(cell)[0];
        CellCut::new(&self.planes, cell, self.depth[first.index()], self.touched.facets(k), self.thinnest)
    }
}
