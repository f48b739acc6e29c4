//! The numbers of a run, by the names that references use.

use std::path::{Path, PathBuf};
use std::time::Instant;

use cutwater::algebra::{DirectSolver, LinearSolver, ScaledMatrix, Workspace};
use cutwater::io::{Case, HistoryTable, Watch};
use cutwater::mesh::{Aabb, Point};
use cutwater::report::Results;
use cutwater::solver::body::Body;
use cutwater::solver::{Observer, ObserverError, StepView, advance};
use serde_json::{Value, json};

/// Whole steps in units of a factorisation of their matrix.
pub(crate) const REFACTORIZATIONS_PER_STEP: &str = "refactorizations_per_step";
/// Time over which the first mean acceleration is taken, s.
const EARLY: f64 = 0.01;
/// Smallest ratio of width to height of a plate.
pub(crate) const PLATE: f64 = 8.0;

/// Returns the numbers and properties of a run by their keys: keys of `summary.json`, keys of these cases, and whether
/// the run reached its end.
pub(crate) fn metrics(results: &Results, finished: bool) -> Result<Value, serde_json::Error> {
    let mut metrics = serde_json::to_value(&results.summary)?;
    let rebound = Rebound::new(results);
    metrics["finished"] = json!(finished);
    metrics["max_height"] = json!(rebound.map(|rebound| rebound.height));
    metrics["max_height_time"] = json!(rebound.map(|rebound| rebound.time));
    metrics["mean_acceleration_10ms"] = json!(early_acceleration(results));
    Ok(metrics)
}

/// The highest point of the leading body after its first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rebound {
    /// Largest distance after the release.
    pub(crate) height: f64,
    pub(crate) time: f64,
    /// Largest upward velocity of the centre after the release.
    pub(crate) speed: f64,
    /// Largest upward velocity after the begin of the contact. Its maximum is before the release.
    pub(crate) fastest: f64,
}

impl Rebound {
    /// Returns the rebound of a run; `None` if contact did not end.
    pub(crate) fn new(results: &Results) -> Option<Self> {
        let column = |name| results.history.column(&format!("{}{name}", results.leading_prefix()));
        let rows = [results.history.column("time")?, column("d_min")?, column("centre_velocity")?];
        Self::of(&rows, [results.summary.contact_time, results.summary.release_time])
    }

    /// Returns the rebound from times, distances and speeds, and the times of contact and release. Without contact the
    /// film of fluid throws the body back, and both are the time at which the body is nearest, unless it still
    /// approaches at the end.
    fn of([times, distances, speeds]: &[Vec<f64>; 3], [contact, release]: [Option<f64>; 2]) -> Option<Self> {
        let rows = || times.iter().zip(distances).zip(speeds).map(|((time, height), speed)| (*time, *height, *speed));
        let nearest = || rows().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|row| Some(&row.0) != times.last());
        let (contact, release) = match contact {
            Some(contact) => (contact, release?),
            None => nearest().map(|row| (row.0, row.0))?,
        };
        let since_contact = rows().filter(|(time, _, _)| *time >= contact);
        let fastest = since_contact.map(|(_, _, speed)| speed).fold(f64::NEG_INFINITY, f64::max);
        let rebounds = rows().map(|(time, height, speed)| Self { height, time, speed, fastest });
        rebounds.filter(|now| now.time >= release).reduce(|best, now| {
            let highest = if now.height > best.height { now } else { best };
            Self { speed: best.speed.max(now.speed), ..highest }
        })
    }
}

/// Returns the vertical velocity of the centre of the leading body after 10 ms, divided by that time.
fn early_acceleration(results: &Results) -> Option<f64> {
    let times = results.history.column("time")?;
    let velocities = results.history.column(&format!("{}centre_velocity", results.leading_prefix()))?;
    let (time, velocity) = times.into_iter().zip(velocities).find(|(time, _)| *time >= EARLY * (1.0 - 1e-9))?;
    Some(velocity / time)
}

/// Returns the median over the steps of the time of all tasks together.
fn median_step_seconds(history: &HistoryTable) -> Option<f64> {
    let tasks = ["cut", "space", "assembly", "linear", "output"];
    let columns: Option<Vec<Vec<f64>>> = tasks.iter().map(|task| history.column(&format!("seconds_{task}"))).collect();
    let columns = columns?;
    let mut steps: Vec<f64> = (0..columns[0].len()).map(|k| columns.iter().map(|column| column[k]).sum()).collect();
    median(&mut steps)
}

/// Returns the median; `None` if there are no values.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Observer that measures the cost of a sparse LU factorisation of the system of the first step, with a known pattern.
#[derive(Debug, Default)]
pub(crate) struct Factorization {
    seconds: Option<f64>,
}

