//! The binary: what it prints, what it leaves behind, how it exits.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn case() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/cases/virtual-barrier.toml")
}

fn cutwater(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cutwater"));
    command.args(&arguments[..1]).arg(case()).args(&arguments[1..]);
    for set in ["background.size=1.0", "body.0.shape.size=1.0", "time.end=0.003"] {
        command.args(["--set", set]);
    }
    command.output().expect("the binary starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn check_prints_sizes_and_runs_nothing() {
    let output = cutwater(&["check"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for word in ["background:", "body ball:", "unknowns", "steps: 3"] {
        assert!(printed.contains(word), "{printed}");
    }
}

#[test]
fn run_writes_into_the_directory_and_prints_lines() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("run");
    let shown = directory.display().to_string();
    let output = cutwater(&["run", "--out", &shown, "--timings"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    assert!(printed.contains("step 3/3") && printed.contains("d_min"), "{printed}");
    assert!(directory.join("history.csv").exists() && directory.join("summary.json").exists());
    let quiet = cutwater(&["run", "--out", &shown, "--quiet"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty());
}

/// Calls, and milliseconds per step, of the line of the table that begins with a name.
fn timing(printed: &str, name: &str) -> (usize, f64) {
    let begin = format!("{name} ");
    let line = printed.lines().find(|line| line.trim_start().starts_with(&begin)).unwrap_or_else(|| panic!("{name}"));
    let mut numbers = line.trim_start()[name.len()..].split_whitespace();
    let calls = numbers.next().and_then(|n| n.parse().ok()).expect("a number of calls");
    (calls, numbers.nth(1).and_then(|n| n.parse().ok()).expect("milliseconds"))
}

#[test]
fn timings_of_all_stages_and_contributions() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("timings");
    let output = cutwater(&["run", "--out", &directory.display().to_string(), "--timings", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for stage in ["cut", "space", "transfer", "pattern"] {
        assert_eq!(timing(&printed, stage).0, 3, "once per step: {printed}");
    }
    let (assemblies, assembly) = timing(&printed, "assembly");
    let iterations = timing(&printed, "linear solve").0;
    assert!(assemblies > iterations && iterations >= 3 && timing(&printed, "factorisation").0 >= 1, "{printed}");
    let contributions = [
        ("fluid cells", 3),
        ("fluid convection", assemblies),
        ("fluid faces", 3),
        ("solid internal work", assemblies),
        ("interface", 3),
    ];
    for (name, calls) in contributions {
        assert_eq!(timing(&printed, name).0, calls, "linear ones once per step: {printed}");
    }
    let of_contributions: f64 = contributions.iter().map(|(name, _)| timing(&printed, name).1).sum();
    assert!(0.0 < of_contributions && of_contributions <= assembly, "{printed}");
    // The picture at the end, the state at the start, and the steps.
    assert!(timing(&printed, "output").0 >= 4, "{printed}");
}

#[test]
fn bad_input_exits_with_2_and_the_place() {
    let output = cutwater(&["run", "--set", "fluid.viscosty=1.0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--set fluid.viscosty=1.0: fluid.viscosty: unknown key"));
}

#[test]
fn a_failed_run_exits_with_1_and_the_residuals() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("failed");
    let shown = directory.display().to_string();
    let output = cutwater(&["run", "--out", &shown, "--set", "solver.newton.max_iterations=1"]);
    assert_eq!(output.status.code(), Some(1));
    let printed = text(&output.stderr);
    assert!(printed.contains("relative residual") && printed.contains(&shown), "{printed}");
    assert!(directory.join("summary.json").exists());
}
