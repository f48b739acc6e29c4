//! `cargo xtask bench`: runs the benchmarks, writes their results, or compares them with other packages.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::process::{Outcome, cargo, succeeds, target};
use crate::python::python_with;

/// Benchmark targets.
const GROUPS: [&str; 4] = ["cut", "assembly", "linear", "time_step"];

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Group to run: cut, assembly, linear or time_step; all if not given.
    group: Option<String>,
    /// Only benchmarks whose id contains this, such as `2d/h02`.
    filter: Option<String>,
    /// Run briefly, and write id, median seconds and throughput of each benchmark to this file.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
    /// Compare with other packages, on one thread: runs their scripts in the folder given by `CUTWATER_PEERS`, and
    /// prints ratios of times.
    #[arg(long, conflicts_with_all = ["group", "filter", "summary"])]
    peers: bool,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    if arguments.peers {
        return compare_with_peers();
    }
    let groups: Vec<&str> = arguments.group.as_deref().map_or(GROUPS.to_vec(), |group| vec![group]);
    let filter = arguments.filter.as_deref();
    let Some(file) = &arguments.summary else {
        return groups.into_iter().try_fold(true, |good, group| Ok(good & succeeds(&mut criterion(group, filter))?));
    };
    let home = target().join("bench-summary");
    let measured = measure(&home, groups.into_iter().map(|group| (group, filter, Effort::Brief)))?;
    let Some(measured) = measured else { return Ok(false) };
    let entries: Vec<Value> = measured
        .iter()
        .map(|(id, found)| {
            let throughput = found.elements.map(|n| json!({ "elements": n, "per_second": n / found.seconds }));
            json!({ "id": id, "seconds": found.seconds, "throughput": throughput })
        })
        .collect();
    fs::write(file, serde_json::to_string_pretty(&entries)?)?;
    println!("{} benchmarks in {}", entries.len(), file.display());
    Ok(true)
}

/// Returns the command that runs one group of benchmarks.
fn criterion(group: &str, filter: Option<&str>) -> Command {
    let mut command = cargo(&["bench", "--package", "benchmarks", "--bench", group, "--"]);
    command.args(filter);
    command
}

/// Result of one benchmark.
struct BenchResult {
    /// Median time.
    seconds: f64,
    /// Cells or pieces per iteration.
    elements: Option<f64>,
}

/// Duration and threads of benchmarks.
#[derive(Clone, Copy)]
enum Effort {
    /// With `--quick`, on all threads: until the estimate has converged.
    Brief,
    /// In full, on one thread.
    OneThread,
}

/// Runs groups (name, filter, effort) and returns the results by id, or `None` if a group fails. `home` is the folder
/// for the files of criterion. It is deleted first.
fn measure<'a>(
    home: &Path,
    groups: impl Iterator<Item = (&'a str, Option<&'a str>, Effort)>,
) -> io::Result<Option<BTreeMap<String, BenchResult>>> {
    if home.exists() {
        fs::remove_dir_all(home)?;
    }
    for (group, filter, effort) in groups {
        let mut command = criterion(group, filter);
        command.env("CRITERION_HOME", home);
        match effort {
            Effort::Brief => command.arg("--quick"),
            Effort::OneThread => command.env("RAYON_NUM_THREADS", "1"),
        };
        if !succeeds(&mut command)? {
            return Ok(None);
        }
    }
    let mut measured = BTreeMap::new();
    collect(home, &mut measured)?;
    Ok(Some(measured))
}

/// Reads all results below a folder.
fn collect(folder: &Path, measured: &mut BTreeMap<String, BenchResult>) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, measured)?;
        }
    }
    // Criterion writes the last result of a benchmark to a folder `new`.
    if folder.ends_with("new") && folder.join("benchmark.json").is_file() {
        let read =
            |name: &str| -> io::Result<Value> { Ok(serde_json::from_str(&fs::read_to_string(folder.join(name))?)?) };
        let (benchmark, estimates) = (read("benchmark.json")?, read("estimates.json")?);
        if let (Some(id), Some(nanoseconds)) =
            (benchmark["full_id"].as_str(), estimates["median"]["point_estimate"].as_f64())
        {
            let elements = benchmark["throughput"]["Elements"].as_f64();
            measured.insert(id.to_owned(), BenchResult { seconds: 1e-9 * nanoseconds, elements });
        }
    }
    Ok(())
}

/// A benchmark with the script of another package that measures the same case.
struct Peer {
    group: Text,
    id: Text,
    script: Text,
    /// Arguments of the script.
    arguments: &'static [Text],
    /// Keys and values of the row of the script's result.
    row: &'static [(Text, Text)],
    /// Name of the field of the row with the time, s.
    seconds: Text,
}

type Text = &'static str;

