//! Text in, files out: scenarios, histories, field files and pictures.
//!
//! This is the only crate that knows a file format. The half that needs the solver sits behind the default feature
//! `simulation`. A run in three lines:
//!
//! ```no_run
//! use io::{RunOptions, ScenarioFile, run};
//! let scenario = ScenarioFile::read("validation/cases/virtual-barrier.toml".as_ref(), &[])?;
//! let summary = run(&scenario, RunOptions::into_directory("results"))?;
//! # Ok::<(), io::Error>(())
//! ```

pub mod cut;
pub mod surface;
pub mod vtk;

mod error;
mod files;

#[cfg(feature = "simulation")]
mod diagnostics;
#[cfg(feature = "simulation")]
mod forces;
#[cfg(feature = "simulation")]
pub mod history;
#[cfg(feature = "simulation")]
mod measures;
#[cfg(feature = "simulation")]
pub mod plot;
#[cfg(feature = "simulation")]
pub mod report;
#[cfg(feature = "simulation")]
mod run;
#[cfg(feature = "simulation")]
pub mod scenario;
#[cfg(feature = "simulation")]
pub mod summary;

pub use error::Error;
#[cfg(feature = "simulation")]
pub use forces::FluidForce;
#[cfg(feature = "simulation")]
pub use history::{History, HistoryTable};
#[cfg(feature = "simulation")]
pub use measures::BodyMeasures;
#[cfg(feature = "simulation")]
pub use run::{RunOptions, Sizes, StepProgress, default_directory, run, sizes};
#[cfg(feature = "simulation")]
pub use scenario::ScenarioFile;
#[cfg(feature = "simulation")]
pub use summary::{Comparison, Summary, SummarySeconds, Timing};
