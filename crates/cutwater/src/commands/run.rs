//! `cutwater run`

use std::cell::RefCell;
use std::fs::File;
use std::io::{IsTerminal, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use cutwater::io::scenario::{Quantity, TimeSchemeChoice};
use cutwater::io::{Begin, Error, Progress, RunOptions, ScenarioFile, Sizes, StepProgress, Summary, default_directory};
#[cfg(feature = "report")]
use cutwater::report::Recorder;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, INTERRUPTED, RunProperties, building, print_or_ignore, warn};
use crate::RunArguments;

/// Time between two lines of progress without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Runs a scenario or resumes a run, shows its progress, writes its page and prints a summary.
pub(crate) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let resumed = arguments.resume.as_deref();
    let scenario = resumed.map(|directory| directory.join("scenario.toml")).or(arguments.file.clone());
    let file = ScenarioFile::read(&scenario.unwrap_or_default(), &arguments.sets)?;
    let given = resumed.map(Path::to_owned).or(arguments.out.clone());
    let directory = given.unwrap_or_else(|| default_directory(file.scenario()));
    let shown = directory.display().to_string();
    let options = RunOptions {
        resumes: resumed.is_some(),
        overwrites: arguments.overwrite,
        discards: false,
        stop: Some(stop_by_signal()),
    };
    let console = RefCell::new(Console::new(arguments, &file));
    let begin = Begin(|sizes: &Sizes| console.borrow_mut().begin(&directory, options.resumes, sizes));
    console.borrow_mut().line(&building(&file));
    let progress = Progress(|at: &StepProgress| console.borrow_mut().show(at));
    #[cfg(feature = "report")]
    let outcome = {
        let mut recorder = (!arguments.no_report).then(|| Recorder::new(&directory));
        let outcome = options.run(&file, &directory, &mut ((begin, progress), &mut recorder));
        // The page of a run that failed or was stopped shows the steps up to then.
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
    let outcome = options.run(&file, &directory, &mut (begin, progress));
    let mut console = console.into_inner();
    console.finish();
    match outcome {
        Ok(summary) => {
            print_summary(&summary, &shown, &mut |line| console.line(line));
            warnings(&summary).iter().for_each(|line| console.warning(line));
            if arguments.timings || arguments.verbose {
                print_timings(&summary, &mut |line| {
                    if arguments.timings { console.result(line) } else { console.line(line) }
                });
            }
            Ok(())
        }
        Err(error) => {
            if let Error::Step(step) = &error {
                console
                    .warning(&format!("the files in {shown} are complete up to step {}", step.step.saturating_sub(1)));
            }
            let scenario = file.scenario();
            let is_static = scenario.fluid.is_none() && *scenario.time.scheme == TimeSchemeChoice::QuasiStatic;
            let touches_without_offset =
                scenario.contact.iter().any(|contact| contact.is_between_bodies() && contact.offset == 0.0);
            let has_contacts = !scenario.contact.is_empty();
            let failure =
                Failure::Run { error, properties: RunProperties { has_contacts, is_static, touches_without_offset } };
            console.log(&failure.explain());
            Err(failure)
        }
    }
}

/// Returns a flag that an interrupt from the terminal sets, or a request to terminate, as that of a batch system. A
/// second one ends the program at once.
fn stop_by_signal() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    let stop = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        warn("stopping after this step; the signal again (Ctrl-C) quits now");
    };
    // Without a handler, a signal ends the program at once.
    let _ = ctrlc::set_handler(stop);
    #[cfg(unix)]
    if let Ok(mut terminations) = signal_hook::iterator::Signals::new([signal_hook::consts::SIGTERM]) {
        std::thread::spawn(move || terminations.forever().for_each(|_| stop()));
    }
    &STOP
}

/// Name of the log in the directory of results.
const LOG: &str = "run.log";

/// Output of a run for people. Progress is shown as a bar on a terminal, otherwise as lines at intervals. The log
/// contains all lines.
struct Console {
    is_quiet: bool,
    is_verbose: bool,
    /// Created when the run has claimed its directory.
    log: Option<File>,
    bar: Option<ProgressBar>,
    created: Instant,
    /// Time at which the first step ended, and the index of this step. The time that is left is estimated from it.
    begin: Option<(Instant, usize)>,
    last_line: Option<Instant>,
    /// Labels of length and time.
    units: [String; 2],
}

