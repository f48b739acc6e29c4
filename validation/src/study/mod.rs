//! Studies: a case again and again with one number changed. Definitions are in `studies/`, outcomes in `results/`.

mod definition;
mod limit;

use std::path::Path;
use std::time::Instant;

use cutwater::io::report::{CaseResult, Limit, Study, StudyRun, StudySeries, machine};
use cutwater::io::{self, HistoryTable, RunOptions, ScenarioFile, Summary};

pub(crate) use self::definition::names;
use self::definition::{Definition, Series};
use crate::Outcome;
use crate::bounds::potential::{arrival, gaps};
use crate::case;
use crate::report::commit;

type Failure = Box<dyn std::error::Error>;

/// Runs studies; true if every run came to its end. Runs that an earlier call has done, with the same changes of the
/// scenario, are kept unless all are wanted again. The outcome is written after every run.
///
/// # Errors
/// There is no such study, or a file cannot be read or written.
pub(crate) fn run(names: &[String], again: bool, out: &Path) -> Outcome {
    let studies = names.iter().map(|name| Ok((name, definition::read(name)?))).collect::<Result<Vec<_>, String>>()?;
    let mut all_finished = true;
    for (name, definition) in studies {
        println!("# {name}: {}", definition.title);
        all_finished &= run_study(name, &definition, again, out)?;
    }
    Ok(all_finished)
}

fn run_study(name: &str, definition: &Definition, again: bool, out: &Path) -> Outcome {
    let path = definition::results().join(name).with_extension("json");
    let known = if again { Vec::new() } else { Study::read(&path)?.map_or(Vec::new(), |study| study.runs) };
    let mut study = Study {
        name: name.to_owned(),
        title: definition.title.clone(),
        note: definition.note.clone(),
        ..Study::default()
    };
    for series in &definition.series {
        let mut header =
            StudySeries { name: series.name.clone(), parameter: series.parameter.clone(), ..<_>::default() };
        if series.limit {
            header.bound = bound(series)?;
        }
        study.series.push(header);
        for &value in &series.values {
            let set = series.changes(value);
            let is_it = |run: &&StudyRun| run.series == series.name && run.value == value && run.set == set;
            let run = match known.iter().find(is_it) {
                Some(run) => run.clone(),
                None => {
                    let run = run_one(name, series, value, set, out)?;
                    study.runs.push(run.clone());
                    write(&mut study, definition, &known, &path)?;
                    study.runs.pop();
                    run
                }
            };
            print(&run);
            study.runs.push(run);
        }
    }
    write(&mut study, definition, &[], &path)?;
    for (name, limit) in study.series.iter().filter_map(|series| Some((&series.name, series.limit?))) {
        let order = limit.order.map_or("no order".to_owned(), |order| format!("order {order:.2}"));
        println!(
            "  {name}: limit {:.4} +- {:.4} s, {order}, differences shrink: {}",
            limit.value, limit.uncertainty, limit.shrinks
        );
    }
    Ok(study.runs.iter().all(|run| run.failure.is_none()))
}

/// Writes the outcome so far; runs of an earlier call that are still to be looked at stay in the file.
fn write(study: &mut Study, definition: &Definition, known: &[StudyRun], path: &Path) -> Result<(), Failure> {
    for (header, series) in study.series.iter_mut().zip(&definition.series) {
        header.limit = if series.limit { limit_of(&study.runs, &series.name) } else { None };
    }
    let n = study.runs.len();
    let is_new = |run: &&StudyRun| !study.runs.iter().any(|r| r.series == run.series && r.value == run.value);
    let kept: Vec<StudyRun> = known.iter().filter(is_new).cloned().collect();
    study.runs.extend(kept);
    study.write(path)?;
    study.runs.truncate(n);
    Ok(())
}

/// The limit of the contact times of a series.
fn limit_of(runs: &[StudyRun], series: &str) -> Option<Limit> {
    let members = runs.iter().filter(|run| run.series == series);
    let times: Vec<(f64, f64)> = members.filter_map(|run| Some((run.value, run.arrival_time?))).collect();
    limit::richardson(&times)
}

/// When an ideal fluid lets the ball of a series come as close as its contact offset.
fn bound(series: &Series) -> Result<Option<f64>, Failure> {
    let Some(&value) = series.values.first() else { return Ok(None) };
    let file = ScenarioFile::read(&case::scenario_path(&series.scenario), &series.changes(value))?;
    Ok(gaps(file.scenario()).map(|(start, offset)| arrival(start, offset).time))
}

