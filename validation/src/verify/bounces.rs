//! Falls and rebounds of the sphere of the example `bouncing-sphere`, with changes.

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;
use cutwater::solver::{Observer, ObserverError, State, StepView, TimeLoop};

use super::Failure;
use super::record::{Points, Table};
use crate::case::example_path;

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

/// Time, gap and velocity of all steps.
#[derive(Default)]
struct FallRecorder(Vec<[f64; 3]>);

impl Observer<2> for FallRecorder {
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
    /// Time of the first upward velocity; `None` if the sphere does not rebound.
    pub(super) contact: Option<f64>,
    /// Times and heights of the maxima after the first contact.
    pub(super) maxima: Vec<(f64, f64)>,
    pub(super) seconds: f64,
}

/// Computes a fall of the example with changes until it is over.
pub(super) fn fall(changes: &[String], is_over: impl Fn(&[[f64; 3]]) -> bool) -> Result<Bounces, Failure> {
    let begin = std::time::Instant::now();
    let case = case::<2>(&ScenarioFile::read(&example_path("bouncing-sphere"), changes)?)?;
    let (setup, mut fall) = (case.setup, FallRecorder::default());
    let mut run = TimeLoop::new(&setup, State::initial(&setup)?, case.workspace);
    let mut last_line = begin;
    for _ in 0..case.n_steps {
        run.run(1, &mut [&mut fall])?;
        if let Some([time, gap, _]) = fall.0.last().filter(|_| last_line.elapsed() > PROGRESS) {
            let seconds = begin.elapsed().as_secs_f64();
            eprintln!("  {}: time {time:.5} s, gap {gap:.3e} m, after {seconds:.0} s", changes.join(", "));
            last_line = std::time::Instant::now();
        }
        if is_over(&fall.0) {
            break;
        }
    }
    let contact = lowest(&fall.0).map(|step| fall.0[step][0]);
    Ok(Bounces { maxima: maxima(&fall.0), contact, series: fall.0, seconds: begin.elapsed().as_secs_f64() })
}

/// Returns whether there are `bounces` maxima, and the sphere has fallen by 0.05 radii below the last one.
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

/// Computes the rebound at a Stokes number; zero without rebound until `end`, s.
pub(super) fn rebound(number: f64, mut changes: Vec<String>, end: f64) -> Result<ReboundSpeeds, Failure> {
    changes.extend([format!("fluid.viscosity={}", VISCOSITY / number), format!("time.end={end}")]);
    let is_over = |series: &[[f64; 3]]| {
        lowest(series).zip(series.last()).is_some_and(|(step, now)| now[0] > series[step][0] + FRAME)
    };
    let Bounces { series, contact, .. } = fall(&changes, is_over)?;
    let Some(contact) = contact else { return Ok(ReboundSpeeds::default()) };
    let Some(pair) = series.windows(2).find(|pair| pair[1][0] >= contact + FRAME) else {
        return Ok(ReboundSpeeds::default());
    };
    let share = (contact + FRAME - pair[0][0]) / (pair[1][0] - pair[0][0]);
    let mean = (pair[0][1] + share * (pair[1][1] - pair[0][1])) / FRAME;
    let largest = series.iter().filter(|at| at[0] >= contact).map(|at| at[2]).fold(0.0, f64::max);
    Ok(ReboundSpeeds { mean: mean / SPEED, largest: largest / SPEED })
}

/// Returns the fit `exp(-35/St)` of measured restitutions over that in air.
pub(super) fn legendre(number: f64) -> f64 {
    (-35.0 / number).exp()
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

/// Returns the gap over the time from the first contact, for times after `begin`.
pub(super) fn from_contact(bounces: &Bounces, begin: f64) -> Points {
    let contact = bounces.contact.unwrap_or_default();
    bounces.series.iter().filter(|at| at[0] > begin).map(|at| (at[0] - contact, at[1])).collect()
}
