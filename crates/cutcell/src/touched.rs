//! The broad phase: which cells a facet may touch.

use mesh::{CellId, SimplexMesh};

use crate::surface::Facet;

/// Cells that facets may touch, with those facets.
pub(crate) struct TouchedCells {
    pub(crate) cells: Vec<CellId>,
    offsets: Vec<u32>,
    facets: Vec<u32>,
    cell_to_touched: Vec<u32>,
}

const UNTOUCHED: u32 = u32::MAX;

impl TouchedCells {
    pub(crate) fn new<const D: usize>(background: &SimplexMesh<D>, facets: &[Facet<D>]) -> Self {
        let mut pairs: Vec<(CellId, u32)> = Vec::new();
        let mut near = Vec::new();
        for (index, facet) in facets.iter().enumerate() {
            near.clear();
            background.cell_index().cells_overlapping(&facet.low, &facet.high, &mut near);
            for &cell in &near {
                let corners = background.simplex(cell);
                let mut below = false;
                let mut above = false;
                for x in corners.points() {
                    let (distance, doubt) = facet.plane.distance(x);
                    below |= distance <= doubt;
                    above |= distance >= -doubt;
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
