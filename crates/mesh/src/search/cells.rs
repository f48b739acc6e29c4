//! Cells near a box, and the cell that contains a point.

use super::parry::BoxTree;
use crate::{CellId, MAX_CELL_VERTICES, Point, Simplex, SimplexMesh};

/// Barycentric coordinates down to minus this count as inside.
const TOLERANCE: f64 = 1e-10;

/// The cells of a mesh at fixed positions, arranged for search.
#[derive(Clone)]
pub struct CellIndex<const D: usize> {
    simplices: Vec<Simplex<D>>,
    tree: BoxTree<D>,
}

impl<const D: usize> std::fmt::Debug for CellIndex<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CellIndex").field("n_cells", &self.simplices.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> CellIndex<D> {
    /// The cells of the mesh with its vertices at the given positions (one per vertex).
    ///
    /// # Panics
    /// If there are fewer positions than vertices.
    pub fn new(mesh: &SimplexMesh<D>, positions: &[Point<D>]) -> Self {
        let simplices: Vec<Simplex<D>> = mesh.cells().map(|cell| mesh.simplex_at(cell, positions)).collect();
        let tree = BoxTree::around(simplices.iter().map(Simplex::points));
        Self { simplices, tree }
    }

    /// Replaces `out` by all cells whose bounding boxes overlap the box from `min` to `max`, in ascending order.
    ///
    /// Boxes are inflated a little: no cell that meets the box is missing, a few that do not may be there.
    pub fn cells_overlapping(&self, min: &Point<D>, max: &Point<D>, out: &mut Vec<CellId>) {
        out.clear();
        self.tree.overlapping(min, max, |leaf| out.push(CellId(leaf)));
        out.sort_unstable();
    }

    /// The cell that contains the point and the barycentric coordinates of the point in it.
    ///
    /// A cell contains points with all barycentric coordinates above -1e-10, so that round-off opens no gaps between
    /// cells; of several such cells, the one with the lowest id is given.
    pub fn locate(&self, x: &Point<D>) -> Option<(CellId, [f64; MAX_CELL_VERTICES])> {
        let mut found: Option<(CellId, [f64; MAX_CELL_VERTICES])> = None;
        self.tree.overlapping(x, x, |leaf| {
            let cell = CellId(leaf);
            if found.is_some_and(|(lowest, _)| lowest < cell) {
                return;
            }
            if let Some(barycentric) = self.simplices[cell.index()].barycentric(x)
                && barycentric.iter().all(|&l| l >= -TOLERANCE)
            {
                found = Some((cell, barycentric));
            }
        });
        found
    }
}
