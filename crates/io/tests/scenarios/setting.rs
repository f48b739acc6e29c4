//! Scenarios, their errors and the results of their runs, for the tests of this crate.

use std::path::{Path, PathBuf};

use io::scenario::case::{Case, case};
use io::{Error, HistoryTable, ScenarioFile, Summary, run, sizes};
use vtkio::model::{DataSet, Piece, UnstructuredGridPiece, Vtk};

/// A cylinder that is moved up and down in a channel.
pub(crate) const CHANNEL: &str = include_str!("../../../../examples/oscillating-cylinder.toml");

/// An elastic ball that falls on a virtual barrier.
pub(crate) const BARRIER: &str = include_str!("../../../../validation/cases/virtual-barrier.toml");

pub(crate) fn parse_at(path: &Path, text: &str, sets: &[&[&str]]) -> Result<ScenarioFile, Error> {
    let sets: Vec<String> = sets.concat().into_iter().map(str::to_owned).collect();
    ScenarioFile::parse(path, text, &sets)
}

pub(crate) fn parse(text: &str, sets: &[&[&str]]) -> Result<ScenarioFile, Error> {
    parse_at(Path::new("case.toml"), text, sets)
}

pub(crate) fn legal(text: &str, sets: &[&[&str]]) -> ScenarioFile {
    parse(text, sets).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn planar_case(file: &ScenarioFile) -> Case<2> {
    case::<2>(file).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the error of a scenario, found while reading it or while building its meshes.
pub(crate) fn mistake(file: Result<ScenarioFile, Error>) -> Error {
    file.and_then(|file| sizes(&file)).expect_err("a mistake")
}

/// Expects an error that contains the words.
pub(crate) fn refused(text: &str, sets: &[&[&str]], words: &[&str]) {
    check_words(&mistake(parse(text, sets)).to_string(), words);
}

pub(crate) fn check_words(message: &str, words: &[&str]) {
    words.iter().for_each(|word| assert!(message.contains(word), "`{word}` is not in: {message}"));
}

/// Checks line, key and words of an error; the line is the one where a text begins.
pub(crate) fn check_place(error: Error, text: &str, begin: usize, key: &str, words: &[&str]) {
    let message = error.to_string();
    let Error::Scenario(error) = error else { panic!("not an error of the scenario: {message}") };
    let line = text[..begin].matches('\n').count() + 1;
    assert_eq!((error.at.line, error.at.key.as_str(), error.at.argument), (line, key, None), "{message}");
    assert!(message.contains(&format!("case.toml:{line}: {key}")), "{message}");
    check_words(&message, words);
}

/// Returns a path in the folder of the tests.
pub(crate) fn in_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME")).join(name)
}

/// Returns an empty directory for results.
pub(crate) fn fresh_directory(name: &str) -> PathBuf {
    let path = in_folder(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap_or_else(|e| panic!("{e}"));
    path
}

/// Writes a file for a test.
pub(crate) fn write(name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = in_folder(name);
    std::fs::create_dir_all(in_folder("")).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(&path, content).unwrap_or_else(|e| panic!("{e}"));
    path
}

pub(crate) fn results(file: &ScenarioFile, directory: &Path) -> Summary {
    run(file, directory, &mut ()).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the grid of a field file.
pub(crate) fn read_grid(path: &Path) -> UnstructuredGridPiece {
    let vtk = Vtk::import(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { panic!("not an unstructured grid") };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { panic!("no piece inline") };
    *piece
}

/// Returns the values of all probes of a run.
pub(crate) fn probes(directory: &Path) -> HistoryTable {
    HistoryTable::read(&directory.join("probes.csv")).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn history(directory: &Path) -> HistoryTable {
    HistoryTable::read(&directory.join("history.csv")).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn column(directory: &Path, name: &str) -> Vec<f64> {
    history(directory).column(name).unwrap_or_else(|| panic!("no column {name}"))
}

/// Checks that a scenario that was written as text is the same when it is read again.
pub(crate) fn check_text(file: &ScenarioFile) {
    let text = file.to_toml().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(legal(&text, &[]).scenario(), file.scenario());
}
