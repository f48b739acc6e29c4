//! An overlay, task by task, in memory that is used again.

use std::ops::Range;
use std::time::{Duration, Instant};

use mesh::{Placed, SimplexMesh};
use rayon::prelude::*;

use crate::cell::{CellCut, Kept};
use crate::classify::depths;
use crate::cutting::Cutting;
use crate::faces::Faces;
use crate::surface::{self, Facet};
use crate::touched::TouchedCells;
use crate::{CutMesh, Error, OverlayOptions};

/// A cutter of meshes for repeated cuts. It keeps the memory that grows with the number of cut cells, and
/// the memory of results that are returned to [`Cutter::recycle`].
///
/// ```
/// use cutcell::{OverlayOptions, Cutter};
/// use mesh::{Placed, generate::structured_box};
///
/// let background = structured_box::<2>([0.0, 0.0], [4.0, 4.0], [8, 8])?;
/// let mut square = structured_box::<2>([1.1, 1.2], [2.3, 3.1], [3, 5])?;
/// let boundary = square.boundary();
/// let mut positions = square.vertices().to_vec();
/// let mut cutter = Cutter::new();
/// for step in 0..3 {
///     let cut = cutter.overlay(&background, &[Placed::new(&boundary, &positions)], &OverlayOptions::new())?;
///     assert!((cut.fluid_volume() - (16.0 - 1.2 * 1.9)).abs() < 1e-12);
///     cutter.recycle(cut);
///     positions.iter_mut().for_each(|x| x[0] += 0.1);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Cutter<const D: usize> {
    facets: Vec<Facet<D>>,
    touched: TouchedCells,
    depth: Vec<i32>,
    pub(crate) batches: Vec<Batch<D>>,
    pub(crate) sides: [CellCut<D>; 2],
    spare: Option<CutMesh<D>>,
    times: OverlayTimes,
}

/// Touched cells that one thread cuts in sequence.
#[derive(Debug, Default)]
pub(crate) struct Batch<const D: usize> {
    cut: CellCut<D>,
    pub(crate) kept: Kept<D>,
}

/// Wall-clock times of the tasks of an overlay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OverlayTimes {
    /// Check of the surfaces.
    pub check: Duration,
    /// Search for cells that facets may touch, and number of bodies around each vertex.
    pub classify: Duration,
    /// Cut of these cells.
    pub clip: Duration,
    /// Numbering of parts, and their connection on the faces of the background.
    pub join: Duration,
}

impl<const D: usize> Cutter<D> {
    /// Creates a cutter without memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// Cuts a background mesh as [`CutMesh::overlay`] does.
    ///
    /// # Errors
    /// See [`CutMesh::overlay`].
    pub fn overlay(
        &mut self,
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        options: &OverlayOptions,
    ) -> Result<CutMesh<D>, Error> {
        let start = Instant::now();
        surface::collect(background, surfaces, options, &mut self.facets)?;
        self.times.check = start.elapsed();
        let start = Instant::now();
        self.touched.find(background, &self.facets);
        depths(background, &self.facets, &self.touched, &mut self.depth);
        self.times.classify = start.elapsed();
        let facets = std::mem::take(&mut self.facets);
        let touched = std::mem::take(&mut self.touched);
        let depth = std::mem::take(&mut self.depth);
        let cut = self.cut(&Cutting::new(background, &facets, &touched, &depth, options));
        (self.facets, self.touched, self.depth) = (facets, touched, depth);
        Ok(cut)
    }

    /// Cuts all touched cells.
    pub(crate) fn cut(&mut self, cutting: &Cutting<'_, D>) -> CutMesh<D> {
        let start = Instant::now();
        let n_cells = cutting.touched.cells.len();
        let n_batches = n_cells.div_ceil(CELLS_PER_BATCH).min(BATCHES_PER_THREAD * rayon::current_num_threads());
        self.batches.resize_with(n_batches.max(self.batches.len()), Batch::default);
        let cells_of =
            |batch: usize| -> Range<usize> { batch * n_cells / n_batches..(batch + 1) * n_cells / n_batches };
        self.batches[..n_batches].par_iter_mut().enumerate().for_each(|(batch, Batch { cut, kept })| {
            kept.clear();
            for k in cells_of(batch) {
                cut.cut(cutting, k);
                cut.keep(&cutting.planes, cutting.touched.cells[k], kept);
            }
        });
        self.times.clip = start.elapsed();
        let start = Instant::now();
        let mut mesh = self.spare.take().unwrap_or_default();
        mesh.clear();
        let kept: Vec<&Kept<D>> = self.batches[..n_batches].iter().map(|batch| &batch.kept).collect();
        mesh.add_cells(cutting, &kept);
        Faces::new(cutting, &kept).add_to(&mut mesh, &mut self.sides);
        self.times.join = start.elapsed();
        mesh
    }

    /// Keeps the memory of a cut mesh for the next overlay.
    pub fn recycle(&mut self, cut: CutMesh<D>) {
        self.spare = Some(cut);
    }

    /// Returns the times of the last overlay.
    pub fn times(&self) -> OverlayTimes {
        self.times
    }
}

impl<const D: usize> CutMesh<D> {
    /// Cuts a background mesh by the closed surfaces of any number of bodies.
    ///
    /// Bodies may touch and overlap each other and extend beyond the background; fluid is the background without
    /// their union. Facets on the boundary of the background have no fluid in front of them; facets on an interior face
    /// of the background belong to the cell on the fluid side.
    ///
    /// # Errors
    /// See [`Error`]: surfaces that are empty, open, non-manifold, oriented inwards, self-intersecting, not finite, or
    /// too far away.
    pub fn overlay(
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        options: &OverlayOptions,
    ) -> Result<Self, Error> {
        Cutter::new().overlay(background, surfaces, options)
    }
}

/// Smallest number of cells of a batch.
const CELLS_PER_BATCH: usize = 32;
/// Number of batches of cells per thread. Several batches balance the load, since cells with many facets are often
/// neighbours.
const BATCHES_PER_THREAD: usize = 8;
