//! Input of the cut of a single cell.

use mesh::SimplexMesh;

use crate::OverlayOptions;
use crate::exact::Planes;
use crate::surface::Facet;
use crate::touched::TouchedCells;

/// Data of an overlay on which the cut of a cell depends.
#[derive(Clone, Copy)]
pub(crate) struct Cutting<'a, const D: usize> {
    /// Planes of facets and of faces of the background, with exact predicates.
    pub(crate) planes: Planes<'a, D>,
    /// Cells that facets may touch.
    pub(crate) touched: &'a TouchedCells,
    /// Number of bodies around each vertex of the background.
    pub(crate) depth: &'a [i32],
    /// Smallest thickness, a length. Thinner fluid parts are left out. It is also the tolerance for pieces of faces.
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
        let largest_coordinate = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
        let planes = Planes { background, facets, resolution: 2.0 * f64::EPSILON * largest_coordinate };
        let size = mesh::equilateral_side::<D>(background.volume() / background.n_cells() as f64);
        // The second term is the round-off of the coordinates.
        Self { planes, touched, depth, thinnest: options.relative_tolerance * size + 4.0 * planes.resolution }
    }
}
