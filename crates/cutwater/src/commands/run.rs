//! `cutwater run`

use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use cutwater::io::scenario::{Quantity, Units};
use cutwater::io::{Error, Progress, RunOptions, ScenarioFile, StepProgress, Summary, default_directory};
#[cfg(feature = "report")]
use cutwater::report::Recorder;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, INTERRUPTED, tell, warn};
use crate::RunArguments;

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Runs a scenario or goes on with a run, shows its progress, writes its page and prints a summary.
pub(crate) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let resumed = arguments.resume.as_deref();
    let scenario = resumed.map(|directory| directory.join("scenario.toml")).or(arguments.file.clone());
    let file = ScenarioFile::read(&scenario.unwrap_or_default(), &arguments.sets)?;
    let given = resumed.map(Path::to_owned).or(arguments.out.clone());
    let directory = given.unwrap_or_else(|| default_directory(file.scenario()));
    let shown = directory.display().to_string();
    let options =
        RunOptions { resumes: resumed.is_some(), overwrites: arguments.overwrite, stop: Some(stop_by_signal()) };
    let mut display = Display::new(file.n_steps(), &file.scenario().units);
    let progress = (!arguments.quiet).then_some(Progress(|at: &StepProgress| display.show(at)));
    #[cfg(feature = "report")]
    let outcome = {
        let mut recorder = (!arguments.no_report).then(|| Recorder::new(&directory));
        let outcome = options.run(&file, &directory, &mut (progress, &mut recorder));
        // A run that failed or was stopped gets a page of the steps before.
        if let Ok(_) | Err(Error::Step(_) | Error::Interrupted { .. }) = &outcome {
            cutwater::report::remove(&directory)?;
            if let Some(recorder) = recorder {
                recorder.write(&directory)?;
                cutwater::report::write(&directory)?;
            }
        }
        outcome
    };
    #[cfg(not(feature = "report"))]
    let outcome = options.run(&file, &directory, &mut { progress });
    display.finish();
    let summary = outcome.inspect_err(|error| {
        if let Error::Step(step) = error {
            warn(&format!("the files in {shown} are complete up to step {}", step.step.saturating_sub(1)));
        }
    })?;
    if !arguments.quiet {
        print_summary(&summary, &shown);
    }
    if arguments.timings {
        print_timings(&summary);
    }
    Ok(())
}

/// Returns a flag that an interrupt from the terminal sets. A second interrupt ends the program at once.
fn stop_by_signal() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    let stop = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        warn("stopping after this step; once more to stop at once");
    };
    // Where there are no signals a run cannot be stopped by one.
    let _ = ctrlc::set_handler(stop);
    &STOP
}

/// Progress of a run: a bar on a terminal, elsewhere a line at intervals.
struct Display {
    bar: Option<ProgressBar>,
    /// Time at which the first step ended, and its number; meshes are built before.
    begin: Option<(Instant, usize)>,
    last_line: Option<Instant>,
    /// Labels of length and time.
    units: [String; 2],
}

impl Display {
    fn new(n_steps: usize, units: &Units) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {eta} left");
            ProgressBar::new(n_steps as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let units = [Quantity::LENGTH, Quantity::TIME].map(|quantity| units.label(quantity));
        Self { bar, begin: None, last_line: None, units }
    }

    fn show(&mut self, at: &StepProgress) {
        let (begin, first) = *self.begin.get_or_insert_with(|| (Instant::now(), at.step));
        let [length, time] = &self.units;
        let distance = at.d_min.map_or(String::new(), |d| format!(", d_min {d:.4} {length}"));
        let contact = if at.in_contact { ", contact" } else { "" };
        let message =
            format!("t = {:.4} {time}{distance}{contact}, {} Newton iterations", at.time, at.newton_iterations);
        if let Some(bar) = &self.bar {
            bar.set_message(message);
            bar.set_position(at.step as u64);
            return;
        }
        let is_due = self.last_line.is_none_or(|last| last.elapsed() >= LINE_EVERY);
        if is_due || at.step == at.n_steps {
            let steps_since = (at.step - first).max(1) as f64;
            let per_step = begin.elapsed().as_secs_f64() / steps_since;
            let left = per_step * (at.n_steps - at.step) as f64;
            let left = if at.step > first { format!(", {left:.0} s left") } else { String::new() };
            tell(&format!("step {}/{}, {message}{left}", at.step, at.n_steps));
            self.last_line = Some(Instant::now());
        }
    }

    fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

fn print_summary(summary: &Summary, directory: &str) {
    tell(&format!(
        "{}: {} steps in {:.1} s, results in {directory}",
        summary.case, summary.steps, summary.wall_seconds
    ));
    let half = if summary.half_domain { " (of a half domain)" } else { "" };
    // Without a fluid there is neither a background nor a stabilisation.
    if summary.stabilisation.is_empty() {
        tell(&format!("  up to {} unknowns", summary.dofs));
    } else {
        let Summary { cells, dofs, stabilisation, .. } = summary;
        tell(&format!("  {cells} cells, up to {dofs} unknowns{half}, stabilisation {stabilisation}"));
    }
    tell(&format!("  linear solver {}", summary.linear_solver));
    if summary.fallbacks > 0 {
        tell(&format!("  {} factorisations needed free pivoting", summary.fallbacks));
    }
    if summary.divided_steps > 0 {
        tell(&format!("  {} steps failed and were taken in parts", summary.divided_steps));
    }
    let Some(contact) = summary.contact_time else {
        tell("  no contact");
        return;
    };
    let time = &summary.units.time;
    let release = summary.release_time.map_or("none".to_owned(), |t| format!("{t:.4} {time}"));
    tell(&format!("  first contact {contact:.4} {time}, release {release}"));
    tell(&format!("  largest penetration {:.3e} {}", summary.max_penetration, summary.units.length));
}

/// Prints a line per stage; under the assembly a line per contribution, and the rest: zeros, copies, known linear
/// parts.
fn print_timings(summary: &Summary) {
    let steps = summary.steps.max(1) as f64;
    let all: f64 = summary.timings.iter().filter(|t| t.contribution.is_none()).map(|t| t.seconds).sum();
    tell(&format!("  {:<32} {:>8} {:>10} {:>12} {:>7}", "stage", "calls", "seconds", "ms per step", "share"));
    let line = |name: &str, calls: &str, seconds: f64| {
        let (per_step, share) = (1e3 * seconds / steps, 100.0 * seconds / all);
        tell(&format!("  {name:<32} {calls:>8} {seconds:>10.3} {per_step:>12.3} {share:>6.1}%"));
    };
    for stage in summary.timings.iter().filter(|timing| timing.contribution.is_none()) {
        line(&stage.stage, &stage.calls.to_string(), stage.seconds);
        let mut rest = stage.seconds;
        for part in summary.timings.iter().filter(|timing| timing.stage == stage.stage) {
            if let Some(name) = &part.contribution {
                line(&format!("  {name}"), &part.calls.to_string(), part.seconds);
                rest -= part.seconds;
            }
        }
        if rest < stage.seconds {
            line("  rest", "", rest);
        }
    }
    tell(&format!("  {} Newton iterations, {} factorisations", summary.newton_iterations, summary.factorizations));
}
