//! Runs that are stopped and resumed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use crate::setting::{self, case, fresh};

/// Changes to the case: a coarse mesh, checkpoints, and an end after the first contact.
const SETS: [&str; 7] = [
    "background.size=1.0",
    "body.0.shape.size=1.0",
    "time.end=0.12",
    "output.vtk_every=7",
    "output.checkpoint_every=10",
    "fluid.stabilisation=standard",
    "time.scheme={ kind = \"generalised-alpha\", rho_inf = 0.5 }",
];
/// Kills in all.
const N_KILLS: usize = 50;

fn directory(name: &str) -> PathBuf {
    fresh("checkpoints", name)
}

/// Returns the command that starts a run, or resumes it.
fn command(directory: &Path, resumes: bool, more: &[&str]) -> Command {
    let mut command = setting::command();
    command.arg("run").stdout(Stdio::piped()).stderr(Stdio::piped());
    if resumes {
        command.arg("--resume").arg(directory);
    } else {
        command.arg(case()).arg("--out").arg(directory);
        SETS.iter().for_each(|set| _ = command.args(["--set", set]));
    }
    command.args(more);
    command
}

fn finish(mut command: Command, code: i32) -> String {
    let Output { status, stdout, stderr } = command.output().expect("the binary starts");
    let printed = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert_eq!(status.code(), Some(code), "{printed}");
    printed
}

/// Returns all results of a run that do not depend on the clock, by their names.
fn results(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for folder in [directory.to_owned(), directory.join("vtk")] {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(directory).expect("a file of the run").display().to_string();
            let bytes = if path.is_file() { std::fs::read(&path).expect("a file") } else { continue };
            let kept = match path.extension().and_then(|e| e.to_str()) {
                Some("csv") => without_seconds(&String::from_utf8_lossy(&bytes)).into_bytes(),
                Some("bin") => state(&bytes),
                Some("vtu" | "pvd" | "toml") => bytes,
                _ if name == "frames.json" => bytes,
                _ => continue,
            };
            all.insert(name, kept);
        }
    }
    all
}

/// Removes the columns of wall-clock times from a table.
fn without_seconds(table: &str) -> String {
    let names: Vec<&str> = table.lines().next().unwrap_or_default().split(',').collect();
    let row = |line: &str| {
        let kept = line.split(',').zip(&names).filter(|(_, name)| !name.starts_with("seconds_"));
        kept.map(|(value, _)| value).collect::<Vec<_>>().join(",")
    };
    table.lines().map(row).collect::<Vec<_>>().join("\n")
}

/// Returns the numbers of the state and of the linear solver of a checkpoint.
fn state(bytes: &[u8]) -> Vec<u8> {
    let header = u64::from_le_bytes(bytes[12..20].try_into().expect("8 bytes"));
    bytes[20 + header as usize..bytes.len() - 4].to_vec()
}

fn assert_same(found: &BTreeMap<String, Vec<u8>>, expected: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in found {
        assert!(*bytes == expected[name], "{name} differs");
    }
}

/// Sleeps for `wait`, then kills the run unless it has ended. Returns whether it had ended.
fn ends_within(mut run: Child, wait: Duration) -> bool {
    std::thread::sleep(wait);
    if let Some(status) = run.try_wait().expect("a status") {
        assert!(status.success(), "{status}");
        return true;
    }
    run.kill().expect("a kill");
    run.wait().expect("a status");
    false
}

