//! `cargo xtask bench`: starts criterion, writes what it found, or lays it beside peers.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::process::{Outcome, cargo, succeeds, target};
use crate::python::python_with;

/// The benches of criterion.
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
    /// Measure the cases of other packages, too, with the scripts in the folder that `CUTWATER_PEERS` names, and print the
    /// ratios; one thread.
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

/// One group of benchmarks.
fn criterion(group: &str, filter: Option<&str>) -> Command {
    let mut command = cargo(&["bench", "--package", "benchmarks", "--bench", group, "--"]);
    command.args(filter);
    command
}

/// What criterion measured.
struct Measured {
    /// Median.
    seconds: f64,
    /// Cells or pieces that one iteration works on.
    elements: Option<f64>,
}

/// How long benchmarks run.
#[derive(Clone, Copy)]
enum Effort {
    /// Until the result settles.
    Brief,
    /// As they are, in one thread.
    OneThread,
}

/// Runs groups (name, filter, effort) and reads what criterion wrote into a folder of its own, by id; `None` if one
/// of them fails.
fn measure<'a>(
    home: &Path,
    groups: impl Iterator<Item = (&'a str, Option<&'a str>, Effort)>,
) -> io::Result<Option<BTreeMap<String, Measured>>> {
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
fn collect(folder: &Path, measured: &mut BTreeMap<String, Measured>) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, measured)?;
        }
    }
    if folder.ends_with("new") && folder.join("benchmark.json").is_file() {
        let read =
            |name: &str| -> io::Result<Value> { Ok(serde_json::from_str(&fs::read_to_string(folder.join(name))?)?) };
        let (benchmark, estimates) = (read("benchmark.json")?, read("estimates.json")?);
        if let (Some(id), Some(nanoseconds)) =
            (benchmark["full_id"].as_str(), estimates["median"]["point_estimate"].as_f64())
        {
            let elements = benchmark["throughput"]["Elements"].as_f64();
            measured.insert(id.to_owned(), Measured { seconds: 1e-9 * nanoseconds, elements });
        }
    }
    Ok(())
}

/// A case of ours that a peer's script measures, too.
struct Peer {
    /// Group and id of ours.
    group: &'static str,
    id: &'static str,
    script: &'static str,
    arguments: &'static [&'static str],
    /// What the row of the script's result has, and the field with the seconds.
    row: &'static [(&'static str, &'static str)],
    seconds: &'static str,
}

const PEERS: [Peer; 6] = [
    Peer {
        group: "cut",
        id: "cut/disk/2d/256/256",
        script: "A_cutgeom_ngsxfem.py",
        arguments: &["--case", "2d", "--sizes", "256"],
        row: &[("N", "256")],
        seconds: "total_s",
    },
    Peer {
        group: "cut",
        id: "cut/sphere/3d/32",
        script: "A_cutgeom_ngsxfem.py",
        arguments: &["--case", "3d", "--sizes", "32"],
        row: &[("N", "32")],
        seconds: "total_s",
    },
    Peer {
        group: "assembly",
        id: "assembly/elasticity/2d/n448",
        script: "C_assembly_ngsolve.py",
        arguments: &["--case", "ela"],
        row: &[("case", "ela"), ("dim", "2"), ("N", "448")],
        seconds: "t_assemble",
    },
    Peer {
        group: "assembly",
        id: "assembly/elasticity/3d/n32",
        script: "C_assembly_ngsolve.py",
        arguments: &["--case", "ela"],
        row: &[("case", "ela"), ("dim", "3"), ("N", "32")],
        seconds: "t_assemble",
    },
    Peer {
        group: "assembly",
        id: "assembly/cut-stokes/2d/n256",
        script: "B_stokes_ngsxfem.py",
        arguments: &["--sizes", "256"],
        row: &[("N", "256")],
        seconds: "t_assembly",
    },
    Peer {
        group: "assembly",
        id: "assembly/navier-stokes/2d/n224",
        script: "C_assembly_ngsolve.py",
        arguments: &["--case", "ns", "--sizes", "2x224"],
        row: &[("case", "ns"), ("N", "224")],
        seconds: "t_assemble",
    },
];

/// Measures what peers measure, prints both and the ratios.
fn compare_with_peers() -> Outcome {
    let Some(scripts) = std::env::var_os("CUTWATER_PEERS").map(PathBuf::from).filter(|folder| folder.is_dir()) else {
        println!("skipped: CUTWATER_PEERS names no folder of scripts");
        return Ok(true);
    };
    let packages = ["ngsolve", "xfem", "scipy", "numpy"];
    let Some(python) = python_with("python-peers", &packages, "import xfem, scipy")? else {
        println!("failed: Python with ngsolve and xfem is needed (python3 -m venv, pip install) and not to be had");
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
    for peer in &PEERS {
        let key = format!("{} {}", peer.script, peer.arguments.join(" "));
        if !results.contains_key(&key) {
            let out = place.join(format!("peer-{}.json", results.len()));
            let mut script = Command::new(&python);
            script.arg(scripts.join(peer.script)).args(peer.arguments).args(["--threads", "1", "--out"]).arg(&out);
            // The scripts leave matrices where they are started.
            script.current_dir(&place).stdout(Stdio::null()).stderr(Stdio::null());
            let value =
                if succeeds(&mut script)? { serde_json::from_str(&fs::read_to_string(&out)?)? } else { Value::Null };
            results.insert(key.clone(), value);
        }
        let theirs = find_row(&results[&key], peer).and_then(|row| row[peer.seconds].as_f64());
        match (measured.get(peer.id), theirs) {
            (Some(ours), Some(theirs)) => {
                println!(
                    "{:34} {:10.2} {:10.2} {:8.3}",
                    peer.id,
                    1e3 * ours.seconds,
                    1e3 * theirs,
                    ours.seconds / theirs
                );
            }
            (ours, theirs) => {
                good = false;
                let missing = |is_there: bool| if is_there { "measured" } else { "missing" };
                println!("{:34} ours {}, peer {}", peer.id, missing(ours.is_some()), missing(theirs.is_some()));
            }
        }
    }
    println!("ratio: our time over the peer's; one thread each, ours wall-clock time, theirs process time");
    Ok(good)
}

/// The row of a script's result for a case.
fn find_row<'a>(result: &'a Value, peer: &Peer) -> Option<&'a Value> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    result["rows"].as_array()?.iter().find(|row| peer.row.iter().all(|(key, value)| text(&row[key]) == *value))
}
