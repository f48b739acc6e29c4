//! What an overlay found.

/// Fraction of its cell below which a fluid part is called a sliver.
pub const SLIVER: f64 = 1e-6;

/// Counts and qualities of a cut; nothing in here is an error.
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
    /// Smallest ratio of the volume of a part to the volume of its cell; one if nothing is cut.
    pub smallest_fraction: f64,
    /// Fluid parts smaller than [`SLIVER`] of their cell.
    pub n_slivers: usize,
    /// Fluid parts left out because they are too thin, see [`crate::OverlayOptions::relative_tolerance`].
    pub n_left_out: usize,
    /// Facets with an interface piece on a face of the background.
    pub n_aligned_facets: usize,
    /// Interface pieces on faces of the background.
    pub n_aligned_pieces: usize,
    /// Measure of faces between fluid and body that no facet covers; zero up to round-off for sound input.
    pub uncovered_measure: f64,
}
