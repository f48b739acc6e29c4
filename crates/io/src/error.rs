//! What can go wrong between text and files.

use std::path::PathBuf;

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file cannot be read. Check its path and permissions.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not text. Save it as UTF-8.
    #[error("{}:{line}: the file is not UTF-8; save it in that encoding", .path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// Line of the first byte that is not, from 1.
        line: usize,
    },
    /// A surface file is malformed.
    #[error("cannot read the surface {}: {malformed}", .path.display())]
    Surface {
        /// The file.
        path: PathBuf,
        /// Where and what.
        malformed: crate::surface::Malformed,
    },
    /// A scenario cannot be run; file, line and key are inside.
    #[cfg(feature = "simulation")]
    #[error(transparent)]
    Scenario(#[from] crate::scenario::ScenarioError),
    /// A scenario cannot be written as text.
    #[cfg(feature = "simulation")]
    #[error("cannot write the scenario as TOML: {0}")]
    Text(#[from] toml::ser::Error),
    /// A file cannot be written. Check the directory, its permissions and the space left.
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A VTK file cannot be written.
    #[error("cannot write {}: {source}", .path.display())]
    Vtk {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<vtkio::Error>,
    },
    /// A report cannot be written as JSON.
    #[cfg(feature = "simulation")]
    #[error("cannot write the summary as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A picture cannot be drawn.
    #[error("cannot draw {}: {message}", .path.display())]
    Plot {
        /// The file.
        path: PathBuf,
        /// What the plotting library says.
        message: String,
    },
    /// A step failed; the stage is inside. Files up to the step before are complete.
    #[cfg(feature = "simulation")]
    #[error(transparent)]
    Step(#[from] solver::StepError),
}
