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

/// Resolution of the runs, and what is written in addition to their results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fineness {
    /// Coarse meshes. Runs are compared with values that an earlier version of this code stored. `regenerates`: these
    /// values are replaced first.
    Quick { regenerates: bool },
    /// The resolution of the paper. Runs are compared with the paper, and their pages of the book may be written.
    Paper { writes_pages: bool },
}

impl Fineness {
    fn is_quick(self) -> bool {
        matches!(self, Self::Quick { .. })
    }
}

/// Runs cases (all if none is named) and prints a table for each. Returns whether every verdict is good.
///
/// # Errors
/// There is no such case, or a file cannot be read or written.
pub(crate) fn run(cases: &[String], fineness: Fineness, out: &Path) -> Outcome {
    let writes_pages = fineness == Fineness::Paper { writes_pages: true };
    let regenerates = fineness == Fineness::Quick { regenerates: true };
    if writes_pages {
        document::require_clean_tree()?;
    }
    let names = if cases.is_empty() { case::names()? } else { cases.to_vec() };
    let references = names.iter().map(|name| Ok((name, case::read(name)?))).collect::<Result<Vec<_>, String>>()?;
    let mut stored = case::read_quick_values()?;
    let mut failed = Vec::new();
    let start =
        |(name, reference): &(&String, Reference)| Ok(run_case(name, reference, fineness.is_quick(), &out.join(name)));
    let name_of = |(name, _): &(&String, Reference)| (*name).clone();
    workers::for_each(&references, name_of, start, |(name, reference), run| {
        println!("# {name}: {} ({})", reference.title, reference.source);
        let directory = out.join(name);
        let passes = run.and_then(|run| judge(name, reference, &run, fineness, &directory, &mut stored));
        if !passes_or_print(passes) {
            failed.push(*name);
        }
        println!("  files are in {}\n", directory.display());
        Ok(())
    })?;
    if !fineness.is_quick() {
        // At the resolution of the paper the verdict of a case is that of its page, on which targets listed in
        // `missed.toml` may fail and cases are compared with each other.
        failed.clear();
        for (name, reference) in &references {
            let holds = results::record(name, reference, out).and_then(|record| {
                if writes_pages {
                    results::write(&record)?;
                }
                Ok(record.holds())
            });
            if !passes_or_print(holds) {
                failed.push(*name);
            }
        }
        document::older_than_the_code().iter().for_each(|line| println!("# {line}"));
    }
    if regenerates {
        write_stored(&stored)?;
    } else if fineness.is_quick() {
        println!("Coarse meshes, compared with our own stored values: this is regression, not validation.");
    } else {
        println!("Compared with the numbers of the paper.");
    }
    match failed.as_slice() {
        [] => println!("{} of {} cases pass.", names.len(), names.len()),
        failed => println!("{} of {} cases failed: {failed:?}", failed.len(), names.len()),
    }
    Ok(failed.is_empty())
}

/// Results of a case, of all steps or of those before the one that failed.
struct CaseRun {
    results: Results,
    metrics: Value,
}

/// Runs a case and writes its files.
///
/// # Errors
/// The run does not start, or a file cannot be read or written.
fn run_case(name: &str, reference: &Reference, is_quick: bool, directory: &Path) -> Result<CaseRun, Failure> {
    // The comparison of an earlier run is removed, in case this run does not start.
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
        Err(error @ io::Error::Step(_)) => {
            print_error(&format!("{name}: the run stopped"), &error);
            Some(error)
        }
        Err(error) => return Err(error.into()),
    };
    if !is_quick {
        recorder.write(directory)?;
    }
    let results = Results::read(directory)?;
    let mut metrics = metrics(&results, failure.is_none())?;
    if failure.is_none() && !is_quick {
        metrics[REFACTORIZATIONS_PER_STEP] = json!(factorization.per_step(name, &results));
    }
    Ok(CaseRun { results, metrics })
}

/// Compares a run with its reference, or a quick one with stored values, which are updated first if requested; prints
/// comparison and writes it. Returns whether every verdict is good.
fn judge(
    name: &str,
    reference: &Reference,
    CaseRun { results, metrics }: &CaseRun,
    fineness: Fineness,
    directory: &Path,
    stored: &mut QuickValues,
) -> Outcome {
    let is_quick = fineness.is_quick();
    print_sizes(&results.summary);
    let comparisons = reference.comparisons.iter().filter(|of| !is_quick || of.key != REFACTORIZATIONS_PER_STEP);
    if fineness == (Fineness::Quick { regenerates: true }) {
        let values = comparisons.clone().filter_map(|of| Some((of.key.clone(), as_number(&metrics[&of.key])?)));
        stored.insert(name.to_owned(), values.collect::<BTreeMap<_, _>>());
    }
    let rows: Vec<Compared> = comparisons
        .map(|of| match is_quick {
            false => with_paper(of, metrics.get(&of.key)),
            true => {
                let stored = stored.get(name).and_then(|values| values.get(&of.key));
                with_stored(of, metrics.get(&of.key), stored.copied())
            }
        })
        .collect();
    table::print_comparisons(&rows, if is_quick { "stored" } else { "paper" });
    compare::write(directory, &rows)?;
    Ok(rows.iter().all(Compared::passes))
}

/// Returns whether all verdicts are good. Prints an error, which counts as a bad verdict.
fn passes_or_print(outcome: Outcome) -> bool {
    outcome.unwrap_or_else(|error| {
        print_error("the comparison failed", error.as_ref());
        false
    })
}

/// Prints what failed, and the error with its causes.
fn print_error(what: &str, error: &dyn std::error::Error) {
    let causes: String = causes(error).map(|cause| format!("\n    because: {cause}")).collect();
    println!("  {what}: {error}{causes}");
}

fn print_sizes(summary: &Summary) {
    let Summary { steps, cells, dofs, newton_iterations, factorizations, wall_seconds, .. } = summary;
    println!("  {steps} steps; {cells} background cells, at most {dofs} unknowns");
    println!("  {newton_iterations} Newton iterations, {factorizations} factorisations, {wall_seconds:.1} s in all");
    let tasks = summary.timings.iter().filter(|timing| timing.contribution.is_none());
    let tasks: Vec<String> = tasks.map(|timing| format!("{} {:.1}", timing.task, timing.seconds)).collect();
    println!("  seconds: {}", tasks.join(", "));
}

fn write_stored(stored: &QuickValues) -> Result<(), Failure> {
    let path = case::quick_values_path();
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let head = "# Values of this code on coarse meshes, written by `validate --quick --regenerate`: for regression tests, not for validation.\n\n";
    fs::write(&path, format!("{head}{}", toml::to_string(stored)?))?;
    println!("Stored in {}", path.display());
    Ok(())
}
