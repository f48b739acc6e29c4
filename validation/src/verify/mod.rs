//! Checks against exact solutions and published numbers, one file for each.

mod added_mass;
mod axisymmetric;
mod bar;
mod bounces;
mod bouncing_sphere;
mod bouncing_sphere_viscous;
mod carried_round;
mod cavity;
mod cfd;
mod cfd_unsteady;
mod channel;
mod channel_cylinder;
mod conservation;
mod contact_patch;
mod csm;
mod dfg;
mod dfg_unsteady;
mod disk_impact;
mod disk_modes;
pub(crate) mod document;
pub(crate) mod dry;
mod exact;
mod example;
mod files;
mod film_edges;
mod films;
mod flow;
mod frame_change;
mod friction;
mod fsi;
mod fsi_unsteady;
mod hertz;
mod immersed_modes;
mod linear_flow;
mod lubrication;
pub(crate) mod missed;
mod mode;
mod orders;
mod passages;
mod peer;
mod pulsatile_leaflet;
mod rebound_scan;
pub(crate) mod record;
mod resting_ball;
mod robustness;
pub(crate) mod run;
mod sedimentation;
mod settling;
mod settling_sphere;
mod shear_layer;
mod signal;
mod svk_states;
mod sweep;
mod symmetry;
mod valves;
mod wan_turek;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use cutwater::report::html::duration;

pub(crate) use crate::outcome::Failure;
use crate::outcome::Outcome;
use crate::table;
pub(crate) use crate::table::short;
use crate::workers;
pub(crate) use record::Record;
pub(crate) use run::{DirectRun, P, T, V};

/// A named check.
struct Check {
    name: &'static str,
    /// Subject, in a sentence; the lead of the page.
    about: &'static str,
    /// Adds the results to a record, in full or in short. Returns an error if a run fails.
    measure: fn(&mut Record) -> Result<(), Failure>,
}

const fn check(name: &'static str, about: &'static str, measure: fn(&mut Record) -> Result<(), Failure>) -> Check {
    Check { name, about, measure }
}

/// All checks, in the order of the page.
const CHECKS: [Check; 43] = [
    check("exact", "Solutions that the discrete spaces contain, at random positions of the body.", exact::measure),
    check("orders", "Orders of convergence of known flows around bodies at rest and in motion.", orders::measure),
    check("peer", "Errors of unfitted Stokes flow compared with those of ngsxfem on the same mesh.", peer::measure),
    check("lubrication", "The force on a cylinder that approaches a wall in Stokes flow.", lubrication::measure),
    check("films", "Films thinner than a few cells: spheres, cylinders and plates that approach.", films::measure),
    check(
        "channel-cylinder",
        "The drag of a cylinder that moves along a narrow channel in Stokes flow.",
        channel_cylinder::measure,
    ),
    check(
        "axisymmetric",
        "Flows with rotational symmetry around spheres: orders, drag, added mass.",
        axisymmetric::measure,
    ),
    check("robustness", "Bodies that pass vertices, edges and faces: condition numbers, scatter.", robustness::measure),
    check("shear-layer", "Fluid over an elastic layer, sheared by a plate: the exact solution.", shear_layer::measure),
    check("added-mass", "The first acceleration of a ball, and of a rigid one in ideal fluid.", added_mass::measure),
    check("sedimentation", "A heavy disk that sinks in a closed box, as a free rigid body.", sedimentation::measure),
    check("settling-sphere", "A sphere that sinks in a tank, with measured speeds.", settling_sphere::measure),
    check(
        "bouncing-sphere",
        "A sphere that bounces off the floor of a tank, with measured heights.",
        bouncing_sphere::measure,
    ),
    check(
        "bouncing-sphere-viscous",
        "A sphere that bounces off the floor of a tank of viscous oil: roughness and vapour.",
        bouncing_sphere_viscous::measure,
    ),
    check("rebound-scan", "The speed of rebound of a sphere over the Stokes number.", rebound_scan::measure),
    check("settling-disks", "Thirty elastic disks that settle in a closed box and collide.", settling::disks),
    check(
        "falling-ellipse",
        "An elastic ellipse from a mesh file that falls on the edge of a step.",
        settling::ellipse,
    ),
    check(
        "pulsatile-leaflet",
        "An elastic leaflet in a pulsatile channel flow, compared with the beam of oomph-lib.",
        pulsatile_leaflet::measure,
    ),
    check("carried-round", "A flexible strip carried round by fluid in a rotating container.", carried_round::measure),
    check("shear-pair", "Two elastic disks of different stiffness that touch in a shear flow.", passages::pair),
    check("constriction", "An elastic ball that the flow squeezes through a constriction.", passages::ball),
    check("idealised-valve", "Two leaflets that close against each other and open again.", valves::leaflets),
    check("check-valve", "An elastic ball in a conical seat that closes and opens with the flow.", valves::ball),
    check("wan-turek", "A cylinder that oscillates in a channel: drag, lift, and their noise.", wan_turek::measure),
    check("cavity", "Steady flow in a cavity with a moving lid, at a Reynolds number of 1000.", cavity::measure),
    check("dfg", "Steady flow past a cylinder in a channel, at a Reynolds number of 20.", dfg::measure),
    check(
        "dfg-unsteady",
        "Vortices behind a cylinder in a channel, at Reynolds numbers up to 100.",
        dfg_unsteady::measure,
    ),
    check("cfd", "Steady flow past the rigid flag of the Turek-Hron benchmark.", cfd::measure),
    check("cfd-unsteady", "Vortices behind the rigid flag of the Turek-Hron benchmark.", cfd_unsteady::measure),
    check("frame-change", "A cylinder at rest in a stream, and one moving in fluid at rest.", frame_change::measure),
    check("symmetry", "Half of a symmetric domain and the whole of it: the same contact.", symmetry::measure),
    check("svk-states", "Uniform states of a Saint Venant-Kirchhoff body under its loads.", svk_states::measure),
    check("csm", "The flag of the Turek-Hron benchmark under its weight, at rest and swinging.", csm::measure),
    check("fsi", "The elastic flag of the Turek-Hron benchmark in a steady flow.", fsi::measure),
    check("fsi-unsteady", "The elastic flag of the Turek-Hron benchmark, swinging.", fsi_unsteady::measure),
    check("disk-modes", "Frequencies of a free elastic disk.", disk_modes::measure),
    check("immersed-modes", "Frequencies of an elastic disk in a fluid at rest.", immersed_modes::measure),
    check("contact-patch", "Contact of uniform pressure: a block on a plane, and two blocks.", contact_patch::measure),
    check(
        "resting-ball",
        "The contact force of a disk and a ball at rest in fluid, under two ambient pressures.",
        resting_ball::measure,
    ),
    check("friction", "Coulomb friction: blocks that stick, slide and come to rest.", friction::measure),
    check("hertz", "A cylinder pressed on a rigid plane.", hertz::measure),
    check("bar", "A bar that hits the floor: times and pressures of its contacts.", bar::measure),
    check("disk-impact", "A disk that hits a rigid plane without a fluid around it.", disk_impact::measure),
];

