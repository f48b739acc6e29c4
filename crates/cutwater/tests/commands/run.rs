//! Output, files and exit codes of the binary.

use std::path::Path;
use std::process::Output;

use crate::setting::{case, command, file, fresh, succeeded, text};

/// Runs a command with the case on a coarse mesh, in three steps.
fn cutwater(arguments: &[&str]) -> Output {
    let mut command = command();
    command.args(&arguments[..1]).arg(case()).args(&arguments[1..]);
    for set in ["background.size=1.0", "body.0.shape.size=1.0", "time.end=0.003"] {
        command.args(["--set", set]);
    }
    command.output().expect("the binary starts")
}

/// Checks that the picture of a run can be drawn.
fn check_picture(directory: &Path) {
    let picture = directory.join("run.png");
    let drawn = command().arg("report").arg(directory).arg("--picture").arg(&picture).output().expect("a start");
    assert!(drawn.status.success(), "{}", text(&drawn.stderr));
    assert!(std::fs::read(&picture).expect("a picture").starts_with(b"\x89PNG"));
}

#[test]
fn check_prints_sizes_and_runs_nothing() {
    let printed = succeeded(&cutwater(&["check"]));
    for word in ["background:", "body ball:", "unknowns", "steps: 3"] {
        assert!(printed.contains(word), "{printed}");
    }
}

