//! Laying surfaces over a background mesh.

use mesh::{CellId, Placed, SimplexMesh};

use crate::cell::Kept;
use crate::exact::Planes;
use crate::report::SLIVER;
use crate::surface::Facet;
use crate::touched::TouchedCells;
use crate::{CellState, CutMesh, CutReport, Error, InterfacePiece, PartId, Workspace};

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
    /// See [`Error`]: surfaces that are empty, open, non-manifold, turned inwards, self-intersecting, not finite, or too far away.
    pub fn overlay(
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        options: &OverlayOptions,
    ) -> Result<Self, Error> {
        Workspace::new().overlay(background, surfaces, options)
    }

    /// Empty, in the same memory.
    pub(crate) fn clear(&mut self) {
        self.cell_to_state.clear();
        self.cell_to_part.clear();
        self.part_to_cell.clear();
        self.part_to_volume.clear();
        self.part_to_piece.clear();
        self.pieces.clear();
        self.covered_pieces.clear();
        self.covered_to_cell.clear();
        self.interface.clear();
        self.part_faces.clear();
        self.boundary.clear();
        self.report = CutReport { smallest_fraction: 1.0, ..CutReport::default() };
    }

    /// Adds all cells in their order: those that facets touch, and those between them.
    pub(crate) fn add_cells(&mut self, cutting: &Cutting<'_, D>, kept: &[&Kept<D>]) {
        let background = cutting.planes.background;
        self.cell_to_state.reserve(background.n_cells());
        self.cell_to_part.reserve(background.n_cells() + 1);
        self.part_to_piece.push(0);
        let mut next = CellId(0);
        let mut touched = cutting.touched.cells.iter();
        for kept in kept {
            let n_pieces = self.pieces.len() as u32;
            let mut part = 0;
            let (mut wet, mut corners) = (kept.wet.iter(), &kept.wet_corners[..]);
            for (of, &cell) in kept.cells.iter().zip(&mut touched) {
                self.add_untouched(cutting, next, cell);
                next = CellId(cell.0 + 1);
                self.report.n_left_out += of.n_left_out as usize;
                let first_part = self.part_to_cell.len() as u32;
                let volume = background.cell_volume(cell);
                let state = match (of.n_parts, of.is_whole) {
                    (0, _) => CellState::Covered,
                    (_, true) => CellState::Fluid,
                    _ => CellState::Cut,
                };
                for _ in 0..of.n_parts {
                    let part_volume = if of.is_whole { volume } else { kept.volumes[part] };
                    self.add_part(cell, part_volume, n_pieces + kept.part_to_piece_end[part]);
                    let fraction = part_volume / volume;
                    self.report.smallest_fraction = self.report.smallest_fraction.min(fraction);
                    self.report.n_slivers += usize::from(fraction < SLIVER);
                    part += 1;
                }
                for piece in wet.by_ref().take(of.n_wet as usize) {
                    let (own, others) = corners.split_at(piece.n_corners as usize);
                    let facet = &cutting.planes.facets[piece.facet as usize];
                    InterfacePiece::push_fan(cell, PartId(first_part + piece.part), facet, own, &mut self.interface);
                    corners = others;
                }
                self.close_cell(first_part, state);
            }
            self.pieces.append(&kept.pieces);
            self.covered_pieces.append(&kept.covered);
            self.covered_to_cell.extend_from_slice(&kept.covered_to_cell);
        }
        self.add_untouched(cutting, next, CellId::new(background.n_cells()));
        self.cell_to_part.push(self.part_to_cell.len() as u32);
    }

    /// Adds the cells from one up to another one, none of which is touched.
    fn add_untouched(&mut self, cutting: &Cutting<'_, D>, from: CellId, to: CellId) {
        let background = cutting.planes.background;
        let n_pieces = self.part_to_piece.last().copied().unwrap_or(0);
        for cell in (from.0..to.0).map(CellId) {
            let first_part = self.part_to_cell.len() as u32;
            let is_covered = cutting.depth[background.cell(cell)[0].index()] > 0;
            if !is_covered {
                self.add_part(cell, background.cell_volume(cell), n_pieces);
            }
            self.close_cell(first_part, if is_covered { CellState::Covered } else { CellState::Fluid });
        }
    }

    fn add_part(&mut self, cell: CellId, volume: f64, piece_end: u32) {
        self.part_to_cell.push(cell);
        self.part_to_volume.push(volume);
        self.part_to_piece.push(piece_end);
    }

    /// Notes the state of a cell whose parts were added.
    fn close_cell(&mut self, first_part: u32, state: CellState) {
        match state {
            CellState::Fluid => self.report.n_fluid_cells += 1,
            CellState::Covered => self.report.n_covered_cells += 1,
            CellState::Cut => self.report.n_cut_cells += 1,
        }
        self.cell_to_part.push(first_part);
        self.cell_to_state.push(state);
        self.report.max_parts = self.report.max_parts.max(self.part_to_cell.len() - first_part as usize);
    }
}

/// All that it takes to cut a cell.
#[derive(Clone, Copy)]
pub(crate) struct Cutting<'a, const D: usize> {
    pub(crate) planes: Planes<'a, D>,
    pub(crate) touched: &'a TouchedCells,
    /// Number of bodies around each vertex of the background.
    pub(crate) depth: &'a [i32],
    /// Thickness of what counts as nothing.
    pub(crate) thinnest: f64,
}

impl<'a, const D: usize> Cutting<'a, D> {
    pub(crate) fn new(
        background: &'a SimplexMesh<D>,
        facets: &'a [Facet<D>],
        touched: &'a TouchedCells,
        depth: &'a [i32],
        options: &OverlayOptions,
    ) -> Self {
        let extent = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
        let planes = Planes { background, facets, resolution: 2.0 * f64::EPSILON * extent };
        let size = mesh::equilateral_side::<D>(background.volume() / background.n_cells() as f64);
        // Coordinates themselves carry round-off.
        Self { planes, touched, depth, thinnest: options.relative_tolerance * size + 4.0 * planes.resolution }
    }
}