impl Console {
    fn new(arguments: &RunArguments, file: &ScenarioFile) -> Self {
        let has_bar = std::io::stderr().is_terminal() && !arguments.quiet && !arguments.verbose;
        let bar = has_bar.then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {eta} left");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(file.n_steps() as u64).with_style(style)
        });
        Self {
            is_quiet: arguments.quiet,
            is_verbose: arguments.verbose,
            log: None,
            bar,
            created: Instant::now(),
            begin: None,
            last_line: None,
            units: [Quantity::LENGTH, Quantity::TIME].map(|quantity| file.scenario().units.label(quantity)),
        }
    }

    /// Writes a line to the log, if there is one. A log that cannot be written does not stop a run.
    fn log(&mut self, text: &str) {
        let seconds = self.created.elapsed().as_secs_f64();
        if let Some(log) = &mut self.log {
            for line in text.lines() {
                _ = writeln!(log, "{seconds:9.2} s  {line}");
            }
        }
    }

    /// Writes a line to the log and, unless the run is quiet, prints it.
    fn line(&mut self, line: &str) {
        self.log(line);
        if !self.is_quiet {
            match &self.bar {
                Some(bar) if !bar.is_finished() => bar.suspend(|| print_or_ignore(line)),
                _ => print_or_ignore(line),
            }
        }
    }

    /// Writes a line that was requested: it is printed even if the run is quiet.
    fn result(&mut self, line: &str) {
        self.log(line);
        print_or_ignore(line);
    }

    /// Writes a warning, which is printed even if the run is quiet.
    fn warning(&mut self, line: &str) {
        self.log(line);
        match &self.bar {
            Some(bar) if !bar.is_finished() => bar.suspend(|| warn(line)),
            _ => warn(line),
        }
    }

    /// Opens the log and prints the summary of the scenario: sizes, conditions and methods.
    fn begin(&mut self, directory: &Path, resumes: bool, sizes: &Sizes) {
        let log = File::options().create(true).write(true).append(resumes).truncate(!resumes).open(directory.join(LOG));
        match log {
            Ok(log) => self.log = Some(log),
            Err(error) => self.warning(&format!("the log {} is not written: {error}", directory.join(LOG).display())),
        }
        let how = if resumes { "is resumed from its last checkpoint" } else { "begins" };
        self.log(&format!("cutwater {}: the run {how}", env!("CARGO_PKG_VERSION")));
        sizes.lines.iter().for_each(|line| self.line(line));
        self.line(&format!("results: {}", directory.display()));
    }

    fn show(&mut self, at: &StepProgress) {
        let (begin, first) = *self.begin.get_or_insert_with(|| (Instant::now(), at.step));
        let [length, time] = &self.units;
        let distance = at.d_min.map_or(String::new(), |d| format!(", d_min {} {length}", shown(d)));
        // With one body both are equal; the gap is then not repeated.
        let gap = at.smallest_gap.filter(|gap| at.d_min != Some(*gap));
        let gap = gap.map_or(String::new(), |gap| format!(", smallest gap {gap:.3e} {length}"));
        let contact = if at.in_contact { ", contact" } else { "" };
        let message = format!(
            "t = {} {time}{distance}{gap}{contact}, {} Newton iterations",
            shown(at.time),
            at.newton_iterations
        );
        if at.is_divided {
            let cause = at.failure.as_deref().unwrap_or("bodies are close to each other (`time.approach`)");
            let line = format!("step {} was divided into substeps: {cause}", at.step);
            if self.is_verbose { self.line(&line) } else { self.log(&line) }
        }
        if let Some(bar) = &self.bar {
            bar.set_message(message.clone());
            bar.set_position(at.step as u64);
        }
        let is_due = self.last_line.is_none_or(|last| last.elapsed() >= LINE_EVERY);
        if is_due || self.is_verbose || at.step == at.n_steps {
            let steps_since = (at.step - first).max(1) as f64;
            let per_step = begin.elapsed().as_secs_f64() / steps_since;
            let left = per_step * (at.n_steps - at.step) as f64;
            let left = if at.step > first { format!(", {left:.0} s left") } else { String::new() };
            let detail = if self.is_verbose {
                format!(", {} linear iterations, residual {:.1e}", at.linear_iterations, at.residual)
            } else {
                String::new()
            };
            let line = format!("step {}/{}, {message}{detail}{left}", at.step, at.n_steps);
            if self.bar.is_some() {
                self.log(&line)
            } else {
                self.line(&line)
            }
            self.last_line = Some(Instant::now());
        }
    }

    fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Formats a number with four digits after the decimal point, six below 0.1, or with an exponent below 1e-3.