const CUT: &str = "A_cutgeom_ngsxfem.py";
const STOKES: &str = "B_stokes_ngsxfem.py";
const ASSEMBLY: &str = "C_assembly_ngsolve.py";
#[rustfmt::skip]
const PEERS: [Peer; 6] = [
    Peer { group: "cut", id: "cut/disk/2d/256/256", script: CUT, arguments: &["--case", "2d", "--sizes", "256"], row: &[("N", "256")], seconds: "total_s" },
    Peer { group: "cut", id: "cut/sphere/3d/32", script: CUT, arguments: &["--case", "3d", "--sizes", "32"], row: &[("N", "32")], seconds: "total_s" },
    Peer { group: "assembly", id: "assembly/elasticity/2d/n448", script: ASSEMBLY, arguments: &["--case", "ela"], row: &[("case", "ela"), ("dim", "2"), ("N", "448")], seconds: "t_assemble" },
    Peer { group: "assembly", id: "assembly/elasticity/3d/n32", script: ASSEMBLY, arguments: &["--case", "ela"], row: &[("case", "ela"), ("dim", "3"), ("N", "32")], seconds: "t_assemble" },
    Peer { group: "assembly", id: "assembly/cut-stokes/2d/n256", script: STOKES, arguments: &["--sizes", "256"], row: &[("N", "256")], seconds: "t_assembly" },
    Peer { group: "assembly", id: "assembly/navier-stokes/2d/n224", script: ASSEMBLY, arguments: &["--case", "ns", "--sizes", "2x224"], row: &[("case", "ns"), ("N", "224")], seconds: "t_assemble" },
];

/// Measures the cases of [`PEERS`] with both packages and prints the ratios.
fn compare_with_peers() -> Outcome {
    let Some(scripts) = std::env::var_os("CUTWATER_PEERS").map(PathBuf::from).filter(|folder| folder.is_dir()) else {
        println!("skipped: CUTWATER_PEERS is not set to a folder of scripts");
        return Ok(true);
    };
    let packages = ["ngsolve", "xfem", "scipy", "numpy"];
    let Some(python) = python_with("python-peers", &packages, "import xfem, scipy")? else {
        println!(
            "failed: cannot create a Python environment; check that `python3 -m venv` and `pip install {}` work",
            packages.join(" ")
        );
        return Ok(false);
    };
    let place = target().join("bench-peers");
    let filters = ["cut", "assembly"].map(|group| {
        let ids: Vec<String> =
            PEERS.iter().filter(|peer| peer.group == group).map(|peer| format!("^{}$", peer.id)).collect();
        (group, ids.join("|"))
    });
    let groups = filters.iter().map(|(group, ids)| (*group, Some(ids.as_str()), Effort::OneThread));
    let measured = measure(&place.join("criterion"), groups)?;
    let Some(measured) = measured else { return Ok(false) };
    println!("\n{:34} {:>10} {:>10} {:>8}", "case", "ours, ms", "peer, ms", "ratio");
    let mut results: BTreeMap<String, Value> = BTreeMap::new();
    let mut good = true;
    for Peer { id, script, arguments, row, seconds, .. } in PEERS {
        let key = format!("{script} {}", arguments.join(" "));
        if !results.contains_key(&key) {
            let out = place.join(format!("peer-{}.json", results.len()));
            let mut process = Command::new(&python);
            process.arg(scripts.join(script)).args(arguments).args(["--threads", "1", "--out"]).arg(&out);
            // The scripts write matrices to the current folder.
            process.current_dir(&place).stdout(Stdio::null()).stderr(Stdio::null());
            let value =
                if succeeds(&mut process)? { serde_json::from_str(&fs::read_to_string(&out)?)? } else { Value::Null };
            results.insert(key.clone(), value);
        }
        let theirs = find_row(&results[&key], row).and_then(|row| row[seconds].as_f64());
        match (measured.get(id), theirs) {
            (Some(ours), Some(theirs)) => {
                let ratio = ours.seconds / theirs;
                println!("{id:34} {:10.2} {:10.2} {ratio:8.3}", 1e3 * ours.seconds, 1e3 * theirs);
            }
            (ours, theirs) => {
                good = false;
                let missing = |is_there: bool| if is_there { "measured" } else { "missing" };
                println!("{id:34} ours {}, peer {}", missing(ours.is_some()), missing(theirs.is_some()));
            }
        }
    }
    println!(
        "ratio: time of this package divided by time of the peer, on one thread each; ours is wall-clock time, theirs is process time"
    );
    Ok(good)
}

/// Returns the row of a script's result for a case.
fn find_row<'a>(result: &'a Value, row: &[(&str, &str)]) -> Option<&'a Value> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    result["rows"].as_array()?.iter().find(|found| row.iter().all(|(key, value)| text(&found[key]) == *value))
}