/// Kills runs at random moments, resumes them until they end, and compares their results with those of a run that was
/// not stopped.
#[test]
fn killed_runs_end_with_the_same_bits() {
    let whole = directory("whole");
    let start = Instant::now();
    finish(command(&whole, false, &[]), 0);
    // Kills come at random times in the length of a whole run, as it is with the present load of the machine.
    let length = start.elapsed();
    let expected = results(&whole);
    assert!(expected.keys().any(|name| name.ends_with(".bin")) && expected.contains_key("frames.json"));
    // A kill after the last checkpoint was written, before the oldest one was removed.
    let last = whole.join("checkpoint-00000120.bin");
    std::fs::copy(&last, whole.join("checkpoint-00000100.bin")).expect("a copy");
    finish(command(&whole, true, &[]), 0);
    assert_same(&results(&whole), &expected);
    // Two at a time.
    let half = |seed| kills(seed, N_KILLS / 2, length, &expected);
    let n_resumed: usize = std::thread::scope(|scope| {
        let halves: Vec<_> = [1, 2].map(|seed| scope.spawn(move || half(seed))).into();
        halves.into_iter().map(|half| half.join().expect("no panic")).sum()
    });
    assert!(n_resumed > N_KILLS / 4, "{n_resumed} runs began from a checkpoint, of {N_KILLS} that were killed");
}

