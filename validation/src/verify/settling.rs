//! Elastic bodies that settle in a closed tank and touch each other or its walls: scenarios of the examples.

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;
use cutwater::solver::{Observer, ObserverError, State, StepSeconds, StepView, TimeLoop};

use crate::case::example_path;
use crate::units::cgs;

use super::{Failure, Record, short};

/// Largest overlap over the contact size.
const OVERLAP: f64 = 0.02;
/// Largest speed at the end over the largest one of the run.
const REST: f64 = 0.01;
/// Largest share of the wall-clock time of a step that search and assembly of contacts take.
const COST: f64 = 0.1;
/// Largest imbalance of forces on a body over its weight.
const BALANCE: f64 = 1e-6;

/// Measures thirty disks. The quick version has a coarser fluid, and ends when disks are in contact.
pub(super) fn disks(record: &mut Record) -> Result<(), Failure> {
    measure(record, "settling-disks", &["background.size=0.08", "time.end=0.4"])?;
    record.note("Each two disks, each disk with itself, and each with floor and walls may touch.");
    Ok(())
}

/// Measures an ellipse on a step. The quick version ends when it has left the step.
pub(super) fn ellipse(record: &mut Record) -> Result<(), Failure> {
    measure(record, "falling-ellipse", &["time.end=0.25"])?;
    record.note("Ellipse and tank are meshes from Gmsh files; the triangles of the ellipse are of second order.");
    Ok(())
}

/// Measures overlaps, rest and forces of an example.
fn measure(record: &mut Record, example: &str, quick: &[&str]) -> Result<(), Failure> {
    let changes: &[&str] = if record.full { &[] } else { quick };
    let changes: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    let mut case = case::<2>(&ScenarioFile::read(&example_path(example), &changes)?)?;
    let size = case.setup.contacts.first().ok_or("there is a contact")?.form().size();
    let mut fall = SettlingHistory { smallest_gap: f64::INFINITY, ..SettlingHistory::default() };
    let state = State::initial(&case.setup)?;
    let workspace = std::mem::take(&mut case.workspace);
    TimeLoop::new(&case.setup, state, workspace).run(case.n_steps, &mut [&mut fall])?;
    record.show("contacts of two bodies or of a body with a wall, at most at a time", fall.n_contacts as f64, None);
    record.at_most("largest overlap over the contact size", -fall.smallest_gap / size, OVERLAP);
    record.at_most(
        "fluid, weight, contacts and inertia of a body: largest remainder over the weight",
        fall.remainder,
        BALANCE,
    );
    let share = fall.seconds_of_contact / fall.seconds;
    record.at_most("time for search and assembly of contacts over that of a step", share, COST);
    let largest = fall.speeds.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
    let (_, last) = fall.speeds.last().copied().ok_or("there are steps")?;
    if record.full {
        record.at_most("largest speed of a centre at the end over the largest one of the run", last / largest, REST);
    } else {
        record.show(cgs("largest speed of a centre at the end [<velocity>]"), last, None);
    }
    let curves = vec![
        (cgs("largest speed of a centre [<velocity>]"), fall.speeds),
        (cgs("mean height of the centres [<length>]"), fall.heights),
    ];
    record.figure("Speed and height", "time [s]", curves);
    record.note(format!(
        "`examples/{example}.toml`: contact acts from a distance of {} cm. Below it bodies overlap only if the law is violated by all of that distance.",
        short(case.setup.contacts[0].form().law.offset()),
    ));
    Ok(())
}

/// History of the bodies.
#[derive(Default)]
struct SettlingHistory {
    /// Time, and largest speed of a centre.
    speeds: Vec<(f64, f64)>,
    /// Time, and mean height of the centres.
    heights: Vec<(f64, f64)>,
    smallest_gap: f64,
    remainder: f64,
    n_contacts: usize,
    /// Wall-clock time of the steps, and that for contacts in it.
    seconds: f64,
    seconds_of_contact: f64,
}

impl Observer<2> for SettlingHistory {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        let Some(report) = view.report else { return Ok(()) };
        let balances = || report.bodies.iter().filter_map(|body| body.balance.as_ref());
        let speed = balances().map(|balance| (balance.momentum / balance.mass).norm()).fold(0.0, f64::max);
        let heights: Vec<f64> = balances().map(|balance| balance.centre_of_mass[1]).collect();
        self.speeds.push((view.state.time, speed));
        self.heights.push((view.state.time, heights.iter().sum::<f64>() / heights.len() as f64));
        let gaps = report.contacts.iter().filter_map(|contact| contact.minimum_gap);
        self.smallest_gap = gaps.fold(self.smallest_gap, f64::min);
        self.n_contacts = self.n_contacts.max(report.contacts.iter().filter(|contact| contact.is_active()).count());
        let StepSeconds { cut, space, search, assembly, linear, .. } = report.seconds;
        self.seconds += cut + space + assembly + linear;
        let timings = report.newton.timings.iter().filter(|timing| ["contact", "regime"].contains(&timing.name));
        self.seconds_of_contact += search + timings.map(|timing| timing.seconds).sum::<f64>();
        let forces = report.bodies.iter().filter_map(|body| body.forces.as_ref());
        let remainders = forces.map(|forces| forces.remainder().norm() / forces.body_force.norm());
        self.remainder = remainders.fold(self.remainder, f64::max);
        Ok(())
    }
}