impl Factorization {
    /// Divides the median time of a step of the case by the time of a factorisation, and prints both.
    pub(crate) fn per_step(&self, name: &str, results: &Results) -> Option<f64> {
        let (step, seconds) = median_step_seconds(&results.history).zip(self.seconds)?;
        println!("  {name}: median step {:.1} ms, refactorisation {:.1} ms", 1e3 * step, 1e3 * seconds);
        Some(step / seconds)
    }
}

impl Watch for Factorization {
    fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        Some(Box::new(self))
    }
}

impl<const D: usize> Observer<D> for &mut Factorization {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let Some(report) = view.report.filter(|_| self.seconds.is_none()) else { return Ok(()) };
        // Repeats the step in memory of its own, which keeps the system.
        let mut work = Workspace::new();
        advance(view.setup, view.previous, report.substep, &mut work)?;
        let matrix = ScaledMatrix::new(work.system().matrix())?;
        let system = matrix.system(work.system().layout())?;
        let mut solver = DirectSolver::new();
        solver.factorize(&system)?;
        let mut seconds = [0.0; 3];
        for time in &mut seconds {
            let begin = Instant::now();
            solver.factorize(&system)?;
            *time = begin.elapsed().as_secs_f64();
        }
        self.seconds = median(&mut seconds);
        Ok(())
    }
}

/// File of the thickness of plates in a directory of results.
pub(crate) const THICKNESS: &str = "thickness.csv";

/// Observer that writes the smallest thickness of each plate after every step: `time`, then a column for each plate.
pub(crate) struct Thickness<'a> {
    pub(crate) directory: &'a Path,
}

impl Watch for Thickness<'_> {
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        let plates: Vec<usize> =
            (0..case.setup.bodies.len()).filter(|k| is_plate(case.setup.bodies[*k].as_ref())).collect();
        if D != 2 || plates.is_empty() {
            return None;
        }
        let names: Vec<&str> = plates.iter().map(|&plate| case.setup.bodies[plate].name()).collect();
        let text = format!("time,{}\n", names.join(","));
        Some(Box::new(ThicknessRows { path: self.directory.join(THICKNESS), plates, text }))
    }
}

struct ThicknessRows {
    path: PathBuf,
    plates: Vec<usize>,
    text: String,
}

impl<const D: usize> Observer<D> for ThicknessRows {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        if view.report.is_some() {
            let thickness = |&plate: &usize| {
                let body = &view.setup.bodies[plate];
                smallest_thickness(body.as_ref(), &view.state.bodies[plate].positions(body.reference())).to_string()
            };
            let row: Vec<String> = self.plates.iter().map(thickness).collect();
            self.text += &format!("{},{}\n", view.state.time, row.join(","));
        }
        Ok(std::fs::write(&self.path, &self.text)?)
    }
}

/// Returns whether a body is many times wider than high. A plate with a plane of symmetry is represented by one half.
pub(crate) fn is_plate<const D: usize>(body: &dyn Body<D>) -> bool {
    let extent = Aabb::of_points(body.reference()).extent();
    (0..D - 1).all(|k| extent[k] > 0.5 * PLATE * extent[D - 1])
}

/// Returns the smallest height of a body over its width: upper minus lower side. Both are straight between the
/// vertices, so that the smallest value is at one of them.
fn smallest_thickness<const D: usize>(body: &dyn Body<D>, positions: &[Point<D>]) -> f64 {
    let boundary = body.surface();
    let edges: Vec<[[f64; 2]; 2]> = boundary
        .facets()
        .map(|facet| boundary.facet(facet))
        .map(|ends| [0, 1].map(|k| [positions[ends[k].index()][0], positions[ends[k].index()][D - 1]]))
        .collect();
    let thickness = |x: f64| {
        let heights = edges.iter().filter(|[a, b]| a[0].min(b[0]) <= x && x <= a[0].max(b[0]) && a[0] != b[0]);
        let heights = heights.map(|[a, b]| a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        high - low
    };
    let all = edges.iter().flatten().map(|x| thickness(x[0]));
    all.filter(|t| t.is_finite()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rebound_begins_at_the_release_or_where_the_body_is_nearest() {
        let rows = [vec![1.0, 2.0, 3.0, 4.0, 5.0], vec![3.0, 1.0, 2.0, 4.0, 3.5], vec![-2.0, 5.0, 2.0, 1.0, -1.0]];
        let expected = |speed, fastest| Some(Rebound { height: 4.0, time: 4.0, speed, fastest });
        assert_eq!(Rebound::of(&rows, [Some(2.0), Some(3.0)]), expected(2.0, 5.0));
        assert_eq!(Rebound::of(&rows, [Some(2.0), None]), None, "contact did not end");
        assert_eq!(Rebound::of(&rows, [None, None]), expected(5.0, 5.0));
        let approach = rows.map(|column| column[..2].to_vec());
        assert_eq!(Rebound::of(&approach, [None, None]), None, "it still approaches");
    }
}
