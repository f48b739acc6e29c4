//! `cargo xtask verify`: exact solutions, output files read back, long property suites.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::process::{Outcome, cargo, root, succeeds, target};
use crate::python::python_with;

/// Number of random placements for each of the twelve properties of `cutcell`, quick and full.
const CUTCELL_CASES: [&str; 2] = ["2000", "100000"];
/// Largest grid and number of placements of each scanned surface, quick and full.
const SURFACES: [[&str; 2]; 2] = [["10", "2"], ["40", "20"]];

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Checks to run: `cutcell` (long property suite), `vtk` (files read by VTK), or an entry of the `validation`
    /// binary; everything if none is given.
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Run the short version (default).
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Run the long version.
    #[arg(long)]
    full: bool,
    /// Write the measured values into the book: docs/src/verification/NAME.md, with charts.
    #[arg(long)]
    document: bool,
    /// Folder of the results.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let out = std::path::absolute(arguments.out.clone().unwrap_or_else(|| target().join("verification")))?;
    let all = arguments.names.is_empty();
    let is_requested = |name: &str| all || arguments.names.iter().any(|n| n == name);
    let mut good = true;
    if is_requested("cutcell") {
        good &= verify_cutcell(arguments.full)?;
    }
    if is_requested("vtk") {
        good &= verify_vtk(&out)?;
    }
    let others: Vec<&String> = arguments.names.iter().filter(|n| !["cutcell", "vtk"].contains(&n.as_str())).collect();
    if all || !others.is_empty() {
        let mut command = validation("verify");
        command.args(others).arg(if arguments.full { "--full" } else { "--quick" }).arg("--out").arg(&out);
        command.args(arguments.document.then_some("--document"));
        good &= succeeds(&mut command)?;
    }
    Ok(good)
}

fn validation(mode: &str) -> Command {
    cargo(&["run", "--release", "--quiet", "--package", "validation", "--", mode])
}

/// Runs the property suite of `cutcell` with more random placements than `cargo test`, and scanned surfaces at more
/// places. The full suite uses a different seed in every run; set `CUTCELL_SEED` to repeat a run.
fn verify_cutcell(full: bool) -> Outcome {
    let cases = CUTCELL_CASES[usize::from(full)];
    let fresh = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(7, |time| time.as_secs() % 1_000_000);
    let seed = std::env::var("CUTCELL_SEED").unwrap_or_else(|_| if full { fresh() } else { 7 }.to_string());
    println!("# cutcell: twelve properties over {cases} random placements each, CUTCELL_SEED={seed}");
    let mut properties =
        cargo(&["test", "--release", "--package", "cutcell", "--test", "properties", "--test", "degenerate"]);
    let good = succeeds(properties.env("CUTCELL_CASES", cases).env("CUTCELL_SEED", seed))?;
    let [grid, placements] = SURFACES[usize::from(full)];
    println!("# cutcell: scanned surfaces in boxes of up to {grid}³ cubes, {placements} placements each");
    let mut surfaces = cargo(&["test", "--release", "--package", "io", "--test", "surfaces", "--", "--nocapture"]);
    Ok(good & succeeds(surfaces.env("SURFACE_GRID", grid).env("SURFACE_PLACEMENTS", placements))?)
}

/// Runs a short case and reads its files with VTK's own Python reader, in a virtual environment.
fn verify_vtk(out: &Path) -> Outcome {
    println!("# vtk: files of a short run, read by VTK");
    let Some(python) = python_with("python-vtk", &["vtk"], "import vtkmodules.vtkIOXML")? else {
        println!("failed: cannot create a Python environment with the package vtk (python3 -m venv, pip install vtk)");
        return Ok(false);
    };
    let run = out.join("vtk");
    let mut files = validation("verify");
    files.args(["files", "--quick", "--out"]).arg(&run);
    if !succeeds(&mut files)? {
        return Ok(false);
    }
    succeeds(Command::new(python).arg(root().join("validation/check_vtk.py")).arg(run.join("files")))
}
