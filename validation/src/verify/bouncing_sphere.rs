//! A sphere that bounces off the floor of a tank, compared with measured heights.
//!
//! Source: Gondret, Lance, Petit 2002, Physics of Fluids 14, 643, doi:10.1063/1.1427920; steel in silicone oil, Stokes number 152.

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;
use cutwater::solver::{Observer, ObserverError, State, StepView, TimeLoop};

use super::rebound_scan::{IN_AIR, legendre, restitution};
use super::record::{Points, Table};
use super::{Failure, Record};
use crate::case::example_path;

/// Radius of the sphere, m; speed of the approach, m/s.
pub(super) const RADIUS: f64 = 1.5e-3;
pub(super) const SPEED: f64 = 0.585;
/// Measured heights of the bounces, m, with the largest relative errors; the third is shown.
const HEIGHTS: [(f64, Option<f64>); 3] = [(7.466e-3, Some(0.05)), (2.234e-3, Some(0.08)), (0.520e-3, None)];
/// Largest relative error of the speed at a gap of one radius, and change of the heights with mesh and step.
const APPROACH: f64 = 0.02;
const CHANGE: f64 = 0.03;
/// Longest wall-clock time through the second bounce, s.
const COST: f64 = 2400.0;
/// Scatter of measured restitutions, with that of coarse meshes.
const SCATTER: f64 = 0.15;
/// Measured times from the first contact to the heights, s.
const TIMES: [f64; 3] = [0.038, 0.106, 0.140];
const INPUTS: [[&str; 3]; 8] = [
    ["radius of the sphere", "1.5 mm", "experiment"],
    ["densities", "7800 and 935 kg/m³", "experiment"],
    ["viscosity", "0.010 Pa s", "experiment"],
    ["speed of the approach", "0.585 m/s", "experiment; the sphere is moved at it until 1.8 radii over the floor"],
    ["restitution in air", "0.97", "experiment, 0.95 to 0.98 with other spheres of steel"],
    ["roughness", "1e-4 radii", "order of magnitude that the authors state; that of this sphere is not known"],
    ["vapour", "1 bar below the pressure of the surroundings", "a tank at atmospheric pressure; not measured"],
    ["tank", "radius 10 radii, height 26 radii, open top", "not known; chosen"],
];
const MEASURED: &str = include_str!("../../reference/gondret/St152.csv");

/// Time, gap and velocity of all steps.
#[derive(Default)]
struct Fall(Vec<[f64; 3]>);

impl Observer<2> for Fall {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        if let Some(body) = view.report.map(|report| &report.bodies[0]) {
            self.0.push([view.state.time, body.lowest.1[1], body.lowest_velocity[1]]);
        }
        Ok(())
    }
}

/// A fall with its bounces.
pub(super) struct Bounces {
    /// Time, gap and velocity of all steps.
    pub(super) series: Vec<[f64; 3]>,
    /// Time of the first upward velocity; `None` if the sphere does not turn.
    pub(super) contact: Option<f64>,
    /// Times and heights of the maxima after it.
    pub(super) maxima: Vec<(f64, f64)>,
    seconds: f64,
}

/// Computes a fall of the example with changes until it is over.
pub(super) fn fall(changes: &[String], is_over: impl Fn(&[[f64; 3]]) -> bool) -> Result<Bounces, Failure> {
    let begin = std::time::Instant::now();
    let case = case::<2>(&ScenarioFile::read(&example_path("bouncing-sphere"), changes)?)?;
    let (setup, mut fall) = (case.setup, Fall::default());
    let mut run = TimeLoop::new(&setup, State::initial(&setup)?, case.workspace);
    for _ in 0..case.n_steps {
        run.run(1, &mut [&mut fall])?;
        if is_over(&fall.0) {
            break;
        }
    }
    let contact = lowest(&fall.0).map(|step| fall.0[step][0]);
    Ok(Bounces { maxima: maxima(&fall.0), contact, series: fall.0, seconds: begin.elapsed().as_secs_f64() })
}

/// Returns whether there are some maxima after the first contact. The last one counts once the sphere has fallen by a part of a radius.
pub(super) fn has_bounced(series: &[[f64; 3]], bounces: usize, radius: f64) -> bool {
    let (maxima, now) = (maxima(series), series.last().map_or(0.0, |at| at[1]));
    maxima.len() >= bounces && maxima.last().is_some_and(|(_, height)| now < height - 0.05 * radius)
}

/// Returns the number of the step with the first upward velocity.
fn lowest(series: &[[f64; 3]]) -> Option<usize> {
    series.windows(2).position(|pair| pair[0][2] < 0.0 && pair[1][2] > 0.0)
}

/// Returns the times and heights at which the velocity changes from upward to downward.
fn maxima(series: &[[f64; 3]]) -> Vec<(f64, f64)> {
    let turns = series.windows(2).filter(|pair| pair[0][2] > 0.0 && pair[1][2] <= 0.0);
    turns.map(|pair| (pair[0][0], pair[0][1].max(pair[1][1]))).collect()
}

/// Returns the speed at which a gap is passed downwards for the first time.
pub(super) fn speed_at(series: &[[f64; 3]], gap: f64) -> Option<f64> {
    let pair = series.windows(2).find(|pair| pair[0][1] >= gap && pair[1][1] < gap)?;
    let share = (pair[0][1] - gap) / (pair[0][1] - pair[1][1]);
    Some(-(pair[0][2] + share * (pair[1][2] - pair[0][2])))
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if record.full { compare(record) } else { coarse(record) }
}

