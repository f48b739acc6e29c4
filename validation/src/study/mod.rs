//! Studies: runs of a case that differ in one number. Definitions are in `studies/`, outcomes in the book.

mod definition;
mod limit;

use std::path::Path;

use cutwater::io::{self, ScenarioFile, Summary};
use cutwater::report::Results;

pub(crate) use self::definition::names;
use self::definition::{Definition, StudySeries};
use self::limit::{Limit, richardson};
use crate::bounds::potential::{arrival, gaps};
use crate::case;
use crate::metrics::Rebound;
use crate::outcome::{Failure, Outcome, causes};
use crate::report::machine;
use crate::results;
use crate::stored::{CHECKPOINTS, StoredRun};
use crate::table::short;
use crate::units::cgs;
use crate::verify::record::{Record, TextTable, worse};
use crate::verify::{document, missed};
use crate::workers;

/// Folder of the pages of studies in `docs/src`.
const FOLDER: &str = "studies";

/// The outcome of a run.
#[derive(Clone, Debug, Default)]
struct StudyRun {
    value: f64,
    /// Cause if the run stopped before its end.
    failure: Option<String>,
    summary: Summary,
    /// Time at which the distance passes the contact offset: the contact time to a fraction of a step.
    arrival_time: Option<f64>,
    /// Smallest distance at the end of the first approach.
    closest: Option<f64>,
    rebound: Option<Rebound>,
    /// Time at which the ball would reach the contact offset in an ideal fluid.
    bound: Option<f64>,
    version: String,
}

impl StudyRun {
    /// Returns the contact time: to a fraction of a step, if the distance passes the contact offset.
    fn first_contact(&self) -> Option<f64> {
        self.arrival_time.or(self.summary.contact_time)
    }
}

/// Runs studies. Returns whether every run came to its end and every verdict holds. The results of a run are kept in a
/// directory of its own. A run whose directory has all steps of the same scenario is not repeated, and one that was
/// stopped is resumed by the same code, unless `again` is set. The page of a study in the book is written when all its
/// runs are done.
///
/// # Errors
/// There is no such study, or a file cannot be read or written.
pub(crate) fn run(names: &[String], again: bool, out: &Path) -> Outcome {
    document::require_clean_tree()?;
    let studies = names.iter().map(|name| Ok((name, definition::read(name)?))).collect::<Result<Vec<_>, String>>()?;
    let mut all_hold = true;
    for (name, definition) in studies {
        println!("# {name}: {}", definition.title);
        let mut runs: Vec<Vec<StudyRun>> =
            definition.series.iter().map(|s| vec![StudyRun::default(); s.values.len()]).collect();
        let places: Vec<[usize; 2]> =
            runs.iter().enumerate().flat_map(|(series, of)| (0..of.len()).map(move |k| [series, k])).collect();
        let folder = out.join("studies").join(name);
        let directory = |&[series, k]: &[usize; 2]| folder.join(definition.series[series].stem(k));
        let start = |place: &[usize; 2]| run_one(name, &definition, *place, again, &directory(place));
        let finish = |&[series, k]: &[usize; 2], run: StudyRun| {
            println!("  {}", [vec![definition.series[series].name.clone()], row(&run)].concat().join(", "));
            runs[series][k] = run;
            Ok(())
        };
        workers::for_each(&places, |place| directory(place).display().to_string(), start, finish)?;
        all_hold &= runs.iter().flatten().all(|run| run.failure.is_none());
        let mut versions: Vec<&str> = runs.iter().flatten().map(|run| run.version.as_str()).collect();
        versions.sort_unstable();
        versions.dedup();
        let version = format!("{} ({})", versions.join("; "), machine().trim_end_matches('.'));
        let mut record = record(name, &definition, &runs);
        missed::mark(&mut record)?;
        all_hold &= record.holds();
        document::write(FOLDER, &record, &format!("cargo xtask validate --study {name}"), &version)?;
    }
    Ok(all_hold)
}