fn shown(value: f64) -> String {
    let is_plain = value == 0.0 || value.abs() >= 1e-3;
    let decimals = if (1e-3..0.1).contains(&value.abs()) { 6 } else { 4 };
    if is_plain { format!("{value:.decimals$}") } else { format!("{value:.3e}") }
}

fn print_summary(summary: &Summary, directory: &str, print_line: &mut dyn FnMut(&str)) {
    print_line(&format!(
        "{}: {} steps in {:.1} s, results in {directory}",
        summary.case, summary.steps, summary.wall_seconds
    ));
    let half = if summary.half_domain { " (of a half domain)" } else { "" };
    // Without a fluid there is neither a background nor a stabilisation.
    if summary.stabilisation.is_empty() {
        print_line(&format!("  up to {} unknowns", summary.dofs));
    } else {
        let Summary { cells, dofs, stabilisation, .. } = summary;
        print_line(&format!("  {cells} cells, up to {dofs} unknowns{half}, stabilisation {stabilisation}"));
    }
    print_line(&format!("  linear solver {}", summary.linear_solver));
    if summary.fallbacks > 0 {
        print_line(&format!("  {} factorisations needed free pivoting", summary.fallbacks));
    }
    if summary.divided_steps > 0 {
        print_line(&divided(summary));
    }
    contact_lines(summary).iter().for_each(|line| print_line(line));
}

/// Returns the warnings about the results of a run.
fn warnings(summary: &Summary) -> Vec<String> {
    let mut lines: Vec<String> = overlap(summary).or_else(|| soft_penalty(summary)).into_iter().collect();
    let overlapping = summary.overlapping.iter();
    lines.extend(overlapping.map(|pair| {
        format!("warning: at the end {pair}: bodies touch only by contact; define one, such as `pairs = \"all\"`")
    }));
    let outside = summary.outside.iter();
    lines.extend(outside.map(|reaches| {
        format!(
            "warning: at the end {reaches}: walls hold bodies only by contact; define one with the wall as its obstacle, or make it stiffer"
        )
    }));
    if let Some(generated) = summary.energy_generated.filter(|generated| *generated > MUCH_ENERGY) {
        lines.push(format!(
            "warning: steps generated energy, in all {:.0} % of the largest energy of the run: results depend on the step; halve it, first with \
             `--set time.step={:?}`, until `energy_generated` in summary.json is small",
            100.0 * generated,
            0.5 * summary.dt
        ));
    }
    if let Some(lost) = summary.energy_lost_in_contact.filter(|lost| *lost > MUCH_ENERGY) {
        lines.push(format!(
            "warning: in steps with contact the time scheme took {:.0} % of the largest energy of the run from bodies, so that they rebound too slowly; halve the step, \
             first with `--set time.step={:?}`, until `energy_lost_in_contact` in summary.json is small",
            100.0 * lost,
            0.5 * summary.dt
        ));
    }
    if let Some(lost) = summary.energy_lost_at_surfaces.filter(|lost| *lost > MUCH_AT_SURFACES) {
        lines.push(format!(
            "warning: the penalty that ties the velocity of the fluid to that of surfaces took {:.0} % of the energy of the run, so that forces on bodies that \
             accelerate are wrong: cells near bodies are too large; take smaller ones until `energy_lost_at_surfaces` in summary.json is below \
             {MUCH_AT_SURFACES}",
            100.0 * lost
        ));
    }
    if let Some(change) = summary.closed_volume_change.map(f64::exp_m1).filter(|change| change.abs() > MUCH_CHANGE) {
        lines.push(format!(
            "warning: given velocities of sides or bodies change the volume of a closed region of the fluid, in all by {:.0} % of it: the fluid has nowhere to go, and \
             the pressure there is wrong; give the region a side with the condition `free`, or another motion",
            100.0 * change.abs()
        ));
    }
    lines
}

