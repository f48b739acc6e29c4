//! Broad phase: the cells that facets may touch.

use mesh::{CellId, SimplexMesh};
use rayon::prelude::*;

use crate::surface::Facet;

/// Cells that facets may touch, with the facets of each.
#[derive(Debug, Default)]
pub(crate) struct TouchedCells {
    /// Touched cells in ascending order.
    pub(crate) cells: Vec<CellId>,
    /// Facets of touched cell `k`: `facets[offsets[k]..offsets[k + 1]]`, ascending.
    offsets: Vec<u32>,
    facets: Vec<u32>,
    /// Position of each cell of the background in `cells`, or [`UNTOUCHED`].
    cell_to_touched: Vec<u32>,
}

/// Position of cells that no facet touches.
const UNTOUCHED: u32 = u32::MAX;
/// Number of facets that a thread processes at once.
const FACETS_PER_CHUNK: usize = 128;

impl TouchedCells {
    /// Finds the cells whose box overlaps the box of a facet and whose vertices are not all on one side of its plane.
    /// Replaces the previous content.
    pub(crate) fn find<const D: usize>(&mut self, background: &SimplexMesh<D>, facets: &[Facet<D>]) {
        let index = background.cell_index();
        let touches = |facet: &Facet<D>, cell: CellId| {
            let mut below = false;
            let mut above = false;
            for x in background.simplex(cell).points() {
                let (distance, doubt) = facet.plane.distance(x);
                below |= distance <= doubt;
                above |= distance >= -doubt;
            }
            below && above
        };
        let pairs_of = |(chunk, facets): (usize, &[Facet<D>])| {
            let (mut pairs, mut near) = (Vec::new(), Vec::new());
            for (k, facet) in facets.iter().enumerate() {
                index.cells_overlapping(&facet.bounds, &mut near);
                let number = (chunk * FACETS_PER_CHUNK + k) as u32;
                pairs.extend(near.iter().filter(|&&cell| touches(facet, cell)).map(|&cell| (cell, number)));
            }
            pairs
        };
        let found: Vec<Vec<(CellId, u32)>> = facets.par_chunks(FACETS_PER_CHUNK).enumerate().map(pairs_of).collect();
        // Counting sort: the facets of a cell stay in ascending order. `cell_to_touched` first counts the facets of
        // each cell. `offsets[k + 1]` is first the start of row `k`, and is advanced to its end.
        let pairs = || found.iter().flatten().map(|&(cell, facet)| (cell.index(), facet));
        self.cell_to_touched.clear();
        self.cell_to_touched.resize(background.n_cells(), 0);
        pairs().for_each(|(cell, _)| self.cell_to_touched[cell] += 1);
        self.cells.clear();
        self.offsets.clear();
        self.offsets.push(0);
        let mut n_pairs = 0;
        for (cell, slot) in self.cell_to_touched.iter_mut().enumerate() {
            let count = std::mem::replace(slot, UNTOUCHED);
            if count > 0 {
                *slot = self.cells.len() as u32;
                self.cells.push(CellId::new(cell));
                self.offsets.push(n_pairs);
                n_pairs += count;
            }
        }
        self.facets.clear();
        self.facets.resize(n_pairs as usize, 0);
        for (cell, facet) in pairs() {
            let next = &mut self.offsets[self.cell_to_touched[cell] as usize + 1];
            self.facets[*next as usize] = facet;
            *next += 1;
        }
    }

    /// Returns the facets that may touch the cell at position `k` of the touched cells.
    pub(crate) fn facets(&self, k: usize) -> &[u32] {
        &self.facets[self.offsets[k] as usize..self.offsets[k + 1] as usize]
    }

    /// Returns the position of a cell among the touched cells, if it is one.
    pub(crate) fn position(&self, cell: CellId) -> Option<usize> {
        let k = self.cell_to_touched[cell.index()];
        (k != UNTOUCHED).then_some(k as usize)
    }
}
