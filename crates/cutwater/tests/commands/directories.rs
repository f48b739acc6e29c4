//! Directories of results: no run replaces files that are not its own; streams may be closed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::setting::{self, case};

const SMALL: [&str; 3] = ["background.size=1.0", "body.0.shape.size=1.0", "time.end=0.002"];

/// Returns a directory that does not exist.
fn fresh(name: &str) -> PathBuf {
    setting::fresh("directories", name)
}

fn command(scenario: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = setting::command();
    command.arg("run").arg(scenario).arg("--no-report").arg("--out").arg(out);
    SMALL.iter().for_each(|set| _ = command.args(["--set", set]));
    command.args(more);
    command
}

fn run(scenario: &Path, out: &Path, more: &[&str]) -> Output {
    command(scenario, out, more).output().expect("the binary starts")
}

/// Checks that a run is an error of the input, with words in its message.
fn check_refused(output: &Output, words: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
}

#[test]
fn foreign_files_are_kept() {
    let directory = fresh("foreign");
    fs::create_dir_all(&directory).expect("a directory");
    fs::write(directory.join("history.csv"), "mine").expect("a file");
    let shown = directory.display().to_string();
    check_refused(&run(&case(), &directory, &[]), &[&shown, "not those of a run", "--out", "--overwrite"]);
    assert_eq!(fs::read_to_string(directory.join("history.csv")).expect("the file"), "mine");
    assert!(run(&case(), &directory, &["--overwrite"]).status.success());
    assert_ne!(fs::read_to_string(directory.join("history.csv")).expect("the file"), "mine");
}

#[test]
fn results_of_another_scenario_are_kept_and_those_of_the_same_are_replaced() {
    let directory = fresh("sweep");
    assert!(run(&case(), &directory, &[]).status.success());
    let scenario = directory.join("scenario.toml");
    let first = fs::read_to_string(&scenario).expect("a scenario");
    let other = ["--set", "fluid.viscosity=0.02"];
    check_refused(&run(&case(), &directory, &other), &["another scenario", "--overwrite"]);
    assert_eq!(fs::read_to_string(&scenario).expect("a scenario"), first);
    assert!(run(&case(), &directory, &[]).status.success(), "the same scenario once more");
    assert!(run(&case(), &directory, &[&other[..], &["--overwrite"]].concat()).status.success());
    assert_ne!(fs::read_to_string(&scenario).expect("a scenario"), first);
}

#[test]
fn the_scenario_is_not_replaced_by_its_copy() {
    let directory = fresh("input");
    fs::create_dir_all(&directory).expect("a directory");
    let scenario = directory.join("scenario.toml");
    fs::copy(case(), &scenario).expect("a copy");
    let before = fs::read_to_string(&scenario).expect("a scenario");
    for more in [&[][..], &["--overwrite"]] {
        check_refused(&run(&scenario, &directory, more), &["the scenario that is run"]);
        assert_eq!(fs::read_to_string(&scenario).expect("a scenario"), before);
    }
}

#[test]
fn one_run_at_a_time_writes_into_a_directory() {
    let directory = fresh("busy");
    let mut first = command(&case(), &directory, &["--set", "time.end=1", "--set", "output.vtk_every=0"])
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary starts");
    while !directory.join("history.csv").is_file() {
        assert!(first.try_wait().expect("a state").is_none(), "the first run ended early");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let second = run(&case(), &directory, &["--overwrite"]);
    first.kill().expect("a run that lasts");
    first.wait().expect("its end");
    check_refused(&second, &["another run writes", "--out"]);
    // The lock ends with the process.
    assert!(run(&case(), &directory, &["--overwrite"]).status.success());
}

/// Checks that a closed or full output stream ends no run, and that lost output of a check is an error.
#[cfg(target_os = "linux")]
#[test]
fn closed_and_full_streams_are_no_panics() {
    let full = || fs::File::options().write(true).open("/dev/full").expect("a device");
    let directory = fresh("streams");
    let output = command(&case(), &directory, &[]).stdout(full()).stderr(Stdio::piped()).output().expect("a start");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(directory.join("summary.json").is_file());
    let mut check = setting::command();
    check.arg("check").arg(case()).stdout(full()).stderr(Stdio::piped());
    SMALL.iter().for_each(|set| _ = check.args(["--set", set]));
    let output = check.output().expect("a start");
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write standard output"));
    // An input without an end.
    let endless = run(Path::new("/dev/zero"), &directory, &[]);
    check_refused(&endless, &["/dev/zero", "more than"]);
    // A reader that ends early, as `head -1` does.
    let mut closed = Command::new("sh");
    let binary = env!("CARGO_BIN_EXE_cutwater");
    let script = format!("{binary} check {} --set {} --set {} | true", case().display(), SMALL[0], SMALL[1]);
    let output = closed.arg("-c").arg(script).output().expect("a shell");
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Checks that a write that fails names the file and the cause.
#[cfg(target_os = "linux")]
#[test]
fn a_write_that_fails_names_its_cause() {
    let directory = fresh("removed");
    // A directory takes the place of a file that is written in the run.
    fs::create_dir_all(directory.join("fluid.pvd")).expect("a directory");
    let output = run(&case(), &directory, &["--overwrite"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("failed to record the step") && text.contains("fluid.pvd"), "{text}");
}

#[test]
fn a_history_that_is_removed_during_a_run_ends_it() {
    let directory = fresh("removed-history");
    let mut run = command(&case(), &directory, &["--set", "time.end=10", "--quiet"]);
    let mut run = run.stderr(Stdio::piped()).spawn().expect("the binary starts");
    let history = directory.join("history.csv");
    while !history.exists() && run.try_wait().expect("a status").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    fs::remove_file(&history).expect("a removable file");
    let output = run.wait_with_output().expect("an end");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{printed}");
    assert!(printed.contains("history.csv"), "{printed}");
}