/// Returns the changes for a sphere that is released at a radius from the floor on coarse cells.
pub(super) fn coarse_cells() -> Vec<String> {
    let mut changes: Vec<String> = [
        "body.0.shape.centre=[0.0, 4.5e-3]",
        "body.0.shape.size=4.0e-5",
        "body.0.motion.guided.until=3.0e-3",
        "body.0.motion.guided.velocity=[\"0\", \"-0.585*min(t/1e-3, 1)\"]",
        "time.step=1.0e-4",
        "time.end=0.02",
        "time.approach.fraction=0.2",
        "time.approach.smallest=5.0e-6",
    ]
    .map(str::to_owned)
    .to_vec();
    changes.extend(cells([6e-4, 3e-4, 1.5e-4, 6e-5]));
    changes
}

/// Returns the changes for other sizes of the refined cells.
pub(super) fn cells(sizes: [f64; 4]) -> impl Iterator<Item = String> {
    (0..).zip(sizes).map(|(k, size): (usize, f64)| format!("background.refine.{k}.size={size}"))
}

/// Sizes of the refined cells of twice the standard size, m.
pub(super) const TWICE: [f64; 4] = [3e-4, 1.5e-4, 7.5e-5, 1.875e-5];

/// Lets the sphere go near the floor on a coarse mesh.
fn coarse(record: &mut Record) -> Result<(), Failure> {
    let found = restitution(152.0, coarse_cells(), 0.02)? / IN_AIR;
    let name = "coarse cells, released at a radius from the floor: restitution over that in air";
    record.near(name, found, legendre(152.0), SCATTER);
    Ok(())
}

/// Compares the bounces with the measured ones, and with those on another mesh, with other steps, and without vapour.
fn compare(record: &mut Record) -> Result<(), Failure> {
    let long = ["time.end=0.2".to_owned()];
    let bounces = |changes: &[String], number| fall(changes, |series| has_bounced(series, number, RADIUS));
    let standard = bounces(&long, 3)?;
    let contact = standard.contact.ok_or("the sphere does not reach the floor")?;
    let speed = speed_at(&standard.series, RADIUS).ok_or("the sphere does not reach the floor")?;
    record.near_relative("speed at a gap of one radius [m/s]", speed, SPEED, APPROACH);
    for (k, (height, bound)) in HEIGHTS.into_iter().enumerate() {
        let found = standard.maxima.get(k).map_or(f64::NAN, |at| at.1);
        let name = format!("height of bounce {} [m]", k + 1);
        match bound {
            Some(bound) => record.near_relative(name, found, height, bound),
            None => record.show(name, found, Some(height)),
        }
    }
    for (k, time) in TIMES.into_iter().enumerate() {
        let found = standard.maxima.get(k).map_or(f64::NAN, |at| at.0 - contact);
        record.show(format!("time from contact to height {} [s]", k + 1), found, Some(time));
    }
    record.at_most("wall-clock time of all bounces on one core [s]", standard.seconds, COST);
    let coarse_steps = ["time.step=1.0e-4", "time.approach.fraction=0.12", "time.approach.smallest=1.0e-6"];
    let variants = [
        ("cells of twice the size", cells(TWICE).collect::<Vec<_>>(), Some(CHANGE)),
        ("steps of twice the length", coarse_steps.map(str::to_owned).to_vec(), Some(CHANGE)),
        ("vapour only at -1000 bar", vec!["fluid.film.floor=-1e8".to_owned()], None),
    ];
    let mut curves = vec![
        ("measured".to_owned(), measured(MEASURED)?),
        ("computed".to_owned(), from_contact(&standard, contact - 0.016)),
    ];
    for (name, changes, bound) in variants {
        let changes: Vec<String> = long.iter().cloned().chain(changes).collect();
        let other = bounces(&changes, 2)?;
        for (k, of) in standard.maxima.iter().take(2).enumerate() {
            let change = other.maxima.get(k).map_or(f64::NAN, |found| (found.1 / of.1 - 1.0).abs());
            let row = format!("{name}: relative change of the height of bounce {}", k + 1);
            match bound {
                Some(bound) => record.at_most(row, change, bound),
                None => record.show(row, change, None),
            }
        }
        let shown = other.contact.map_or(0.0, |contact| contact - 0.016);
        curves.push((name.to_owned(), from_contact(&other, shown)));
    }
    record.figure("Gap over the time from the first contact [m]", "time [s]", curves);
    record.tables.push(inputs(&INPUTS));
    record.note("Nothing is fitted; the coefficients are those of the standard set.");
    Ok(())
}

/// Returns a table of inputs: quantity, value and source of each.
pub(super) fn inputs(rows: &[[&str; 3]]) -> Table {
    Table {
        head: ["input", "value", "source"].map(str::to_owned).to_vec(),
        rows: rows.iter().map(|row| row.map(str::to_owned).to_vec()).collect(),
    }
}

/// Returns measured points: time from the first contact and gap.
pub(super) fn measured(text: &str) -> Result<Points, Failure> {
    let points = text.lines().skip(1).map(|line| {
        let (time, gap) = line.split_once(',').ok_or("two columns")?;
        Ok((time.parse()?, gap.parse()?))
    });
    points.collect()
}

/// Returns the gap over the time from the first contact, from some time on.
pub(super) fn from_contact(bounces: &Bounces, begin: f64) -> Points {
    let contact = bounces.contact.unwrap_or_default();
    bounces.series.iter().filter(|at| at[0] > begin).map(|at| (at[0] - contact, at[1])).collect()
}
