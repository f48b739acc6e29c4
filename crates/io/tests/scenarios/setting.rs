//! Scenarios, their errors and the results of their runs, for the tests of this crate.

use std::path::{Path, PathBuf};

use io::scenario::case::{Case, case};
use io::{Error, HistoryTable, ScenarioFile, Summary, run, sizes};
use vtkio::model::{DataSet, Piece, UnstructuredGridPiece, Vtk};

/// A cylinder that is moved up and down in a channel.
pub(crate) const CHANNEL: &str = include_str!("../../../../examples/oscillating-cylinder.toml");

/// An elastic ball that falls on a virtual barrier.
pub(crate) const BARRIER: &str = include_str!("../../../../validation/cases/virtual-barrier.toml");

/// A cube that falls in a closed box of fluid, one and a half times as dense.
pub(crate) const CUBE: &str = include_str!("../../../../examples/falling-cube.toml");

/// The line of [`CUBE`] that makes it free.
pub(crate) const FREE_CUBE: &str = "motion  = { kind = \"free\" }";

/// A plane below the cube; contact begins 3 cm below the place of the cube.
pub(crate) const FLOOR: &str = r#"
[[contact]]
body     = "cube"
law      = { kind = "penalty", gamma_contact_0 = 100.0 }
size     = 0.1
offset   = 0.05
obstacle = { kind = "rigid-plane", point = [0.0, 0.0, 0.45], normal = [0.0, 0.0, -1.0] }
"#;

/// A free ball on the axis of a closed cylinder of fluid.
pub(crate) const SPHERE: &str = r#"
name        = "sphere"
dimension   = 2
units       = "cgs"
coordinates = "axisymmetric"
time        = { step = 0.01, end = 0.05 }

[fluid]
density   = 1.0
viscosity = 0.5

[background]
kind     = "graded-box"
min      = [0.0, 0.0]
max      = [2.0, 3.0]
size     = 0.15
boundary = { left = "symmetry", right = "no-slip", top = "free", bottom = "no-slip" }

[[body]]
name    = "ball"
shape   = { kind = "half-ball", centre = [0.0, 1.5], radius = 0.5, size = 0.1 }
density = 2.0
gravity = [0.0, -100.0]
motion  = { kind = "free" }
"#;

/// An elastic block that falls on a plane and bounces.
pub(crate) const BOUNCING: &str = r#"
name      = "dry-block"
dimension = 2
units     = "si"

[time]
step = 1.0e-3
end  = 0.06

[[body]]
name             = "block"
shape            = { kind = "box", min = [0.0, 0.01], max = [1.0, 0.51], n = [4, 2] }
material         = { kind = "saint-venant-kirchhoff", mu = 4.0e5, lambda = 1.6e6 }
density          = 1000.0
gravity          = [0.0, -10.0]
initial_velocity = [0.0, -1.0]

[[contact]]
body     = "block"
law      = { kind = "penalty", gamma_contact_0 = 1.0e6 }
size     = 0.1
offset   = 0.005
obstacle = { kind = "rigid-plane", point = [0.0, 0.0], normal = [0.0, -1.0] }

[output]
vtk_every = 20

[solver]
newton = { tolerance = 1.0e-10, max_iterations = 30 }
linear = { kind = "direct" }
"#;

/// The line of [`BOUNCING`] that makes it elastic.
pub(crate) const BOUNCING_MATERIAL: &str =
    r#"material         = { kind = "saint-venant-kirchhoff", mu = 4.0e5, lambda = 1.6e6 }"#;

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