fn run_one(
    study: &str,
    definition: &Definition,
    [series, k]: [usize; 2],
    again: bool,
    directory: &Path,
) -> Result<StudyRun, Failure> {
    let series = &definition.series[series];
    let value = series.values[k];
    let mut set = vec![format!("name={study}"), "output.vtk_every=0".to_owned(), CHECKPOINTS.to_owned()];
    set.extend(definition.changes(series, value));
    let file = ScenarioFile::read(&case::scenario_path(&series.scenario), &set)?;
    let stored = StoredRun { file: &file, directory };
    let is_done = |results: &Results| results.summary.steps == file.n_steps();
    let known = Results::read(directory).ok().filter(|results| !again && stored.is_of_scenario() && is_done(results));
    let (results, failure) = match known {
        Some(results) => (results, None),
        None => {
            let failure = match stored.run(again, &mut (), None) {
                Ok(()) => None,
                Err(error @ io::Error::Step(_)) => {
                    Some(causes(&error).fold(error.to_string(), |text, cause| format!("{text}: {cause}")))
                }
                Err(error) => return Err(error.into()),
            };
            (Results::read(directory)?, failure)
        }
    };
    let column = |name: String| results.history.column(&name).unwrap_or_default();
    let (times, distances) = (column("time".to_owned()), column(format!("{}d_min", results.leading_prefix())));
    Ok(StudyRun {
        value,
        failure,
        arrival_time: results.summary.contact_offset.and_then(|offset| passes(&times, &distances, offset)),
        closest: first_approach(&distances),
        // A ball that still rises at the end has no highest point.
        rebound: Rebound::new(&results).filter(|rebound| Some(&rebound.time) != times.last()),
        bound: gaps(&results.scenario).map(|(start, offset)| arrival(start, offset).time),
        version: stored.version(),
        summary: results.summary,
    })
}

/// Columns of the table of a study with marks of units, after the name of the series; those of [`row`].
const HEAD: [&str; 13] = [
    "value",
    "contact [s]",
    "release [s]",
    "contacts",
    "closest on first approach [<length>]",
    "speed after release [<velocity>]",
    "fastest [<velocity>]",
    "highest [<length>]",
    "at [s]",
    "cells",
    "steps",
    "wall [s]",
    "remark",
];

fn row(run: &StudyRun) -> Vec<String> {
    let time = |time: Option<f64>| time.map_or("-".to_owned(), |time| format!("{time:.4}"));
    let length = |length: Option<f64>| length.map_or("-".to_owned(), short);
    vec![
        short(run.value),
        time(run.first_contact()),
        time(run.summary.release_time),
        run.summary.contact_intervals.len().to_string(),
        length(run.closest),
        length(run.rebound.map(|rebound| rebound.speed)),
        length(run.rebound.map(|rebound| rebound.fastest)),
        length(run.rebound.map(|rebound| rebound.height)),
        time(run.rebound.map(|rebound| rebound.time)),
        run.summary.cells.to_string(),
        run.summary.steps.to_string(),
        format!("{:.0}", run.summary.wall_seconds),
        run.failure.clone().unwrap_or_default(),
    ]
}

/// Returns the outcome of a study as a record.
fn record(name: &str, definition: &Definition, runs: &[Vec<StudyRun>]) -> Record {
    let mut record = Record::new(name, &definition.title, true);
    record.seconds = runs.iter().flatten().map(|run| run.summary.wall_seconds).sum();
    let all = || definition.series.iter().zip(runs);
    let mut limits = Vec::new();
    for (series, runs) in all().filter(|(series, _)| series.limit) {
        add_limits(series, runs, &mut record, &mut limits);
    }
    if !limits.is_empty() {
        let head = ["series", "quantity", "limit", "observed order", "differences shrink"];
        record.tables.push(TextTable { head: head.map(str::to_owned).into(), rows: limits });
    }
    let summaries: Vec<&Summary> = runs.iter().flatten().map(|run| &run.summary).collect();
    results::add_energies(&summaries, &mut record);
    let varied: Vec<&StudyRun> = all().filter(|(series, _)| series.coefficient).flat_map(|(_, runs)| runs).collect();
    for (quantity, of) in QUANTITIES[1..].iter().filter(|_| !varied.is_empty()) {
        let quantity = cgs(quantity);
        let values = || varied.iter().map(|run| of(run).unwrap_or(f64::NAN));
        let (largest, smallest) =
            (values().fold(f64::NEG_INFINITY, worse), -values().map(|v| -v).fold(f64::NEG_INFINITY, worse));
        let spread = (largest - smallest) / smallest.abs();
        record.at_most(
            format!("spread over the coefficients, {quantity}, %"),
            100.0 * spread,
            definition.largest_spread,
        );
    }
    let rows = all().flat_map(|(series, runs)| runs.iter().map(|run| [vec![series.name.clone()], row(run)].concat()));
    let head = ["series"].iter().chain(&HEAD).map(|name| cgs(name)).collect();
    record.tables.push(TextTable { head, rows: rows.collect() });
    record.notes.clone_from(&definition.note);
    // Series that vary the same quantity share their charts. Two values of a coefficient make no curve.
    let pairs: Vec<(&StudySeries, &Vec<StudyRun>)> = all().filter(|(series, _)| !series.coefficient).collect();
    for group in pairs.chunk_by(|a, b| a.0.parameter == b.0.parameter) {
        let mut chart = |title: &str, value: &dyn Fn(&StudyRun) -> Option<f64>| {
            let curve = |(series, runs): &(&StudySeries, &Vec<StudyRun>)| {
                let mut points: Vec<_> = runs.iter().filter_map(|run| Some((run.value, value(run)?))).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                (series.name.clone(), points)
            };
            let curves: Vec<_> = group.iter().map(curve).filter(|(_, points)| !points.is_empty()).collect();
            if !curves.is_empty() {
                record.figure(title, &group[0].0.parameter, curves);
            }
        };
        chart("contact [s]", &StudyRun::first_contact);
        chart(&cgs("fastest after contact [<velocity>]"), &|run| Some(run.rebound?.fastest));
        chart(&cgs("highest point after rebound [<length>]"), &|run| Some(run.rebound?.height));
    }
    record
}

