//! Falls and rebounds of the sphere of the example `bouncing-sphere`, with changes.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use cutwater::io::{Case, ScenarioFile, Watch};
use cutwater::report::Results;
use cutwater::solver::{Observer, ObserverError, StepView};

use super::record::{Points, TextTable};
use super::{Failure, Record};
use crate::case::example_path;
use crate::stored::{CHECKPOINTS, StoredRun};
use crate::workers;

/// Radius of the sphere, m.
pub(super) const RADIUS: f64 = 1.5e-3;
/// Speed of the approach, m/s.
pub(super) const SPEED: f64 = 0.585;
/// Viscosity of the oil of the example times its Stokes number, Pa s. Their product is the same at all Stokes numbers.
const VISCOSITY: f64 = 0.010 * 152.0;
/// Time between two pictures of the experiment of the example, s. The speed of rebound is the mean over this time.
pub(super) const FRAME: f64 = 2e-3;
/// Restitution in air.
pub(super) const IN_AIR: f64 = 0.97;

/// Note on the definition of the restitution in the short versions.
pub(super) const FORMER: &str = "The restitution was first that of the largest speed after the collision, which is the speed inside of the film and is not measured by any experiment. It is now \
                                 that of the mean speed in the first 2 ms, the time between two pictures; the bounds are the same.";

/// Half of the standard sizes of the refined cells, m.
pub(super) const HALF: [f64; 4] = [7.5e-5, 3.75e-5, 1.875e-5, 4.6875e-6];
/// Twice the standard sizes of the refined cells, m.
pub(super) const TWICE: [f64; 4] = [3e-4, 1.5e-4, 7.5e-5, 1.875e-5];

/// Time between two lines of progress on the standard error.
const PROGRESS: std::time::Duration = std::time::Duration::from_secs(60);

/// A fall of the sphere of the example.
pub(super) struct Fall {
    /// Name, from which that of the directory of its results is made.
    pub(super) name: String,
    /// Changes of the example.
    pub(super) changes: Vec<String>,
    /// Condition on time, gap and velocity of all steps so far that ends the fall.
    pub(super) is_over: fn(&[[f64; 3]]) -> bool,
}

/// Watch that records time, gap and velocity of each step, and sets `stop` when the fall is over.
struct FallWatch<'a> {
    fall: &'a Fall,
    series: Vec<[f64; 3]>,
    stop: &'a AtomicBool,
    begin: Instant,
    last_line: Instant,
}

impl Watch for FallWatch<'_> {
    fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        Some(Box::new(self))
    }
}

impl<const D: usize> Observer<D> for &mut FallWatch<'_> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let time = view.state.time;
        let Some(body) = view.report.map(|report| &report.bodies[0]) else {
            // A run that is resumed begins at its checkpoint.
            self.series.retain(|at| at[0] <= time);
            return Ok(());
        };
        let gap = body.lowest.1[D - 1];
        self.series.push([time, gap, body.lowest_velocity[D - 1]]);
        if self.last_line.elapsed() > PROGRESS {
            let seconds = self.begin.elapsed().as_secs_f64();
            eprintln!("  {}: time {time:.5} s, gap {gap:.3e} m, after {seconds:.0} s", self.fall.name);
            self.last_line = Instant::now();
        }
        if (self.fall.is_over)(&self.series) {
            self.stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

/// A fall with its bounces.
pub(super) struct Bounces {
    /// Time, gap and velocity of all steps.
    pub(super) series: Vec<[f64; 3]>,
    /// Time of the first upward velocity; `None` if the sphere does not rebound.
    pub(super) contact: Option<f64>,
    /// Times and heights of the maxima after the first contact.
    pub(super) maxima: Vec<(f64, f64)>,
    /// Wall-clock time of the run in all commands, s.
    pub(super) seconds: f64,
}

/// Computes falls, some at a time, and returns them in their order. In the long version, falls of earlier commands by
/// the same code are not computed again, or are resumed.
pub(super) fn compute(falls: &[Fall], record: &mut Record) -> Result<Vec<Bounces>, Failure> {
    let mut found = Vec::new();
    let folder = record.directory.clone();
    let again = !record.full;
    let work = |fall: &Fall| workers::on_one_thread(|| fall.run(&folder, again))?;
    let finish = |fall: &Fall, bounces: Bounces| {
        record.seconds += bounces.seconds;
        found.push((falls.iter().position(|of| std::ptr::eq(of, fall)), bounces));
        Ok(())
    };
    workers::for_each(falls, |fall| fall.name.clone(), work, finish)?;
    found.sort_by_key(|(place, _)| *place);
    Ok(found.into_iter().map(|(_, bounces)| bounces).collect())
}

impl Fall {
    /// Runs the fall until it is over, or reads results of the same code unless `again` is set.
    fn run(&self, folder: &Path, again: bool) -> Result<Bounces, Failure> {
        let directory = folder.join(self.name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "-"));
        let output = ["output.vtk_every=0".to_owned(), CHECKPOINTS.to_owned()];
        let changes: Vec<String> = self.changes.iter().cloned().chain(output).collect();
        let file = ScenarioFile::read(&example_path("bouncing-sphere"), &changes)?;
        let stored = StoredRun { file: &file, directory: &directory };
        let read = || -> Result<_, Failure> {
            let Results { history, summary, .. } = Results::read(&directory)?;
            let column = |name| history.column(name).ok_or_else(|| format!("{name} is not a column"));
            let [times, gaps, velocities] = [column("time")?, column("d_min")?, column("lowest_velocity")?];
            let series =
                times.into_iter().zip(gaps).zip(velocities).map(|((time, gap), velocity)| [time, gap, velocity]);
            Ok((series.collect::<Vec<_>>(), summary.wall_seconds))
        };
        let stored_series = Some(()).filter(|()| !again && stored.is_current()).and_then(|()| read().ok());
        let is_new = stored_series.is_none();
        let (series, _) = stored_series.unwrap_or_default();
        if (self.is_over)(&series) {
            println!("  {}: results of {}", self.name, stored.version());
        } else {
            let (stop, begin) = (AtomicBool::new(false), Instant::now());
            let mut watch = FallWatch { fall: self, series, stop: &stop, begin, last_line: begin };
            stored.run(is_new, &mut watch, Some(&stop))?;
        }
        let (series, seconds) = read()?;
        let contact = lowest(&series).map(|step| series[step][0]);
        Ok(Bounces { maxima: maxima(&series), contact, series, seconds })
    }
}