#[test]
fn run_writes_into_the_directory_and_prints_lines() {
    let directory = fresh("run", "run");
    let shown = directory.display().to_string();
    let printed = succeeded(&cutwater(&["run", "--out", &shown, "--timings"]));
    assert!(printed.contains("step 3/3") && printed.contains("d_min"), "{printed}");
    for file in ["history.csv", "summary.json", "frames.json", "report.html"] {
        assert!(directory.join(file).exists(), "{file}");
    }
    // The log has what was printed, also how the scenario was understood.
    let log = std::fs::read_to_string(directory.join("run.log")).expect("a log");
    for words in [
        "step 3/3",
        "fluid: density 1 g/cm³",
        "body ball: elastic, saint-venant-kirchhoff",
        "contact of ball with rigid-plane",
        "linear solver: gmres",
    ] {
        assert!(printed.contains(words) && log.contains(words), "{words}: {printed}{log}");
    }
    assert!(printed.contains("unknowns in the first step"), "{printed}");
    // The smallest gap is that of the only body.
    assert!(!printed.contains(", smallest gap"), "{printed}");
    assert!(
        printed.contains("no contact of ball; the smallest gap of all contacts is ")
            && printed.contains("cm, between ball and its obstacle at rest")
    );
    let page = std::fs::read_to_string(directory.join("report.html")).expect("a page");
    let again = command().arg("report").arg(&directory).output().expect("a start");
    assert!(again.status.success() && text(&again.stdout).trim().ends_with("report.html"));
    assert_eq!(std::fs::read_to_string(directory.join("report.html")).expect("a page"), page);
    check_picture(&directory);
    let quiet = cutwater(&["run", "--out", &shown, "--quiet", "--no-report"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty());
    assert!(
        std::fs::read_to_string(directory.join("run.log")).expect("a log").contains("step 3/3"),
        "quiet runs have a log too"
    );
    let verbose = cutwater(&["run", "--out", &shown, "-v", "--no-report"]);
    let printed = text(&verbose.stdout);
    for words in ["step 1/3", "step 2/3", "step 3/3", "linear iterations, residual", "factorisation"] {
        assert!(verbose.status.success() && printed.contains(words), "{words}: {printed}");
    }
    assert_eq!(cutwater(&["run", "--out", &shown, "-v", "-q"]).status.code(), Some(2));
    // Page and frames of the earlier run would not belong to these results.
    assert!(!directory.join("report.html").exists() && !directory.join("frames.json").exists());
}

#[test]
fn a_scenario_without_a_fluid_is_checked_run_and_reported() {
    let text_of_case = std::fs::read_to_string(case()).expect("the case");
    let (begin, bodies) = (text_of_case.find("[fluid]"), text_of_case.find("[[body]]"));
    let part = |from: Option<usize>, to: Option<usize>| &text_of_case[from.expect("a section")..to.expect("a section")];
    let dry = [part(Some(0), begin), part(bodies, Some(text_of_case.len()))].concat();
    let scenario = file("run", "dry.toml", &dry);
    let cutwater = |name: &str, more: &[&str]| {
        let sets = ["--set", "body.0.shape.size=1.0", "--set", "time.end=0.003"];
        succeeded(&command().arg(name).arg(&scenario).args(sets).args(more).output().expect("the binary starts"))
    };
    let printed = cutwater("check", &[]);
    assert!(printed.contains("body ball:") && printed.contains("steps: 3"), "{printed}");
    assert!(!printed.contains("background"), "{printed}");
    let directory = fresh("run", "dry-run");
    let units = "units={ length = \"mm\", mass = \"g\", time = \"ms\" }";
    let printed = cutwater("run", &["--out", &directory.display().to_string(), "--set", units]);
    assert!(printed.contains("step 3/3") && !printed.contains("stabilisation"), "{printed}");
    assert!(printed.contains("t = 0.003000 ms, d_min") && printed.contains(" mm,"), "{printed}");
    let page = std::fs::read_to_string(directory.join("report.html")).expect("a page");
    assert!(page.contains("unknowns, at most") && !page.contains(">stabilisation<"));
    check_picture(&directory);
}

/// Returns the number of calls and the milliseconds per step in the line of the table that begins with a name.
fn timing(printed: &str, name: &str) -> (usize, f64) {
    let begin = format!("{name} ");
    let line = printed.lines().find(|line| line.trim_start().starts_with(&begin)).unwrap_or_else(|| panic!("{name}"));
    let mut numbers = line.trim_start()[name.len()..].split_whitespace();
    let calls = numbers.next().and_then(|n| n.parse().ok()).expect("a number of calls");
    (calls, numbers.nth(1).and_then(|n| n.parse().ok()).expect("milliseconds"))
}

#[test]
fn timings_of_all_stages_and_contributions() {
    let directory = fresh("run", "timings");
    let printed = succeeded(&cutwater(&["run", "--out", &directory.display().to_string(), "--timings", "--quiet"]));
    for stage in ["cut", "space", "transfer", "contact search", "pattern", "multipliers", "report"] {
        assert_eq!(timing(&printed, stage).0, 3, "once per step: {printed}");
    }
    let (assemblies, assembly) = timing(&printed, "assembly");
    let iterations = timing(&printed, "linear solve").0;
    assert!(assemblies > iterations && iterations >= 3 && timing(&printed, "factorisation").0 >= 1, "{printed}");
    let contributions = [
        ("regime", iterations + 3),
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
    assert_eq!(timing(&printed, "output").0, 3, "once per step: {printed}");
}

#[test]
fn a_failed_run_exits_with_1_and_the_residuals() {
    let directory = fresh("run", "failed");
    let shown = directory.display().to_string();
    let output = cutwater(&["run", "--out", &shown, "--set", "solver.newton.max_iterations=1"]);
    assert_eq!(output.status.code(), Some(1));
    let printed = text(&output.stderr);
    assert!(printed.contains("relative residual") && printed.contains(&shown), "{printed}");
    assert!(directory.join("summary.json").exists() && directory.join("report.html").exists());
    let log = std::fs::read_to_string(directory.join("run.log")).expect("a log");
    assert!(log.contains("relative residual") && log.contains("complete up to step 0"), "{log}");
}

#[test]
fn the_help_states_the_exit_codes() {
    let output = command().arg("--help").output().expect("the binary starts");
    let printed = text(&output.stdout);
    assert!(["Exit codes:", "130", "file, line, key"].iter().all(|words| printed.contains(words)), "{printed}");
}