/// Largest uncertainty of a limit, %. Limits are made to be compared with measured rebounds, which scatter by a few
/// percent.
const LARGEST_UNCERTAINTY: f64 = 3.0;

/// A quantity of a run with its name, which has marks of units.
type StudyQuantity = (&'static str, fn(&StudyRun) -> Option<f64>);

/// Quantities whose limits are computed; a required order holds for all but the first.
const QUANTITIES: [StudyQuantity; 4] = [
    ("contact [s]", |run| run.arrival_time),
    ("speed after release [<velocity>]", |run| Some(run.rebound?.speed)),
    ("fastest [<velocity>]", |run| Some(run.rebound?.fastest)),
    ("highest [<length>]", |run| Some(run.rebound?.height)),
];

/// Adds the limits of a series: rows of a table, and verdicts on contact before that in an ideal fluid, on orders and
/// on uncertainties.
fn add_limits(series: &StudySeries, runs: &[StudyRun], record: &mut Record, table: &mut Vec<Vec<String>>) {
    let name = &series.name;
    let contacts = || runs.iter().map(|run| run.summary.contact_time.unwrap_or(f64::NAN));
    let earliest = -contacts().map(|time| -time).fold(f64::NEG_INFINITY, worse);
    if let Some(bound) = runs.first().and_then(|run| run.bound) {
        record.at_least(format!("{name}: earliest contact, and that in an ideal fluid [s]"), earliest, bound);
    }
    for (k, (quantity, of)) in QUANTITIES.iter().enumerate() {
        let quantity = cgs(quantity);
        // A limit needs the quantity in every run.
        let sequence: Option<Vec<(f64, f64)>> = runs.iter().map(|run| Some((run.value, of(run)?))).collect();
        let limit = sequence.and_then(|sequence| richardson(&sequence));
        if let Some(Limit { value, uncertainty, order, shrinks }) = limit {
            table.push(vec![
                name.clone(),
                quantity.clone(),
                format!("{value:.4} ± {uncertainty:.4}"),
                order.map_or("-".to_owned(), |order| format!("{order:.1}")),
                if shrinks { "yes" } else { "no" }.to_owned(),
            ]);
        }
        if let Some(asked) = series.required_order.filter(|_| k > 0) {
            let order = limit.and_then(|limit| limit.order).unwrap_or(f64::NAN);
            let uncertainty = limit.map_or(f64::NAN, |limit| 100.0 * limit.uncertainty / limit.value.abs());
            record.at_least(format!("{name}: order of {quantity}"), order, asked);
            record.at_most(format!("{name}: uncertainty of {quantity}, %"), uncertainty, LARGEST_UNCERTAINTY);
        }
    }
}

/// Returns the time at which the distance first falls to a level. It is extrapolated within its step with the speed of
/// the step before: contact holds the distance at the level, so that interpolation would always give the end of the
/// step.
fn passes(times: &[f64], distances: &[f64], level: f64) -> Option<f64> {
    let k = (2..distances.len()).find(|&k| distances[k - 1] > level && distances[k] <= level)?;
    let speed = (distances[k - 2] - distances[k - 1]) / (times[k - 1] - times[k - 2]);
    let share = if speed > 0.0 { (distances[k - 1] - level) / speed } else { f64::INFINITY };
    Some((times[k - 1] + share).min(times[k]))
}

/// Returns the first local minimum of the distance.
fn first_approach(distances: &[f64]) -> Option<f64> {
    distances.windows(2).find(|pair| pair[1] > pair[0]).map(|pair| pair[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_approach_is_read_off_the_distances() {
        let times = [0.1, 0.2, 0.3, 0.4, 0.5];
        let distances = [1.0, 0.5, 0.2, 0.25, 0.1];
        assert_eq!(first_approach(&distances), Some(0.2));
        assert!((passes(&times, &distances, 0.25).unwrap() - 0.25).abs() < 1e-15);
        // The end of the step at the latest.
        assert_eq!(passes(&times, &distances, 0.1), Some(0.5));
        assert!((passes(&[0.1, 0.2, 0.3], &[1.0, 0.99, 0.5], 0.5).unwrap() - 0.3).abs() < 1e-15);
        assert_eq!(passes(&times, &distances, 0.05), None);
        assert_eq!(first_approach(&distances[..3]), None);
    }

    #[test]
    fn a_record_has_a_row_for_each_run_and_the_limit_of_each_series() {
        let definition: Definition = toml::from_str(
            "title = 'T'\n[[series]]\nname = 'a'\nparameter = 'h [cm]'\nscenario = 'x'\nvary = { k = 1.0 }\n\
             values = [0.4, 0.2, 0.1]\nlimit = true",
        )
        .unwrap();
        let run =
            |value: f64| StudyRun { value, arrival_time: Some(0.1 + value), bound: Some(0.05), ..StudyRun::default() };
        let record = record("t", &definition, &[vec![run(0.4), run(0.2), run(0.1)]]);
        assert_eq!(record.tables[0].rows[0][2], "0.1000 ± 0.1250");
        assert_eq!((record.tables[1].rows.len(), record.tables[1].head.len()), (3, record.tables[1].rows[0].len()));
        assert_eq!(record.figures.len(), 1, "no run has a rebound");
    }

    #[test]
    fn orders_limits_and_spreads_are_judged() {
        let definition: Definition = toml::from_str(
            "title = 'T'\n[[series]]\nname = 'a'\nparameter = 'h [cm]'\nscenario = 'x'\nvary = { k = 1.0 }\n\
             values = [0.4, 0.2, 0.1]\nlimit = true\nrequired_order = 1.5\ncoefficient = true",
        )
        .unwrap();
        let run = |value: f64, height: f64| {
            let (speed, fastest) = (50.0 + value.powi(2), 51.0 + value.powi(2));
            let rebound = Some(Rebound { height, time: 0.2, speed, fastest });
            let summary = Summary { energy_defect: Some(0.5), energy_monotone: true, ..Summary::default() };
            StudyRun { value, rebound, summary, ..StudyRun::default() }
        };
        let verdicts_of = |definition: &Definition, heights: [f64; 3]| {
            let runs = [run(0.4, heights[0]), run(0.2, heights[1]), run(0.1, heights[2])];
            record("t", definition, &[runs.to_vec()]).rows.iter().map(|row| row.verdict.clone()).collect::<Vec<_>>()
        };
        let verdicts = |heights| verdicts_of(&definition, heights);
        // Order and uncertainty of both speeds and the height, then both rows on energies and the spread of all.
        let expected = |of_height: [&'static str; 2], spread: &'static str| {
            [&["pass"; 4][..], &of_height[..], &["pass"; 4][..], &[spread][..]].concat()
        };
        assert_eq!(verdicts([5.16, 5.04, 5.01]), expected(["pass", "pass"], "pass"));
        assert_eq!(verdicts([5.4, 5.2, 5.1]), expected(["FAIL", "pass"], "FAIL"));
        let mut wider = definition.clone();
        wider.largest_spread = 10.0;
        assert_eq!(verdicts_of(&wider, [5.4, 5.2, 5.1]), expected(["FAIL", "pass"], "pass"));
        assert_eq!(verdicts([4.0, 5.2, 4.1]), expected(["FAIL", "FAIL"], "FAIL"));
        assert_eq!(verdicts([-4.0, 5.2, 4.1]), expected(["FAIL", "FAIL"], "FAIL"));
        assert_eq!(verdicts([5.16, 5.04, f64::NAN]), expected(["FAIL", "FAIL"], "FAIL"));
        // Runs without a ledger, as those of earlier versions, and runs that make energy.
        let without = record("t", &definition, &[vec![StudyRun { value: 0.4, ..StudyRun::default() }]]);
        let judged =
            |words: &str| without.rows.iter().find(|row| row.quantity.contains(words)).is_some_and(|row| !row.holds());
        assert!(judged("no line of the ledger") && judged("make energy"));
    }
}