/// Checks that compare with experiments, in the order of `cargo xtask validate --measured`.
pub(crate) const MEASURED: [&str; 4] =
    ["settling-sphere", "bouncing-sphere", "bouncing-sphere-viscous", "rebound-scan"];

/// Name of the check that writes VTK files for `check_vtk.py`, which reads them with another library. It runs only if
/// it is named.
const FILES: &str = "files";

/// Runs checks (all if none is named), in full or in short. Returns whether all hold. Results are written to `out`, and
/// pages to the book if `document`.
///
/// # Errors
/// A name is unknown, a run fails, or a file cannot be written.
pub(crate) fn run(names: &[String], full: bool, document: bool, out: &Path) -> Outcome {
    let known: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
    if let Some(name) = names.iter().find(|name| **name != FILES && !known.contains(&name.as_str())) {
        return Err(format!("there is no check {name:?}; known checks: {}, {FILES}", known.join(", ")).into());
    }
    if document {
        document::require_clean_tree()?;
    }
    let is_asked = |name: &str| names.iter().any(|n| n == name);
    let asked: Vec<&Check> = CHECKS.iter().filter(|check| names.is_empty() || is_asked(check.name)).collect();
    let measure = |check: &&Check| {
        let directory = out.join(if full { "full" } else { "quick" }).join(check.name);
        let mut record = Record { directory, ..Record::new(check.name, check.about, full) };
        let begin = Instant::now();
        (check.measure)(&mut record)?;
        if record.seconds == 0.0 {
            record.seconds = begin.elapsed().as_secs_f64();
        }
        missed::mark(&mut record)?;
        Ok(record)
    };
    let begin = Instant::now();
    let mut records: BTreeMap<usize, Record> = BTreeMap::new();
    let place = |name: &str| asked.iter().position(|check| check.name == name).unwrap_or(asked.len());
    workers::for_each(
        &asked,
        |check| check.name.to_owned(),
        measure,
        |check, record| {
            print(check, &record);
            if document {
                let full = if full { " --full" } else { "" };
                let command = format!("cargo xtask verify {}{full} --document", record.check);
                document::write(document::FOLDER, &record, &command, &document::version())?;
            }
            records.insert(place(check.name), record);
            // When a check ends, so that a long run that is stopped keeps its results so far.
            write_json(&records, out)
        },
    )?;
    if records.len() > 1 {
        println!("# {} checks in {}", records.len(), duration(begin.elapsed().as_secs_f64()));
    }
    let missed = records.values().flat_map(|record| &record.rows).filter(|row| row.verdict == missed::MISSED).count();
    document::older_than_the_code().iter().for_each(|line| println!("# {line}"));
    if missed > 0 {
        println!("# {missed} targets are missed, as listed in validation/missed.toml");
    }
    let files = if is_asked(FILES) { files::check(&out.join(FILES))? } else { true };
    Ok(files && records.values().all(Record::holds))
}

/// Writes all rows in one list, `DIR/verify.json`, in the order of the checks.
fn write_json(records: &BTreeMap<usize, Record>, out: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let rows: Vec<_> = records.values().flat_map(|record| &record.rows).collect();
    Ok(std::fs::write(out.join("verify.json"), serde_json::to_string_pretty(&rows)? + "\n")?)
}

fn print(check: &Check, record: &Record) {
    println!("# {}: {}", check.name, check.about);
    let rows = record.rows.iter().map(|row| {
        let [computed, reference] = document::numbers(row);
        [row.quantity.clone(), computed, reference, row.tolerance.clone(), row.verdict.clone()]
    });
    table::print(["quantity", "computed", "reference", "tolerance", "verdict"], rows);
    record.notes.iter().for_each(|note| println!("  {note}"));
    println!("  (it took {})", duration(record.seconds));
}