fn run_one(study: &str, series: &Series, value: f64, set: Vec<String>, out: &Path) -> Result<StudyRun, Failure> {
    let started = Instant::now();
    let stem = format!("{}-{value}", series.name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
    let directory = out.join("studies").join(study).join(stem);
    let mut all = vec![format!("name={study}"), "output.vtk_every=0".to_owned(), "output.plots=false".to_owned()];
    all.extend_from_slice(&set);
    let file = ScenarioFile::read(&case::scenario_path(&series.scenario), &all)?;
    let failure = match io::run(&file, RunOptions::into_directory(&directory)) {
        Ok(_) => None,
        Err(error @ io::Error::Step(_)) => Some(chain(&error)),
        Err(error) => return Err(error.into()),
    };
    let case = CaseResult::read(&directory, study, &series.name)?;
    let Summary { contact_time, release_time, max_height, max_height_time, cells, steps, .. } = case.summary;
    let offset = case.scenario().contacts.first().map(|contact| contact.offset);
    let (times, distances) = distances(case.history(), &case.prefix());
    let closest = first_approach(&times, &distances);
    Ok(StudyRun {
        series: series.name.clone(),
        value,
        set,
        failure,
        contact_time,
        arrival_time: offset.and_then(|offset| passes(&times, &distances, offset)),
        release_time,
        contact_intervals: case.summary.contact_intervals.clone(),
        closest: closest.map(|(_, distance)| distance),
        closest_time: closest.map(|(time, _)| time),
        max_height,
        max_height_time,
        cells,
        steps,
        wall_seconds: Some(started.elapsed().as_secs_f64()),
        commit: commit().unwrap_or_default(),
        machine: machine(),
    })
}

/// An error with its causes in one line.
fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        text += &format!(": {inner}");
        cause = inner.source();
    }
    text
}

/// Times and smallest distances of a run.
fn distances(history: &HistoryTable, prefix: &str) -> (Vec<f64>, Vec<f64>) {
    let column = |name: &str| history.column(name).unwrap_or_default();
    (column("time"), column(&format!("{prefix}d_min")))
}

/// When the distance first falls to a level: in the step in which it does, with the speed of the step before. Contact holds
/// the distance at the level, so that interpolation would always find the end of the step.
fn passes(times: &[f64], distances: &[f64], level: f64) -> Option<f64> {
    let k = (2..distances.len()).find(|&k| distances[k - 1] > level && distances[k] <= level)?;
    let speed = (distances[k - 2] - distances[k - 1]) / (times[k - 1] - times[k - 2]);
    let share = if speed > 0.0 { (distances[k - 1] - level) / speed } else { f64::INFINITY };
    Some((times[k - 1] + share).min(times[k]))
}

/// The first time at which the distance stops falling, and the distance there.
fn first_approach(times: &[f64], distances: &[f64]) -> Option<(f64, f64)> {
    let k = distances.windows(2).position(|pair| pair[1] > pair[0])?;
    Some((times[k], distances[k]))
}

fn print(run: &StudyRun) {
    let StudyRun { series, value, cells, steps, .. } = run;
    let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
    println!(
        "  {series}, {value}: contact {}, release {}, closest {}, highest {} at {}; {cells} cells, {steps} steps, {} s{}",
        number(run.arrival_time.or(run.contact_time)),
        number(run.release_time),
        number(run.closest),
        number(run.max_height),
        number(run.max_height_time),
        run.wall_seconds.map_or("-".to_owned(), |s| format!("{s:.0}")),
        run.failure.as_ref().map_or(String::new(), |failure| format!("; {failure}")),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_approach_is_read_off_the_distances() {
        let times = [0.1, 0.2, 0.3, 0.4, 0.5];
        let distances = [1.0, 0.5, 0.2, 0.25, 0.1];
        assert_eq!(first_approach(&times, &distances), Some((0.3, 0.2)));
        assert!((passes(&times, &distances, 0.25).unwrap() - 0.25).abs() < 1e-15);
        // The end of the step at the latest.
        assert_eq!(passes(&times, &distances, 0.1), Some(0.5));
        assert!((passes(&[0.1, 0.2, 0.3], &[1.0, 0.99, 0.5], 0.5).unwrap() - 0.3).abs() < 1e-15);
        assert_eq!(passes(&times, &distances, 0.05), None);
        assert_eq!(first_approach(&times[..3], &distances[..3]), None);
    }
}