/// Returns a warning if surfaces overlap by more than a contact size.
fn overlap(summary: &Summary) -> Option<String> {
    let (gap, sides) = summary.smallest_gap.as_ref()?;
    let size = summary.max_penetration / summary.max_penetration_over_s?;
    (*gap < -size).then(|| {
        format!(
            "warning: {sides} overlap by {:.1} contact sizes: the step is too long, or the contact too soft; reduce the step, and raise the parameter of the law if it has one",
            -gap / size
        )
    })
}

/// Returns a warning if a penalty lets surfaces come closer than the offset by more than the contact size.
fn soft_penalty(summary: &Summary) -> Option<String> {
    let (depth, sides) = summary.deepest_penalty.as_ref().filter(|(depth, _)| *depth > 1.0)?;
    Some(format!(
        "warning: {sides} came closer than the offset by {depth:.1} contact sizes: the contact is too soft, the step too long, or they began there; raise \
         `gamma_contact_0`, or reduce the step"
    ))
}

/// Energy that steps generate, or lose in contact, relative to the energies of the run, above which the summary warns.
const MUCH_ENERGY: f64 = 0.05;
/// Energy that the penalty at surfaces takes, relative to the energies of the run and all losses, above which the
/// summary warns. Resolved flows past bodies lose less than half of it.
const MUCH_AT_SURFACES: f64 = 0.03;
/// Change of the volume of closed regions, relative to that at the start, above which the summary warns.
const MUCH_CHANGE: f64 = 0.05;
/// Share of divided steps at and above which the summary advises a shorter step.
const MANY: f64 = 0.05;

/// Returns the line about divided steps, with advice if there are many.
fn divided(Summary { divided_steps, steps, dt, .. }: &Summary) -> String {
    let share = *divided_steps as f64 / *steps as f64;
    let percent = (100.0 * share).round();
    let line = format!("  {divided_steps} of {steps} steps ({percent} %) were divided into substeps");
    if share < MANY {
        return line;
    }
    format!(
        "{line}: unless `time.approach` divides them, the step is too long and results depend on it; halve it, first with \
         `--set time.step={:?}`, until they no longer change",
        0.5 * dt
    )
}

/// Returns the lines about contact.
fn contact_lines(summary: &Summary) -> Vec<String> {
    let Summary { smallest_gap, first_contact, contact_intervals, .. } = summary;
    let (length, time) = (&summary.units.length, &summary.units.time);
    let leading = summary.leading.as_deref().unwrap_or_default();
    let Some((begin, end)) = contact_intervals.first() else {
        return vec![match smallest_gap {
            Some((gap, sides)) => {
                format!(
                    "  no contact of {leading}; the smallest gap of all contacts is {gap:.3e} {length}, between {sides}"
                )
            }
            None => "  no contact".to_owned(),
        }];
    };
    let between = first_contact.as_ref().map_or(String::new(), |sides| format!(" between {sides}"));
    let release = end.map_or("no release".to_owned(), |end| format!("released at {} {time}", shown(end)));
    let n = contact_intervals.len();
    let intervals = if n == 1 { "interval" } else { "intervals" };
    vec![
        format!(
            "  first contact at {} {time}{between}, {release}; {n} {intervals} of contact of {leading}",
            shown(*begin)
        ),
        format!("  largest penetration {:.3e} {length}", summary.max_penetration + 0.0),
    ]
}

