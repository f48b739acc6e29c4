//! Counts and quality measures of a cut.

/// Fraction of the volume of the cell below which a fluid part is a sliver.
pub const SLIVER: f64 = 1e-6;

/// Counts and quality measures of a cut. No value indicates an error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutReport {
    /// Cells in the state `Fluid`.
    pub n_fluid_cells: usize,
    /// Cells in the state `Cut`.
    pub n_cut_cells: usize,
    /// Cells in the state `Covered`.
    pub n_covered_cells: usize,
    /// Largest number of fluid parts in one cell.
    pub max_parts: usize,
    /// Smallest ratio of the volume of a part to the volume of its cell; one if no cell is cut.
    pub smallest_fraction: f64,
    /// Fluid parts smaller than [`SLIVER`] times their cell.
    pub n_slivers: usize,
    /// Fluid parts left out because they are too thin, see [`crate::OverlayOptions::relative_tolerance`], or by
    /// [`crate::CutMesh::without_parts`].
    pub n_left_out: usize,
    /// Facets with interface pieces on faces of the background.
    pub n_aligned_facets: usize,
    /// Interface pieces on faces of the background.
    pub n_aligned_pieces: usize,
    /// Measure of faces between fluid and body without a facet; zero up to round-off for valid input.
    pub uncovered_measure: f64,
}
