//! The directory of a run: results of one scenario, and one run at a time that writes into it.

use std::fs::{self, File, TryLockError};
use std::path::Path;

use crate::Error;
use crate::checkpoint::problem_text;
use crate::files::create_directory;
use crate::scenario::ScenarioFile;

/// File that marks a directory as one of results. A run holds a lock on it.
const MARKER: &str = ".cutwater";
/// Copy of the scenario with its changes.
const SCENARIO: &str = "scenario.toml";

/// A directory into which no other run writes while this value exists.
pub(crate) struct Claim {
    /// The lock ends when the file is closed.
    _lock: File,
}

impl Claim {
    /// Creates the directory if there is none, and claims it for a run of a scenario.
    ///
    /// # Errors
    /// [`Error::Directory`]: another run writes into it; unless `overwrites` is set, it has other files, or results of another scenario.
    /// [`Error::Write`].
    pub(crate) fn new(directory: &Path, file: &ScenarioFile, overwrites: bool) -> Result<Self, Error> {
        let refused = |problem: &'static str| Error::Directory { path: directory.to_owned(), problem };
        let marker = directory.join(MARKER);
        if !overwrites && has_files(directory) {
            // Results of earlier versions have no marker.
            let is_run =
                marker.is_file() || [SCENARIO, "history.csv"].iter().all(|name| directory.join(name).is_file());
            if !is_run {
                return Err(refused("has files that are not those of a run"));
            }
            let copy = ScenarioFile::read(&directory.join(SCENARIO), &[]);
            if copy.is_ok_and(|copy| problem_text(&copy).ok() != problem_text(file).ok()) {
                return Err(refused("has the results of another scenario"));
            }
        }
        create_directory(directory)?;
        let written = |source| Error::Write { path: marker.clone(), source };
        let lock = File::create(&marker).map_err(written)?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { _lock: lock }),
            Err(TryLockError::WouldBlock) => Err(Error::Busy { path: directory.to_owned() }),
            Err(TryLockError::Error(source)) => Err(written(source)),
        }
    }
}

/// Returns whether a directory exists and is not empty.
fn has_files(directory: &Path) -> bool {
    fs::read_dir(directory).is_ok_and(|mut entries| entries.next().is_some())
}

/// Refuses a directory in which the copy of the scenario would replace the scenario itself.
///
/// # Errors
/// [`Error::Directory`].
pub(crate) fn keep_input(directory: &Path, input: &Path) -> Result<(), Error> {
    let is_input =
        |path: &Path| fs::canonicalize(path).ok().zip(fs::canonicalize(input).ok()).is_some_and(|(a, b)| a == b);
    if is_input(&directory.join(SCENARIO)) {
        let problem = "has the scenario that is run, which its copy with all changes would replace";
        return Err(Error::Directory { path: directory.to_owned(), problem });
    }
    Ok(())
}
