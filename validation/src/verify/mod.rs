//! Checks against exact solutions and published numbers, one file for each.

mod added_mass;
mod bar;
mod conservation;
mod contact_patch;
mod csm;
mod disk_impact;
mod disk_modes;
pub(crate) mod document;
mod dry;
mod exact;
mod files;
mod flow;
mod frame_change;
mod hertz;
mod immersed_modes;
mod linear_flow;
mod lubrication;
mod mode;
mod orders;
mod peer;
pub(crate) mod record;
mod robustness;
mod sedimentation;
mod shear_layer;
mod svk_states;
mod sweep;
mod symmetry;
mod wan_turek;

use std::path::Path;
use std::time::Instant;

use self::record::Record;
use crate::outcome::{Failure, Outcome};

pub(crate) use dry::{Scheme, dry_setup};

/// A named check.
struct Check {
    name: &'static str,
    /// Subject of the check, in a sentence.
    about: &'static str,
    /// Measures, in full or in short; results may go to the directory.
    measure: fn(&mut Record, &Path) -> Result<(), Failure>,
}

/// All checks, in the order of the page.
const CHECKS: [Check; 19] = [
    Check {
        name: "exact",
        about: "Solutions that the discrete spaces contain, at random positions of the body.",
        measure: exact::measure,
    },
    Check {
        name: "orders",
        about: "Orders of convergence of flows that are known, around bodies at rest and in motion.",
        measure: orders::measure,
    },
    Check {
        name: "peer",
        about: "Errors of unfitted Stokes flow compared with those of ngsxfem on the same mesh.",
        measure: peer::measure,
    },
    Check {
        name: "lubrication",
        about: "A cylinder that approaches a wall, against the exact force in Stokes flow.",
        measure: lubrication::measure,
    },
    Check {
        name: "robustness",
        about: "Bodies that pass vertices, edges and faces of the mesh: condition numbers, continuity, scatter of forces.",
        measure: robustness::measure,
    },
    Check {
        name: "shear-layer",
        about: "A fluid layer over an elastic one, sheared by a plate: the coupled problem against its exact solution.",
        measure: shear_layer::measure,
    },
    Check {
        name: "added-mass",
        about: "The acceleration with which a ball begins to fall, against that of a rigid one in ideal fluid.",
        measure: added_mass::measure,
    },
    Check {
        name: "sedimentation",
        about: "A heavy disk that sinks in a closed box, as a free rigid body.",
        measure: sedimentation::measure,
    },
    Check {
        name: "wan-turek",
        about: "A cylinder that oscillates in a closed channel: drag, lift, and their noise.",
        measure: wan_turek::measure,
    },
    Check {
        name: "frame-change",
        about: "A cylinder at rest in a stream against one that moves through fluid at rest: drag, and its noise.",
        measure: frame_change::measure,
    },
    Check {
        name: "symmetry",
        about: "Half of a symmetric domain and the whole of it: the same contact.",
        measure: symmetry::measure,
    },
    Check {
        name: "svk-states",
        about: "Uniform states of a Saint Venant-Kirchhoff body under its loads, in the plane and in space.",
        measure: svk_states::measure,
    },
    Check {
        name: "csm",
        about: "The flag of the Turek-Hron benchmark under its weight, at rest and swinging.",
        measure: csm::measure,
    },
    Check { name: "disk-modes", about: "Frequencies of a free elastic disk.", measure: disk_modes::measure },
    Check {
        name: "immersed-modes",
        about: "Frequencies of an elastic disk in a fluid at rest.",
        measure: immersed_modes::measure,
    },
    Check {
        name: "contact-patch",
        about: "Contact that transmits a uniform pressure: a block on a plane, and two blocks.",
        measure: contact_patch::measure,
    },
    Check { name: "hertz", about: "A cylinder pressed on a rigid plane.", measure: hertz::measure },
    Check {
        name: "bar",
        about: "A bar that hits the floor: times and pressures of its contacts.",
        measure: bar::measure,
    },
    Check {
        name: "disk-impact",
        about: "A disk that hits a rigid plane without a fluid around it.",
        measure: disk_impact::measure,
    },
];

/// Prepares data for an independent reader; runs only if it is named.
const FILES: &str = "files";

/// Checks to run, and options.
pub(crate) struct Request<'a> {
    /// Names of the checks; all if empty.
    pub(crate) names: &'a [String],
    /// The long versions.
    pub(crate) full: bool,
    /// Whether to write the pages of the book.
    pub(crate) document: bool,
    /// Where results go.
    pub(crate) out: &'a Path,
}

/// Runs checks; true if all hold.
///
/// # Errors
/// There is no check of that name, or one of them cannot be done.
pub(crate) fn run(request: &Request<'_>) -> Outcome {
    let known: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
    if let Some(name) = request.names.iter().find(|name| **name != FILES && !known.contains(&name.as_str())) {
        return Err(format!("there is no check {name:?}; there are {}, {FILES}", known.join(", ")).into());
    }
    let is_asked = |name: &str| request.names.iter().any(|n| n == name);
    let mut records = Vec::new();
    for check in CHECKS.iter().filter(|check| request.names.is_empty() || is_asked(check.name)) {
        println!("# {}: {}", check.name, check.about);
        let mut record = Record::new(check.name, check.about, request.full);
        let begin = Instant::now();
        (check.measure)(&mut record, &request.out.join(check.name))?;
        record.seconds = begin.elapsed().as_secs_f64();
        print(&record);
        records.push(record);
        // After every check, so that a long run that is stopped keeps its results so far.
        write_json(&records, request.out)?;
        if let (true, Some(record)) = (request.document, records.last()) {
            let full = if request.full { " --full" } else { "" };
            let command = format!("cargo xtask verify {}{full} --document", record.check);
            document::write(document::FOLDER, record, &command, &document::version())?;
        }
    }
    if records.len() > 1 {
        println!("# {} checks in {}", records.len(), document::duration(records.iter().map(|r| r.seconds).sum()));
    }
    let files = if is_asked(FILES) { files::check(request.full, &request.out.join(FILES))? } else { true };
    Ok(files && records.iter().all(Record::holds))
}

/// All rows in one list, `DIR/verify.json`.
fn write_json(records: &[Record], out: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let rows: Vec<_> = records.iter().flat_map(|record| &record.rows).collect();
    Ok(std::fs::write(out.join("verify.json"), serde_json::to_string_pretty(&rows)? + "\n")?)
}

fn print(record: &Record) {
    let mut lines = vec![["quantity", "computed", "reference", "tolerance", "verdict"].map(str::to_owned)];
    lines.extend(record.rows.iter().map(|row| {
        let [computed, reference] = document::numbers(row);
        [row.quantity.clone(), computed, reference, row.tolerance.clone(), row.verdict.clone()]
    }));
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    for line in &lines {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, w)| format!("{cell:<w$}")).collect();
        println!("  {}", cells.join("  ").trim_end());
    }
    record.notes.iter().for_each(|note| println!("  {note}"));
    println!("  (it took {})", document::duration(record.seconds));
}
