//! Reads scenarios and meshes; writes histories, checkpoints and field files.
//!
//! Modules that use the solver are compiled with the default feature
//! `simulation`. A run in three lines:
//!
//! ```no_run
//! use io::{ScenarioFile, run};
//! let scenario = ScenarioFile::read("validation/cases/virtual-barrier.toml".as_ref(), &[])?;
//! let summary = run(&scenario, "results".as_ref(), &mut ())?;
//! # Ok::<(), io::Error>(())
//! ```

// Compiles the code of the guide.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/src/guides/add-an-output-quantity.md")]
struct GuideCode;

pub mod cut;
pub mod gmsh;
pub mod mesh_file;
pub mod surface;
pub mod vtk;

mod error;
mod files;

#[cfg(feature = "simulation")]
mod checkpoint;
#[cfg(feature = "simulation")]
mod claim;
#[cfg(feature = "simulation")]
mod energies;
#[cfg(feature = "simulation")]
mod history;
#[cfg(feature = "simulation")]
mod measures;
#[cfg(feature = "simulation")]
mod memory;
#[cfg(feature = "simulation")]
mod pressures;
#[cfg(feature = "simulation")]
pub mod probes;
#[cfg(feature = "simulation")]
mod run;
#[cfg(feature = "simulation")]
mod run_tables;
#[cfg(feature = "simulation")]
pub mod scenario;

mod sizes;
#[cfg(feature = "simulation")]
mod summary;
#[cfg(feature = "simulation")]
mod warnings;
#[cfg(feature = "simulation")]
mod watch;

pub use error::Error;
pub use files::{read_text, write_whole};
#[cfg(feature = "simulation")]
pub use {
    checkpoint::{checkpoint_steps, checkpoint_time},
    history::{HistoryTable, TABLES, name_and_unit},
    measures::{distance, leading_body},
    run::{RunOptions, default_directory, run},
    run_tables::{Difference, RunTables, results_file},
    scenario::{Case, ScenarioFile},
    sizes::{Sizes, sizes},
    summary::{Summary, Timing},
    watch::{Begin, Progress, StepProgress, Watch},
};
