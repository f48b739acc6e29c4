//! Cells near a box, and the cell that contains a point.

use super::parry::BoxTree;
use crate::{Aabb, CellId, MAX_CELL_VERTICES, Point, Simplex};

/// Barycentric coordinates above minus this value are inside.
const TOLERANCE: f64 = 1e-10;

/// Barycentric coordinates above this value are inside, and not on the boundary up to round-off.
const INSIDE: f64 = 1e-6;

/// Search structure for the cells of a mesh at fixed positions; see [`crate::SimplexMesh::cell_index`].
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
    /// Builds the index of the given cells.
    pub(crate) fn new(simplices: Vec<Simplex<D>>) -> Self {
        let tree = BoxTree::new(simplices.iter().map(|simplex| Aabb::of_points(simplex.points())));
        Self { simplices, tree }
    }

    /// Replaces `out` by all cells whose bounding boxes overlap `region`, in ascending order.
    ///
    /// Bounding boxes are slightly inflated: every cell that meets the region is found, and possibly a few others.
    pub fn cells_overlapping(&self, region: &Aabb<D>, out: &mut Vec<CellId>) {
        out.clear();
        self.tree.overlapping(region, |leaf| out.push(CellId(leaf)));
        out.sort_unstable();
    }

    /// Returns the first cell whose centroid lies inside another cell, with that cell. Cells that overlap by less than
    /// that are not found.
    pub fn overlapping_cells(&self) -> Option<[CellId; 2]> {
        let mut near = Vec::new();
        for (index, simplex) in self.simplices.iter().enumerate() {
            let (cell, centroid) = (CellId::new(index), simplex.centroid());
            self.cells_overlapping(&Aabb { low: centroid, high: centroid }, &mut near);
            let is_inside = |other: &&CellId| {
                let barycentric = self.simplices[other.index()].barycentric(&centroid);
                **other != cell && barycentric.is_some_and(|all| all[..=D].iter().all(|&l| l > INSIDE))
            };
            if let Some(other) = near.iter().find(is_inside) {
                return Some([cell, *other]);
            }
        }
        None
    }

    /// Returns the cell that contains the point, with the barycentric coordinates of the point.
    ///
    /// A cell contains the points whose barycentric coordinates are at least -1e-10, so that round-off does not open
    /// gaps between cells. If several cells contain the point, the one with the lowest id is returned.
    pub fn locate(&self, x: &Point<D>) -> Option<(CellId, [f64; MAX_CELL_VERTICES])> {
        let mut found: Option<(CellId, [f64; MAX_CELL_VERTICES])> = None;
        self.tree.overlapping(&Aabb { low: *x, high: *x }, |leaf| {
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