/// Prints a line per task of a step. The assembly also has a line per contribution, and one for the rest: zeros, copies
/// and linear parts that are stored.
fn print_timings(summary: &Summary, print_line: &mut dyn FnMut(&str)) {
    let steps = summary.steps.max(1) as f64;
    let all: f64 = summary.timings.iter().filter(|t| t.contribution.is_none()).map(|t| t.seconds).sum();
    print_line(&format!("  {:<32} {:>8} {:>10} {:>12} {:>7}", "task", "calls", "seconds", "ms per step", "share"));
    let mut line = |name: &str, calls: &str, seconds: f64| {
        let (per_step, share) = (1e3 * seconds / steps, 100.0 * seconds / all);
        print_line(&format!("  {name:<32} {calls:>8} {seconds:>10.3} {per_step:>12.3} {share:>6.1}%"));
    };
    for task in summary.timings.iter().filter(|timing| timing.contribution.is_none()) {
        line(&task.task, &task.calls.to_string(), task.seconds);
        let mut rest = task.seconds;
        for timing in summary.timings.iter().filter(|timing| timing.task == task.task) {
            if let Some(name) = &timing.contribution {
                line(&format!("  {name}"), &timing.calls.to_string(), timing.seconds);
                rest -= timing.seconds;
            }
        }
        if rest < task.seconds {
            line("  rest", "", rest);
        }
    }
    print_line(&format!(
        "  {} Newton iterations, {} factorisations",
        summary.newton_iterations, summary.factorizations
    ));
}

#[cfg(test)]
mod tests {
    use super::{Summary, contact_lines, divided, overlap, warnings};

    #[test]
    fn many_divided_steps_have_a_remedy() {
        let summary = Summary { divided_steps: 35, steps: 320, dt: 1e-3, ..Summary::default() };
        assert!(
            divided(&summary).contains("35 of 320 steps (11 %)") && divided(&summary).contains("time.step=0.0005`")
        );
        assert!(!divided(&Summary { divided_steps: 3, ..summary }).contains("time.step"));
    }

    #[test]
    fn a_soft_contact_is_a_warning() {
        let summary = |gap: f64| Summary {
            smallest_gap: Some((gap, "ball and block".to_owned())),
            max_penetration: 0.5,
            max_penetration_over_s: Some(5.0),
            ..Summary::default()
        };
        let found = overlap(&summary(-0.3)).unwrap();
        assert!(found.contains("ball and block overlap by 3.0 contact sizes"), "{found}");
        assert_eq!(
            [overlap(&summary(-0.09)), overlap(&summary(0.3)), overlap(&Summary::default())],
            [None, None, None]
        );
        let within =
            |depth: f64| Summary { deepest_penalty: Some((depth, "ball and block".to_owned())), ..Summary::default() };
        let found = warnings(&within(1.2)).concat();
        assert!(found.contains("ball and block came closer than the offset by 1.2 contact sizes"), "{found}");
        assert!(warnings(&within(0.9)).is_empty());
    }

    #[test]
    fn each_bad_result_has_a_warning() {
        let summary = Summary {
            energy_generated: Some(0.5),
            energy_lost_in_contact: Some(0.5),
            energy_lost_at_surfaces: Some(0.5),
            closed_volume_change: Some(0.5),
            ..Summary::default()
        };
        let lines = warnings(&summary);
        assert!(lines.len() == 4 && lines.iter().all(|line| line.starts_with("warning: ")), "{lines:#?}");
        assert!(warnings(&Summary::default()).is_empty());
    }

    #[test]
    fn contacts_are_counted_and_named() {
        let sides = "ball and block".to_owned();
        let mut summary = Summary { leading: Some("ball".to_owned()), ..Summary::default() };
        assert_eq!(contact_lines(&summary), ["  no contact"]);
        summary.smallest_gap = Some((0.25, sides.clone()));
        assert!(
            contact_lines(&summary)[0].contains("no contact of ball; the smallest gap of all contacts is 2.500e-1")
        );
        assert!(contact_lines(&summary)[0].ends_with("between ball and block"));
        summary.first_contact = Some(sides);
        summary.contact_intervals = vec![(1.0, Some(2.0)), (3.0, None)];
        let lines = contact_lines(&summary).concat();
        assert!(lines.contains("first contact at 1.0000  between ball and block, released at 2.0000"), "{lines}");
        assert!(lines.contains("2 intervals of contact of ball"), "{lines}");
    }
}