/// Starts runs, kills them at random moments and resumes them, `most_kills` times in all. Compares the results of each
/// run that came to its end. Returns how often a run began from a checkpoint.
fn kills(seed: u64, most_kills: usize, length: Duration, expected: &BTreeMap<String, Vec<u8>>) -> usize {
    let (mut n_kills, mut n_resumed, mut random) = (0, 0, SplitMix64::seed_from_u64(seed));
    for number in 0.. {
        if n_kills >= most_kills {
            break;
        }
        let killed = directory(&format!("killed-{seed}-{number}"));
        loop {
            let has_checkpoint = killed.is_dir()
                && std::fs::read_dir(&killed)
                    .expect("a folder")
                    .flatten()
                    .any(|entry| entry.file_name().to_string_lossy().starts_with("checkpoint-"));
            n_resumed += usize::from(has_checkpoint);
            if n_kills >= most_kills {
                finish(command(&killed, has_checkpoint, &[]), 0);
                break;
            }
            let run = command(&killed, has_checkpoint, &[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
            if ends_within(run.expect("the binary starts"), length.mul_f64(random.random())) {
                break;
            }
            n_kills += 1;
        }
        assert_same(&results(&killed), expected);
    }
    n_resumed
}

#[test]
fn an_interrupted_run_goes_on_and_is_not_overwritten() {
    let stop = |signal: &str| {
        let stopped = directory(&format!("stopped{signal}"));
        // Without regular checkpoints.
        let sets = ["--set", "time.end=10", "--set", "output.checkpoint_every=0"];
        let mut run = command(&stopped, false, &sets).spawn().expect("the binary starts");
        while !stopped.join("history.csv").exists() && run.try_wait().expect("a status").is_none() {
            std::thread::sleep(Duration::from_millis(20));
        }
        let sent = Command::new("kill").args([signal, &run.id().to_string()]).status().expect("the command kill");
        assert!(sent.success());
        let Output { status, stderr, .. } = run.wait_with_output().expect("an end");
        let printed = String::from_utf8_lossy(&stderr);
        assert_eq!(status.code(), Some(130), "{printed}");
        assert!(printed.contains("stopped after step") && printed.contains("--resume"), "{printed}");
        assert!(stopped.join("report.html").exists());
        stopped
    };
    // A batch system sends the signal to terminate.
    stop("-TERM");
    let stopped = stop("-INT");
    let steps = || std::fs::read_to_string(stopped.join("history.csv")).expect("a history").lines().count() - 1;
    let before = steps();
    assert!(finish(command(&stopped, false, &[]), 2).contains("holds a run that was stopped"));
    assert_eq!(steps(), before);
    let other = finish(command(&stopped, true, &["--set", "fluid.viscosity=0.5"]), 2);
    assert!(other.contains("the scenario is not that of the run: `fluid.viscosity` or the file"), "{other}");
    let end = format!("time.end={}", 1e-3 * (before + 5) as f64);
    finish(command(&stopped, true, &["--set", &end]), 0);
    assert_eq!(steps(), before + 5);
    // To the bits of a run that was not interrupted.
    let whole = directory("not-stopped");
    finish(command(&whole, false, &["--set", &end, "--set", "output.checkpoint_every=0"]), 0);
    let histories = [&stopped, &whole].map(|directory| results(directory).remove("history.csv"));
    assert!(histories[0].is_some() && histories[0] == histories[1]);
    let frames = std::fs::read_to_string(stopped.join("frames.json")).expect("frames");
    assert!(frames.contains("\"Start\"") && frames.contains("\"End\""));
    // Nothing is left to do, and the page is written again.
    finish(command(&stopped, true, &[]), 0);
    assert_eq!(steps(), before + 5);
    assert!(finish(command(&stopped, true, &["--set", "time.end=0.001"]), 2).contains("time.end is at step 1"));
    // A run that has come to its end is replaced by a new one.
    finish(command(&stopped, false, &["--set", "time.end=0.003", "--set", "output.checkpoint_every=0"]), 0);
    assert_eq!(steps(), 3);
}

/// Checks that the time between checkpoints alone gives every tenth step, and that neither the clock nor checkpoints
/// change results.
#[test]
fn minutes_alone_select_from_every_tenth_step() {
    let run = |name: &str, more: &[&str]| {
        let (directory, end) = (directory(name), ["--set", "time.end=0.035"]);
        finish(command(&directory, false, &[&end, more].concat()), 0);
        let is_checkpoint = |name: &String| name.ends_with(".bin");
        let (checkpoints, rest): (BTreeMap<_, _>, BTreeMap<_, _>) =
            results(&directory).into_iter().partition(|(name, _)| is_checkpoint(name));
        let rest = rest.into_iter().filter(|(name, _)| name.ends_with(".csv") || name.ends_with(".vtu")).collect();
        (checkpoints, rest)
    };
    let alone = |minutes| ["--set", "output.checkpoint_every=0", "--set", minutes];
    let every: (_, BTreeMap<_, _>) = run("every-ten", &[]);
    let short = run("short-time", &alone("output.checkpoint_minutes=1e-9"));
    let long = run("long-time", &alone("output.checkpoint_minutes=1e9"));
    let none = run("none", &["--set", "output.checkpoint_every=0"]);
    assert!(every.0.contains_key("checkpoint-00000030.bin") && every.0.len() == 2, "{:?}", every.0.keys());
    assert_same(&short.0, &every.0);
    // The state at the end is always written.
    assert_eq!(long.0.keys().collect::<Vec<_>>(), ["checkpoint-00000035.bin"]);
    assert_same(&short.1, &every.1);
    assert_same(&long.1, &every.1);
    assert!(none.0.is_empty());
    assert_same(&none.1, &every.1);
}

#[test]
fn checkpoints_that_cannot_be_used_are_refused() {
    let damaged = directory("damaged");
    assert!(finish(command(&damaged, true, &[]), 2).contains("scenario.toml"));
    finish(command(&damaged, false, &["--set", "time.end=0.005", "--set", "output.checkpoint_every=0"]), 0);
    assert!(finish(command(&damaged, true, &[]), 2).contains("has no checkpoint"));
    finish(command(&damaged, false, &["--set", "time.end=0.025"]), 0);
    let path = |step: usize| damaged.join(format!("checkpoint-{step:08}.bin"));
    let damage = |step: usize| {
        let mut bytes = std::fs::read(path(step)).expect("a checkpoint");
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(path(step), bytes).expect("a file");
    };
    // The last two are kept; if the last one is damaged, the other is used.
    assert!(!path(10).exists() && path(20).exists() && path(25).exists());
    damage(25);
    let printed = finish(command(&damaged, true, &[]), 0);
    assert!(
        printed.contains("checkpoint-00000025.bin") && printed.contains("is resumed from the checkpoint of step 20")
    );
    damage(20);
    damage(25);
    let printed = finish(command(&damaged, true, &[]), 2);
    assert!(printed.contains("checkpoint-00000025.bin") && printed.contains("damaged"), "{printed}");
}
