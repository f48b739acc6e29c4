//! Summary of a cut.

use std::time::Instant;

use cutcell::{CutMesh, OverlayTimes};
use mesh::SimplexMesh;

use super::CutErrors;
use super::identities::{self, Moments};
use super::sum::Sum;

/// Summary of a cut. Lengths are those of the surfaces' files.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "simulation", derive(serde::Serialize, serde::Deserialize))]
pub struct CutSummary {
    /// Cells of the background.
    pub cells: usize,
    /// Cells crossed by a surface.
    pub cut_cells: usize,
    /// Cells inside the bodies.
    pub covered_cells: usize,
    /// Most fluid parts in one cell.
    pub parts_max: usize,
    /// Volume of the background.
    pub domain_volume: f64,
    /// Volume of the fluid, the sum of all parts.
    pub fluid_volume: f64,
    /// Volume of the domain without the fluid.
    pub solid_volume: f64,
    /// Area of the wet interface.
    pub surface_area: f64,
    /// Smallest part of a cut cell over its cell; one if nothing is cut.
    pub smallest_fraction: f64,
    /// Wall time of the stages.
    pub seconds: CutSeconds,
    /// How far identities are violated.
    pub max_relative_error: CutErrors,
}

/// Wall time of the stages, s. Reading, building the background and the identities are not in it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "simulation", derive(serde::Serialize, serde::Deserialize))]
pub struct CutSeconds {
    /// Checking the surfaces, and finding which cells they may cut and how many bodies surround the others.
    pub classify: f64,
    /// Cutting cells into parts, and joining parts of neighbours.
    pub clip: f64,
    /// Quadrature of degree two on all fluid parts, with one integral over them.
    pub quadrature: f64,
    /// All of it.
    pub total: f64,
}

impl CutSeconds {
    /// The stages of an overlay, and of the quadrature after it.
    fn of_overlay(overlay: OverlayTimes, quadrature: f64) -> Self {
        let classify = (overlay.check + overlay.classify).as_secs_f64();
        let clip = (overlay.clip + overlay.join).as_secs_f64();
        Self { classify, clip, quadrature, total: classify + clip + quadrature }
    }
}

impl CutSummary {
    /// Measures a cut whose overlay took that long.
    pub(super) fn new<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, overlay: OverlayTimes) -> Self {
        let begin = Instant::now();
        let moments = Moments::new(background, cut);
        let quadrature_seconds = begin.elapsed().as_secs_f64();
        let report = cut.report();
        let domain_volume = Sum::of(background.cells().map(|cell| background.cell_volume(cell)));
        let fluid_volume = Sum::of(cut.all_parts().map(|part| cut.part_volume(part)));
        Self {
            cells: background.n_cells(),
            cut_cells: report.n_cut_cells,
            covered_cells: report.n_covered_cells,
            parts_max: report.max_parts,
            domain_volume,
            fluid_volume,
            solid_volume: domain_volume - fluid_volume,
            surface_area: Sum::of(cut.interface().iter().map(|piece| piece.measure)),
            smallest_fraction: report.smallest_fraction,
            seconds: CutSeconds::of_overlay(overlay, quadrature_seconds),
            max_relative_error: identities::check(background, cut, &moments),
        }
    }

    /// The summary as one JSON object on one line.
    ///
    /// # Errors
    /// [`crate::Error::Json`].
    #[cfg(feature = "simulation")]
    pub fn to_json(&self) -> Result<String, crate::Error> {
        Ok(serde_json::to_string(self)?)
    }
}