/// Returns whether there are `bounces` maxima, and the sphere has fallen by a twentieth of a radius below the last one.
pub(super) fn has_bounced(series: &[[f64; 3]], bounces: usize, radius: f64) -> bool {
    let (maxima, now) = (maxima(series), series.last().map_or(0.0, |at| at[1]));
    maxima.len() >= bounces && maxima.last().is_some_and(|(_, height)| now < height - 0.05 * radius)
}

/// Returns the index of the step before the first upward velocity.
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

/// Returns the changes for a sphere that is released one radius from the floor, on coarse cells.
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

/// Returns the changes for given sizes of the refined cells.
pub(super) fn cells(sizes: [f64; 4]) -> impl Iterator<Item = String> {
    (0..).zip(sizes).map(|(k, size): (usize, f64)| format!("background.refine.{k}.size={size}"))
}

/// Speeds of a rebound over that of the approach.
#[derive(Default)]
pub(super) struct ReboundSpeeds {
    /// Mean speed in the first frame.
    pub(super) mean: f64,
    /// Largest speed in the first frame: in the film just after the collision, where no experiment measures it.
    pub(super) largest: f64,
}

/// Computes the rebounds at Stokes numbers, with changes of the example; zero without a rebound until `end`, s.
pub(super) fn rebounds(
    numbers: &[f64],
    changes: &[String],
    end: f64,
    record: &mut Record,
) -> Result<Vec<ReboundSpeeds>, Failure> {
    let falls: Vec<Fall> = numbers
        .iter()
        .map(|number| {
            let own = [format!("fluid.viscosity={}", VISCOSITY / number), format!("time.end={end}")];
            let changes = changes.iter().cloned().chain(own).collect();
            let is_over = |series: &[[f64; 3]]| {
                lowest(series).zip(series.last()).is_some_and(|(step, now)| now[0] > series[step][0] + FRAME)
            };
            Fall { name: format!("St {number}"), changes, is_over }
        })
        .collect();
    Ok(compute(&falls, record)?.iter().map(|bounces| rebound(bounces).unwrap_or_default()).collect())
}

/// Returns the speeds of the first rebound; `None` without one.
fn rebound(Bounces { series, contact, .. }: &Bounces) -> Option<ReboundSpeeds> {
    let contact = (*contact)?;
    let pair = series.windows(2).find(|pair| pair[1][0] >= contact + FRAME)?;
    let share = (contact + FRAME - pair[0][0]) / (pair[1][0] - pair[0][0]);
    let mean = (pair[0][1] + share * (pair[1][1] - pair[0][1])) / FRAME;
    let largest = series.iter().filter(|at| at[0] >= contact).map(|at| at[2]).fold(0.0, f64::max);
    Some(ReboundSpeeds { mean: mean / SPEED, largest: largest / SPEED })
}

/// Returns the fit `exp(-35/St)` of measured restitutions over that in air.
pub(super) fn legendre(number: f64) -> f64 {
    (-35.0 / number).exp()
}

/// Returns a table of inputs: quantity, value and source of each. The values are those of radius, densities, viscosity
/// and speed; all experiments have the others.
pub(super) fn inputs([radius, densities, viscosity, speed]: [&str; 4]) -> TextTable {
    let rows = [
        ["radius of the sphere", radius, "experiment"],
        ["densities", densities, "experiment"],
        ["viscosity", viscosity, "experiment"],
        ["speed of the approach", speed, "experiment; prescribed until the gap to the floor is 1.8 radii"],
        ["restitution in air", "0.97", "experiment, 0.95 to 0.98 with other spheres of steel"],
        ["roughness", "1e-4 radii", "order of magnitude that the authors state; that of this sphere is not known"],
        ["vapour", "1 bar below the pressure of the surroundings", "a tank at atmospheric pressure; not measured"],
        ["tank", "radius 10 radii, height 26 radii, open top", "not known; chosen"],
    ];
    TextTable {
        head: ["input", "value", "source"].map(str::to_owned).to_vec(),
        rows: rows.map(|row| row.map(str::to_owned).to_vec()).to_vec(),
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

/// Returns the gap over the time from the first contact, for times after `begin`.
pub(super) fn from_contact(bounces: &Bounces, begin: f64) -> Points {
    let contact = bounces.contact.unwrap_or_default();
    bounces.series.iter().filter(|at| at[0] > begin).map(|at| (at[0] - contact, at[1])).collect()
}
