//! A self-contained page for the results of a run: `report.html`.
//!
//! The page opens from the file system without a network. It contains the scenario, the animation, fields at chosen
//! moments, interactive histories (drawn by uPlot), contacts, energies and timings. A [`Recorder`] attached to the run
//! collects the frames of the animation; everything else is read from the files of the run, so the page can be written
//! again later.
//!
//! ```no_run
//! use io::{ScenarioFile, run};
//! use report::Recorder;
//!
//! let directory = "results".as_ref();
//! let mut recorder = Recorder::new(directory);
//! run(&ScenarioFile::read("scenario.toml".as_ref(), &[])?, directory, &mut recorder)?;
//! recorder.write(directory)?;
//! report::write(directory)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balances;
mod chart;
mod error;
mod frames;
pub mod html;
mod page;
mod picture;
pub mod plane;
mod raster;
mod results;

use std::path::{Path, PathBuf};

pub use chart::{Chart, Curve};
pub use error::Error;
pub use frames::{Frames, Packed, Recorder, Snapshot};
pub use html::{Page, Section};
pub use page::run_as_html;
pub use picture::write_picture;
pub use raster::Raster;
pub use results::Results;

/// Removes the page and the frames of an earlier run from a directory of results. Frames that belong to checkpoints
/// stay, since a run may resume from them.
///
/// # Errors
/// [`Error::Results`]: a file cannot be removed.
pub fn remove(directory: &Path) -> Result<(), Error> {
    for path in ["report.html", frames::FILE].map(|name| directory.join(name)) {
        if path.is_file() {
            std::fs::remove_file(&path).map_err(|source| io::Error::Write { path, source })?;
        }
    }
    let checkpoints = io::checkpoint_steps(directory);
    frames::remove_stored(directory, |step| !checkpoints.contains(&step))
}

/// Writes `report.html` into a directory of results and returns its path.
///
/// # Errors
/// [`Error`]: files of the run are missing or malformed, or the page cannot be written.
pub fn write(directory: &Path) -> Result<PathBuf, Error> {
    let results = Results::read(directory)?;
    let path = directory.join("report.html");
    Page { title: results.summary.case.clone(), lead: page::lead(&results), sections: page::page_sections(&results)? }
        .write(&path)?;
    Ok(path)
}
