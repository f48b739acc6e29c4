//! Errors of this crate.

use std::path::PathBuf;

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum Error {
    /// A file cannot be read. Check its path and permissions.
    #[error("cannot read {}: {source}; check its path", .path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// A file is not text. Save it as UTF-8.
    #[error("{}:{line}: the file is not UTF-8; save it in that encoding", .path.display())]
    NotUtf8 {
        path: PathBuf,
        /// Line of the first invalid byte, from 1.
        line: usize,
    },
    /// A surface file is malformed.
    #[error("cannot read the surface {}: {problem}", .path.display())]
    Surface {
        path: PathBuf,
        /// Line or byte, and cause.
        problem: String,
    },
    /// A mesh file is malformed, or holds no mesh that can be used.
    #[error("cannot read the mesh {}: {problem}", .path.display())]
    MeshFile {
        path: PathBuf,
        /// Cause and remedy.
        problem: String,
    },
    /// A mesh or surface cannot be written to a file of this name.
    #[error("cannot write {}: {problem}", .path.display())]
    MeshOutput {
        path: PathBuf,
        /// Cause and remedy.
        problem: &'static str,
    },
    /// A grid of no cubes, or of too many.
    #[error("a grid of {n} cubes along each axis: choose `--grid` from 1 to {most}")]
    GridSize {
        /// Cubes along an axis.
        n: usize,
        most: usize,
    },
    /// A cut violates its identities: a fault of the program, not of the input.
    #[error(
        "the cut failed a consistency check: {identity} is violated by {by:.1e}; please report it with surface and command"
    )]
    Violated {
        /// The identity that is violated most.
        identity: &'static str,
        /// Relative error.
        by: f64,
    },
    /// A box of cubes around surfaces cannot be built. Choose another number of cubes.
    #[error("cannot put a grid around the surfaces: {0}")]
    Grid(mesh::Error),
    /// Surfaces that cannot cut a mesh. The cause contains body, facet and point.
    #[error("cannot cut by {}: {source}{}", listed(.paths), advice(.source))]
    Cut { paths: Vec<PathBuf>, source: cutcell::Error },
    /// A scenario that cannot be run. The cause contains file, line and key.
    #[cfg(feature = "simulation")]
    #[error(transparent)]
    Scenario(#[from] crate::scenario::ScenarioError),
    /// A scenario cannot be written as text.
    #[cfg(feature = "simulation")]
    #[error("cannot write the scenario as TOML: {0}")]
    Text(#[from] toml::ser::Error),
    /// A file cannot be written. Check the directory, its permissions and the space left.
    #[error("cannot write {}: {source}", .path.display())]
    Write { path: PathBuf, source: std::io::Error },
    /// A VTK file cannot be written.
    #[error("cannot write {}: {source}", .path.display())]
    Vtk { path: PathBuf, source: Box<vtkio::Error> },
    /// A summary cannot be written as JSON.
    #[error("cannot write the summary as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A directory without a file that every run writes.
    #[error("{} has no results of a run: {file} is missing; check its path", .directory.display())]
    NoResults { directory: PathBuf, file: &'static str },
    /// A file of results is damaged.
    #[error("{place}: {problem}; correct it, or run the scenario again")]
    Damaged {
        /// The file, with the line if it is a table.
        place: String,
        problem: String,
    },
    /// Two runs that cannot be compared.
    #[error("{} and {} have no {what} in common; compare runs of like scenarios", .first.display(), .second.display())]
    NothingCommon {
        first: PathBuf,
        second: PathBuf,
        /// Column or time.
        what: &'static str,
    },
    /// Two runs whose results have different units.
    #[error(
        "`{column}` is in {} in {} and in {} in {}; compare runs with the same units",
        .units[0], .directories[0].display(), .units[1], .directories[1].display()
    )]
    OtherUnit {
        column: String,
        /// Its units.
        units: [String; 2],
        directories: [PathBuf; 2],
    },
    /// The directory of results is a file.
    #[error("{} is a file, and the results need a directory; choose another one with `--out`", .path.display())]
    NotDirectory { path: PathBuf },
    /// A checkpoint cannot be used.
    #[error("cannot resume from {}: {problem}", .path.display())]
    Checkpoint { path: PathBuf, problem: String },
    /// A directory has no checkpoint from which a run could be resumed.
    #[error(
        "{} has no checkpoint; a run writes them if the scenario sets `output.checkpoint_every` or `output.checkpoint_minutes`, and when it is interrupted", .directory.display()
    )]
    NoCheckpoint { directory: PathBuf },
    /// A column that the tables of a run do not have.
    #[error("{} has no column `{column}`{advice} Known here: {known}", .directory.display())]
    NoColumn {
        directory: PathBuf,
        column: String,
        /// End of the sentence, with the nearest name if one is near.
        advice: String,
        /// Names of all columns.
        known: String,
    },
    /// A page cannot be written to a file of this name, which may be that of other data.
    #[error("cannot write {}: the page of `plot` is HTML; give `--out` a name that ends in .html", .path.display())]
    Page { path: PathBuf },
    /// Two runs that are compared with a tolerance end at different times.
    #[error("the runs end at the times {} and {}, and only their common time is compared; with a tolerance they must end at the same time", .ends[0], .ends[1])]
    Ends { ends: [f64; 2] },
    /// Two runs differ by more than is allowed.
    #[error("the column `{column}` differs by {difference:.3e}, and the tolerance is {tolerance:e}")]
    Differ {
        /// The column that differs most.
        column: String,
        /// Difference relative to its largest value.
        difference: f64,
        tolerance: f64,
    },
    /// A directory holds a run that has not come to its end, which a new one would remove.
    #[error(
        "{0} holds a run that was stopped at step {step}: resume it with `cutwater run --resume {0}`, choose another directory with `--out`, or \
         remove its files checkpoint-*.bin", .directory.display()
    )]
    Unfinished {
        directory: PathBuf,
        /// Step of its last checkpoint.
        step: usize,
    },
    /// A directory cannot take the results of a run.
    #[error("{} {problem}; choose another directory with `--out`, or replace the results in it with `--overwrite`", .path.display())]
    Directory { path: PathBuf, problem: &'static str },
    /// The copy of a scenario would replace the scenario itself.
    #[error("{} has the scenario that is run, which its copy with all changes would replace; choose another directory with `--out`", .path.display())]
    Input { path: PathBuf },
    /// Another run writes into a directory.
    #[error("another run writes into {}; choose another directory with `--out`", .path.display())]
    Busy { path: PathBuf },
    /// A run was stopped; it can be resumed.
    #[error("stopped after step {step}; resume it with `cutwater run --resume {}`", .directory.display())]
    Interrupted {
        directory: PathBuf,
        /// The last step.
        step: usize,
    },
    /// A step failed: its number, its time and the cause. Files are complete up to the step before.
    #[cfg(feature = "simulation")]
    #[error(transparent)]
    Step(#[from] solver::StepError),
}

/// Returns the remedy for an invalid surface, if the message of the cause does not contain one.
fn advice(error: &cutcell::Error) -> &'static str {
    match error {
        cutcell::Error::Inward { .. } => " (`--flip` does it)",
        cutcell::Error::Open { .. } => ": close it",
        cutcell::Error::NonManifold { .. } => ": divide the body there, or join its vertices differently",
        cutcell::Error::SelfIntersection { .. } => ": give the parts as separate bodies, or repair the surface",
        _ => "",
    }
}

/// Returns the files of bodies, with the indices of the bodies if there are several.
fn listed(paths: &[PathBuf]) -> String {
    match paths {
        [path] => path.display().to_string(),
        _ => {
            let named = |(body, path): (usize, &PathBuf)| format!("{} (body {body})", path.display());
            paths.iter().enumerate().map(named).collect::<Vec<_>>().join(", ")
        }
    }
}
