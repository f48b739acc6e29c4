//! Errors of reading the files of a run and of writing its page.

use std::path::PathBuf;

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// Files of a run are missing or malformed, or a file cannot be written.
    #[error(transparent)]
    Results(#[from] io::Error),
    /// A file of frames is malformed. Run the scenario again.
    #[error("{} holds no frames of a run: {source}", .path.display())]
    Frames { path: PathBuf, source: serde_json::Error },
    /// Data cannot be written as JSON.
    #[error("cannot write data of the page as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A picture was requested of a run without frames: in three dimensions, or run without a report.
    #[error("{} holds no frames to draw: run the scenario in the plane, and not with `--no-report`", .path.display())]
    NoFrames { path: PathBuf },
    /// A picture cannot be encoded.
    #[error("cannot write {}: {source}", .path.display())]
    Picture { path: PathBuf, source: png::EncodingError },
}
