//! Runs of the cases, each compared with its reference.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use cutwater::io::{self, Progress, ScenarioFile, StepProgress, Summary};
use cutwater::report::{Recorder, Results};
use serde_json::{Value, json};

use crate::case::{self, QuickValues, Reference};
use crate::compare::{self, Compared, as_number, with_paper, with_stored};
use crate::figures::Figures;
use crate::metrics::{Factorization, REFACTORIZATIONS_PER_STEP, Thickness, metrics};
use crate::outcome::{Failure, Outcome, causes};
use crate::verify::document;
use crate::{results, table, workers};

/// Time between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(10);

/// Runs cases (all if none is named) and prints a table for each. Returns whether every verdict is good. Cases are run
/// with the resolution of the paper and compared with it, and their pages of the book may be written; or with coarse
/// meshes and compared with our own stored values, which may be updated.
///
/// # Errors
/// There is no such case, or a file cannot be read or written.
pub(crate) fn run(cases: &[String], [is_quick, regenerate, writes_pages]: [bool; 3], out: &Path) -> Outcome {
    if writes_pages {
        document::require_clean_tree()?;
    }
    let names = if cases.is_empty() { case::names()? } else { cases.to_vec() };
    let references = names.iter().map(|name| Ok((name, case::read(name)?))).collect::<Result<Vec<_>, String>>()?;
    let mut stored = case::read_quick_values()?;
    let mut failed = Vec::new();
    let start = |(name, reference): &(&String, Reference)| Ok(run_case(name, reference, is_quick, &out.join(name)));
    workers::for_each(&references, start, |(name, reference), run| {
        println!("# {name}: {} ({})", reference.title, reference.source);
        let directory = out.join(name);
        let passes = run.and_then(|run| judge(name, reference, &run, [is_quick, regenerate], &directory, &mut stored));
        if !passes.unwrap_or_else(|error| print_error(error.as_ref())) {
            failed.push(*name);
        }
        println!("  files are in {}\n", directory.display());
        Ok(())
    })?;
    if !is_quick {
        // Verdicts of a whole run are those of the pages, which include listed targets and the other cases.
        failed.clear();
        for (name, reference) in &references {
            let holds = results::record(name, reference, out).and_then(|record| {
                if writes_pages {
                    results::write(&record)?;
                }
                Ok(record.holds())
            });
            if !holds.unwrap_or_else(|error| print_error(error.as_ref())) {
                failed.push(*name);
            }
        }
        document::older_than_the_code().iter().for_each(|line| println!("# {line}"));
    }
    if regenerate {
        write_stored(&stored)?;
    } else if is_quick {
        println!("Coarse meshes, compared with our own stored values: this is regression, not validation.");
    } else {
        println!("Compared with the numbers of the paper.");
    }
    match failed.as_slice() {
        [] => println!("{} of {} cases are as they should be.", names.len(), names.len()),
        failed => println!("{} of {} cases failed: {failed:?}", failed.len(), names.len()),
    }
    Ok(failed.is_empty())
}

/// A case that was run: its results, and the error of the step at which it stopped.
struct Run {
    results: Results,
    metrics: Value,
    failure: Option<io::Error>,
}

/// Runs a case and writes its files.
///
/// # Errors
/// The run does not start, or a file cannot be read or written.
fn run_case(name: &str, reference: &Reference, is_quick: bool, directory: &Path) -> Result<Run, Failure> {
    // A run that does not start must not leave the comparison of an earlier one.
    compare::remove(directory)?;
    let mut set = vec![format!("name={name}")];
    set.extend_from_slice(&reference.set);
    if is_quick {
        set.extend_from_slice(&reference.quick.set);
    }
    let file = ScenarioFile::read(&case::scenario_path(&reference.scenario), &set)?;
    let mut last = Instant::now();
    let progress = Progress(|at: &StepProgress| {
        if last.elapsed() > PROGRESS {
            last = Instant::now();
            let distance = at.d_min.map_or(String::new(), |d| format!(", d_min {d:.3}"));
            println!(
                "  {name}: step {} of {}, time {:.4}{distance}, {} Newton iterations",
                at.step, at.n_steps, at.time, at.newton_iterations
            );
        }
    });
    let (mut factorization, mut recorder) = (Factorization::default(), Recorder::default());
    // Pictures and costs are recorded at the resolution of the paper only.
    let in_full = (!is_quick).then_some(((&mut factorization, &mut recorder), Figures { directory }));
    let failure = match io::run(&file, directory, &mut ((progress, Thickness { directory }), in_full)) {
        Ok(_) => None,
        // The files of such a run have the steps before the failure.
        Err(error @ io::Error::Step(_)) => Some(error),
        Err(error) => return Err(error.into()),
    };
    if !is_quick {
        recorder.write(directory)?;
    }
    let results = Results::read(directory)?;
    let mut metrics = metrics(&results, failure.is_none())?;
    if failure.is_none() && !is_quick {
        metrics[REFACTORIZATIONS_PER_STEP] = json!(factorization.per_step(&results));
    }
    Ok(Run { results, metrics, failure })
}

/// Compares a run with its reference, or a quick one with stored values, which are updated before if asked; prints the
/// comparison and writes it. Returns whether every verdict is good.
fn judge(
    name: &str,
    reference: &Reference,
    Run { results, metrics, failure }: &Run,
    [is_quick, regenerate]: [bool; 2],
    directory: &Path,
    stored: &mut QuickValues,
) -> Outcome {
    if let Some(error) = failure {
        print_error(error);
    }
    print_sizes(&results.summary);
    let asked = reference.comparisons.iter().filter(|asked| !is_quick || asked.key != REFACTORIZATIONS_PER_STEP);
    if regenerate {
        let values = asked.clone().filter_map(|asked| Some((asked.key.clone(), as_number(&metrics[&asked.key])?)));
        stored.insert(name.to_owned(), values.collect::<BTreeMap<_, _>>());
    }
    let rows: Vec<Compared> = asked
        .map(|asked| match is_quick {
            false => with_paper(asked, metrics.get(&asked.key)),
            true => {
                let stored = stored.get(name).and_then(|values| values.get(&asked.key));
                with_stored(asked, metrics.get(&asked.key), stored.copied())
            }
        })
        .collect();
    table::print_comparisons(&rows, if is_quick { "stored" } else { "paper" });
    compare::write(directory, &rows)?;
    Ok(rows.iter().all(Compared::passes))
}

/// Prints an error with its causes. Returns the verdict of what it prevented.
fn print_error(error: &dyn std::error::Error) -> bool {
    println!("  the run failed: {error}");
    causes(error).for_each(|cause| println!("    because: {cause}"));
    false
}

fn print_sizes(summary: &Summary) {
    let Summary { steps, cells, dofs, newton_iterations, factorizations, wall_seconds, .. } = summary;
    println!("  {steps} steps; {cells} background cells, at most {dofs} unknowns");
    println!("  {newton_iterations} Newton iterations, {factorizations} factorisations, {wall_seconds:.1} s in all");
    let stages = summary.timings.iter().filter(|timing| timing.contribution.is_none());
    let stages: Vec<String> = stages.map(|timing| format!("{} {:.1}", timing.stage, timing.seconds)).collect();
    println!("  seconds: {}", stages.join(", "));
}

fn write_stored(stored: &QuickValues) -> Result<(), Failure> {
    let path = case::quick_values_path();
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let head = "# Values of our own on coarse meshes, written by `validate --quick --regenerate`: a memory, no validation.\n\n";
    fs::write(&path, format!("{head}{}", toml::to_string(stored)?))?;
    println!("Stored in {}", path.display());
    Ok(())
}
