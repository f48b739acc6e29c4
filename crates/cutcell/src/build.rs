//! Assembly of the cells of an overlay to a [`CutMesh`].

use mesh::CellId;

use crate::cell::Kept;
use crate::cutting::Cutting;
use crate::report::SLIVER;
use crate::{CellState, CutMesh, CutReport, InterfacePiece, PartId};

impl<const D: usize> CutMesh<D> {
    /// Removes all entries; keeps the allocations.
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

    /// Adds all cells in ascending order: touched cells, and the untouched cells between them.
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

    /// Adds the cells `from..to`, which are untouched.
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

    /// Stores the state of a cell whose parts have been added.
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
