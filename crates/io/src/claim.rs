//! Exclusive use of a directory of results by one run of one scenario.

use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::Path;

use crate::Error;
use crate::checkpoint::problem_text;
use crate::files::create_directory;
use crate::history::TABLES;
use crate::scenario::ScenarioFile;

/// File that marks a directory as one of results. A run holds a lock on it.
const MARKER: &str = ".cutwater";
/// Copy of the scenario with its changes.
const SCENARIO: &str = "scenario.toml";

/// A directory into which no other run writes while this value exists.
pub(crate) struct Claim {
    /// Closing the file releases the lock.
    _lock: File,
}

impl Claim {
    /// Creates the directory if there is none, and claims it for a run of a scenario.
    ///
    /// # Errors
    /// [`Error::NotDirectory`]: it is a file. [`Error::Busy`]: another run writes into it. [`Error::Directory`]:
    /// without `overwrites`, it has other files, or results of another scenario. [`Error::Write`].
    pub(crate) fn new(directory: &Path, file: &ScenarioFile, overwrites: bool) -> Result<Self, Error> {
        if directory.is_file() {
            return Err(Error::NotDirectory { path: directory.to_owned() });
        }
        let marker = directory.join(MARKER);
        let is_marked = marker.is_file();
        let is_foreign = !is_marked && has_files(directory);
        create_directory(directory)?;
        let written = |source| Error::Write { path: marker.clone(), source };
        let lock = File::create(&marker).map_err(written)?;
        match lock.try_lock() {
            Ok(()) => {}
            // Some file systems have no locks.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::WouldBlock) => return Err(Error::Busy { path: directory.to_owned() }),
            Err(TryLockError::Error(source)) => return Err(written(source)),
        }
        let checked = if overwrites { Ok(()) } else { check(directory, is_foreign, file) };
        if checked.is_err() && !is_marked {
            fs::remove_file(&marker).map_err(written)?;
        }
        checked.map(|()| Self { _lock: lock })
    }
}

/// Checks that a directory has no files but those of an earlier run of the same scenario.
fn check(directory: &Path, is_foreign: bool, file: &ScenarioFile) -> Result<(), Error> {
    let refused = |problem: &'static str| Err(Error::Directory { path: directory.to_owned(), problem });
    let copy = directory.join(SCENARIO);
    // Results of earlier versions have no marker.
    if is_foreign && !(copy.is_file() && directory.join(TABLES[0]).is_file()) {
        return refused("has files that are not those of a run");
    }
    if !copy.is_file() {
        return Ok(());
    }
    let is_same = ScenarioFile::read(&copy, &[]).and_then(|copy| Ok(problem_text(&copy)? == problem_text(file)?));
    if is_same.unwrap_or(false) { Ok(()) } else { refused("has the results of another scenario") }
}

/// Returns whether a directory exists and is not empty.
fn has_files(directory: &Path) -> bool {
    fs::read_dir(directory).is_ok_and(|mut entries| entries.next().is_some())
}

/// Returns an error for a directory in which the copy of the scenario would replace the scenario itself.
///
/// # Errors
/// [`Error::Input`].
pub(crate) fn keep_input(directory: &Path, input: &Path) -> Result<(), Error> {
    let is_input =
        |path: &Path| fs::canonicalize(path).ok().zip(fs::canonicalize(input).ok()).is_some_and(|(a, b)| a == b);
    if is_input(&directory.join(SCENARIO)) { Err(Error::Input { path: directory.to_owned() }) } else { Ok(()) }
}
