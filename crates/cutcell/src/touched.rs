//! The broad phase: which cells a facet may touch.

use mesh::{CellId, SimplexMesh};
use rayon::prelude::*;

use crate::surface::Facet;

/// Cells that facets may touch, with those facets.
#[derive(Debug, Default)]
pub(crate) struct TouchedCells {
    pub(crate) cells: Vec<CellId>,
    offsets: Vec<u32>,
    facets: Vec<u32>,
    cell_to_touched: Vec<u32>,
    pairs: Vec<(CellId, u32)>,
}

const UNTOUCHED: u32 = u32::MAX;
/// Facets that a thread looks at in one go.
const FACETS_PER_CHUNK: usize = 128;

impl TouchedCells {
    /// Finds the cells that any of the facets may touch.
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
                index.cells_overlapping(&facet.low, &facet.high, &mut near);
                let number = (chunk * FACETS_PER_CHUNK + k) as u32;
                pairs.extend(near.iter().filter(|&&cell| touches(facet, cell)).map(|&cell| (cell, number)));
            }
            pairs
        };
        let found: Vec<Vec<(CellId, u32)>> = facets.par_chunks(FACETS_PER_CHUNK).enumerate().map(pairs_of).collect();
        self.pairs.clear();
        found.iter().for_each(|pairs| self.pairs.extend_from_slice(pairs));
        self.pairs.par_sort_unstable();
        self.cells.clear();
        self.offsets.clear();
        self.offsets.push(0);
        self.facets.clear();
        self.facets.extend(self.pairs.iter().map(|pair| pair.1));
        self.cell_to_touched.clear();
        self.cell_to_touched.resize(background.n_cells(), UNTOUCHED);
        let mut end = 0;
        for group in self.pairs.chunk_by(|a, b| a.0 == b.0) {
            self.cell_to_touched[group[0].0.index()] = self.cells.len() as u32;
            self.cells.push(group[0].0);
            end += group.len() as u32;
            self.offsets.push(end);
        }
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
