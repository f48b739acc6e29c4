//! Summary of a cut.

use std::time::Instant;

use cutcell::{CutMesh, OverlayTimes};
use mesh::SimplexMesh;

use super::CutErrors;
use super::identities::{check, quadratic_moment};

/// Summary of a cut. Lengths have the unit of the files of surfaces.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CutSummary {
    /// Cells of the background.
    pub cells: usize,
    /// Cells crossed by a surface.
    pub cut_cells: usize,
    /// Cells inside the bodies.
    pub covered_cells: usize,
    /// Largest number of fluid parts in one cell.
    pub parts_max: usize,
    /// Volume of the background.
    pub domain_volume: f64,
    /// Volume of the fluid, the sum of all parts.
    pub fluid_volume: f64,
    /// Volume of the part of the domain that the surfaces cover, the sum of all covered cells and pieces.
    pub solid_volume: f64,
    /// Area of the wet interface.
    pub surface_area: f64,
    /// Smallest fluid part of a cut cell, divided by the volume of the cell; one if no cell is cut.
    pub smallest_fraction: f64,
    /// Wall-clock time of the tasks.
    pub seconds: CutSeconds,
    /// Errors of the identities.
    pub max_relative_error: CutErrors,
}

/// Wall-clock time of the tasks, s, without reading files, building the background and checking identities.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CutSeconds {
    /// Checking the surfaces, finding the cells that they may cut, and the number of bodies around all other cells.
    pub classify: f64,
    /// Cutting cells into parts, and joining parts of neighbours.
    pub clip: f64,
    /// Quadrature of degree two on all fluid parts, with one integral over the fluid.
    pub quadrature: f64,
    /// Sum of all tasks.
    pub total: f64,
}

impl CutSummary {
    /// Measures a cut, and the time of quadrature. `overlay` has the times of the overlay.
    pub(super) fn new<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, overlay: OverlayTimes) -> Self {
        let begin = Instant::now();
        let moment = quadratic_moment(background, cut);
        let quadrature = begin.elapsed().as_secs_f64();
        let classify = (overlay.check + overlay.classify).as_secs_f64();
        let clip = (overlay.clip + overlay.join).as_secs_f64();
        let report = cut.report();
        let domain_volume = sum(background.cells().map(|cell| background.cell_volume(cell)));
        let fluid_volume = sum(cut.all_parts().map(|part| cut.part_volume(part)));
        Self {
            cells: background.n_cells(),
            cut_cells: report.n_cut_cells,
            covered_cells: report.n_covered_cells,
            parts_max: report.max_parts,
            domain_volume,
            fluid_volume,
            solid_volume: cut.covered_volume(background),
            surface_area: sum(cut.interface().iter().map(|piece| piece.measure)),
            smallest_fraction: report.smallest_fraction,
            seconds: CutSeconds { classify, clip, quadrature, total: classify + clip + quadrature },
            max_relative_error: check(background, cut, moment),
        }
    }

    /// Returns the summary as one JSON object on one line.
    ///
    /// # Errors
    /// [`crate::Error::Json`].
    pub fn to_json(&self) -> Result<String, crate::Error> {
        Ok(serde_json::to_string(self)?)
    }
}

/// Adds positive numbers with a round-off that is independent of how many there are (Neumaier 1974).
fn sum(numbers: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0_f64, 0.0);
    for number in numbers {
        let next = sum + number;
        lost += if sum >= number { (sum - next) + number } else { (number - next) + sum };
        sum = next;
    }
    sum + lost
}
