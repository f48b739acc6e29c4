//! Runs a scenario and writes a directory of results.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use solver::algebra::LinearError;
use solver::{Observer, ObserverError, State, StepError, StepView, TimeLoop};

use crate::Error;
use crate::checkpoint::{
    Checkpoint, Header, checkpoint_steps, first_difference, keep_last, probes_text, problem_text, remove_all,
};
use crate::claim::{Claim, keep_input};
use crate::files::{create_directory, write_whole};
use crate::history::{History, TABLES, csv};
use crate::measures::{BodyMeasures, leading_body};
use crate::probes::ProbeLine;
use crate::scenario::{Case, CaseVisitor, Fluid, Output, Scenario, ScenarioFile, lower, overlapping};
use crate::sizes::Sizes;
use crate::summary::{Summary, SummaryBuilder, UnitLabels, peak_rss_bytes};
use crate::vtk::Grid;
use crate::vtk::bodies::{Shown, bodies_grid};
use crate::vtk::fluid::fluid_grid;
use crate::vtk::interface::interface_grid;
use crate::vtk::series::Series;
use crate::vtk::surface::surface_grid;
use crate::warnings::outside_walls;
use crate::watch::Watch;

/// Series of field files, by the names of their indices.
const SERIES: [&str; 5] = ["fluid", "solid", "rigid", "interface", "surface"];

/// Folder of values along lines.
const LINES: &str = "lines";

/// Returns the directory of results if the command line names none.
pub fn default_directory(scenario: &Scenario) -> PathBuf {
    let own = || Path::new("results").join(scenario.name.as_str());
    scenario.output.directory.as_ref().map_or_else(own, |directory| PathBuf::from(directory.as_str()))
}

/// Runs a scenario and writes `history.csv`, `diagnostics.csv`, `probes.csv`, `lines/`, `summary.json`,
/// `scenario.toml`, field files and checkpoints. They replace the results in the directory. `watch` attaches an
/// observer, `&mut ()` none.
///
/// # Errors
/// As [`RunOptions::run`].
pub fn run(file: &ScenarioFile, directory: &Path, watch: &mut impl Watch) -> Result<Summary, Error> {
    RunOptions { overwrites: true, ..RunOptions::default() }.run(file, directory, watch)
}

/// Options of a run: resume, overwrite, stop.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions<'a> {
    /// Whether the run is resumed from the last checkpoint in the directory. End time and output may differ from those
    /// of the run that wrote it, but not the probes.
    pub resumes: bool,
    /// Whether a run may write into a directory that has other files, or results of another scenario, which it
    /// replaces.
    pub overwrites: bool,
    /// Whether a new run may remove the checkpoints of a stopped run in the directory.
    pub discards: bool,
    /// Flag that another thread sets to end the run after the current step, with a checkpoint.
    pub stop: Option<&'a AtomicBool>,
}

impl RunOptions<'_> {
    /// Runs a scenario, as [`run`] does.
    ///
    /// # Errors
    /// [`Error::Step`]: a step failed; the files are complete up to the step before. [`Error::Interrupted`]: `stop` is
    /// set. [`Error::Unfinished`]: a new run would remove a stopped run. [`Error::NoCheckpoint`],
    /// [`Error::Checkpoint`]: there is no checkpoint, or it belongs to another scenario. [`Error::Directory`],
    /// [`Error::Input`], [`Error::Busy`]: the directory is not free.
    pub fn run(&self, file: &ScenarioFile, directory: &Path, watch: &mut impl Watch) -> Result<Summary, Error> {
        lower(file, Run { file, directory, watch, options: *self })?
    }
}

struct Run<'a, W> {
    file: &'a ScenarioFile,
    directory: &'a Path,
    watch: &'a mut W,
    options: RunOptions<'a>,
}

impl<W: Watch> CaseVisitor for Run<'_, W> {
    type Output = Result<Summary, Error>;

    fn visit<const D: usize>(self, mut case: Case<D>) -> Result<Summary, Error> {
        let Self { file, directory, watch, options } = self;
        if !options.resumes {
            keep_input(directory, file.path())?;
        } else if checkpoint_steps(directory).is_empty() {
            return Err(Error::NoCheckpoint { directory: directory.to_owned() });
        }
        let _claim = Claim::new(directory, file, options.resumes || options.overwrites)?;
        let (start, header, unread) = if options.resumes {
            let (start, header, unread) = last_checkpoint(file, &mut case, directory)?;
            keep_last(directory)?;
            (start, Some(header), unread)
        } else {
            remove_checkpoints(directory, options.discards)?;
            remove_series(directory)?;
            (State::initial(&case.setup)?, None, None)
        };
        create_directory(&directory.join("vtk"))?;
        if !case.probes.lines.is_empty() {
            create_directory(&directory.join(LINES))?;
        }
        file.write(directory)?;
        // If the cut of the bodies fails, the first step returns the error.
        if let Ok(mut sizes) = Sizes::new(file.scenario(), &case, &start) {
            if let Some(error) = unread {
                let warning =
                    format!("warning: {error}; the run is resumed from the checkpoint of step {}", start.step);
                sizes.lines.push(warning.clone());
                sizes.warnings.push(warning);
            }
            watch.begin(&sizes);
        }
        let n_steps = case.n_steps - start.step;
        let mut files = RunFiles::open(file.scenario(), &case, directory, header)?;
        files.stop = options.stop;
        let mut observer = FileObserver { files: &mut files, resumes: options.resumes, watch: watch.observer(&case) };
        let mut time_loop = TimeLoop::new(&case.setup, start, case.workspace);
        let outcome = time_loop.run(n_steps, &mut [&mut observer]);
        drop(observer);
        let summary = &mut files.summary.summary;
        summary.outside = outside_walls(&case.setup, time_loop.state(), &summary.units.length);
        summary.overlapping = overlapping(&case.setup, time_loop.state());
        files.write_summary()?;
        outcome.map_err(|error| match error.source {
            solver::Error::Observer(cause) if cause.is::<Interrupted>() => {
                Error::Interrupted { directory: directory.to_owned(), step: error.step }
            }
            source => Error::Step(StepError { source, ..error }),
        })?;
        Ok(files.summary.summary)
    }
}

/// The error with which the observer of a run ends it.
#[derive(Debug, thiserror::Error)]
#[error("stopped")]
struct Interrupted;

/// Returns the state and the header of the last checkpoint in a directory that can be read, and the error of the last
/// one if it cannot be read. Restores the memory of the linear solver.
///
/// # Errors
/// There is no checkpoint, it belongs to another scenario or program, or it is beyond the end of the run.
fn last_checkpoint<const D: usize>(
    file: &ScenarioFile,
    case: &mut Case<D>,
    directory: &Path,
) -> Result<(State<D>, Header, Option<Error>), Error> {
    let (Checkpoint { header, lists, memory }, unread) = Checkpoint::last(directory).map_err(|error| match error {
        Error::Checkpoint { path, problem } => {
            Error::Checkpoint { path, problem: format!("{problem}; remove it, and run the scenario again") }
        }
        error => error,
    })?;
    let refused = |problem: String| Err(Error::Checkpoint { path: directory.to_owned(), problem });
    let problem = problem_text(file)?;
    if header.scenario != problem {
        let key = first_difference(&header.scenario, &problem);
        return refused(format!(
            "the scenario is not that of the run: `{key}` or the file that it names differs, and only [output] and time.end may change"
        ));
    }
    let stored = ScenarioFile::read(&directory.join("scenario.toml"), &[])?;
    if probes_text(file)? != probes_text(&stored)? {
        return refused(
            "the probes are not those of the run: probes.csv has their columns; start a new run".to_owned(),
        );
    }
    if header.step > case.n_steps {
        return refused(format!("it is at step {}, and time.end is at step {}", header.step, case.n_steps));
    }
    let of_another =
        |cause: &dyn std::fmt::Display| refused(format!("another version of the program wrote it: {cause}"));
    let state = match State::from_lists(&case.setup, &lists) {
        Ok(state) if state.step == header.step => state,
        Ok(_) => return refused("its header and its state have different steps".to_owned()),
        Err(error) => return of_another(&error.source),
    };
    match case.workspace.recall(&memory) {
        Ok(()) => Ok((state, header, unread)),
        Err(error @ LinearError::Memory) => of_another(&error),
        Err(error) => refused(format!("its matrix cannot be factorised: {error}")),
    }
}

/// Removes the checkpoints of a finished run, with `discards` those of any run.
///
/// # Errors
/// [`Error::Unfinished`]: the run is not finished. [`Error::Checkpoint`]: no checkpoint can be read.
fn remove_checkpoints(directory: &Path, discards: bool) -> Result<(), Error> {
    if discards {
        return remove_all(directory);
    }
    let is_finished = |header: &Header| header.step >= header.n_steps;
    match Checkpoint::last(directory) {
        Err(Error::NoCheckpoint { .. }) => Ok(()),
        Ok((Checkpoint { header, .. }, _)) if !is_finished(&header) => {
            Err(Error::Unfinished { directory: directory.to_owned(), step: header.step })
        }
        Ok(_) => remove_all(directory),
        Err(Error::Checkpoint { path, problem }) => {
            let remedy = "remove the files checkpoint-*.bin, or choose another directory with `--out`";
            Err(Error::Checkpoint { path, problem: format!("{problem}; for a new run {remedy}") })
        }
        Err(error) => Err(error),
    }
}

/// Removes series of fields and probes of an earlier run, which this run may not replace.
fn remove_series(directory: &Path) -> Result<(), Error> {
    for name in SERIES {
        let path = directory.join(format!("{name}.pvd"));
        if path.is_file() {
            std::fs::remove_file(&path).map_err(|source| Error::Write { path, source })?;
        }
    }
    // A run without probes writes no file that would replace this one.
    let probes = directory.join(TABLES[2]);
    if probes.is_file() {
        std::fs::remove_file(&probes).map_err(|source| Error::Write { path: probes, source })?;
    }
    remove_fields(directory, |_| true)
}

/// Returns whether a file has the columns of a line probe.
fn is_line(path: &Path) -> bool {
    let mut header = String::new();
    let read = File::open(path).and_then(|file| BufReader::new(file).read_line(&mut header));
    read.is_ok() && header.starts_with("x [") && header.contains(",velocity_x [") && header.contains(",pressure [")
}

/// Removes the files of fields and lines of some steps.
fn remove_fields(directory: &Path, is_removed: impl Fn(usize) -> bool) -> Result<(), Error> {
    let folders = ["vtk", LINES].into_iter().filter_map(|folder| std::fs::read_dir(directory.join(folder)).ok());
    for path in folders.flatten().filter_map(|entry| Some(entry.ok()?.path())) {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let field = name.strip_suffix(".vtu").and_then(|name| name.rsplit_once('_'));
        let field = field.filter(|(series, _)| SERIES.contains(series));
        let line = name.strip_suffix(".csv").and_then(|name| name.rsplit_once('_')).filter(|_| is_line(&path));
        let step = field.or(line).and_then(|(_, step)| step.parse().ok());
        if step.is_some_and(&is_removed) {
            std::fs::remove_file(&path).map_err(|source| Error::Write { path, source })?;
        }
    }
    Ok(())
}

struct RunFiles<'a, const D: usize> {
    directory: PathBuf,
    /// The scenario without end time and output, which may change when a run is resumed.
    problem: String,
    output: Output,
    n_steps: usize,
    bottom: f64,
    history: History<D>,
    /// Lines along which fields are written, and the names of their columns.
    lines: (Vec<ProbeLine<D>>, Vec<String>),
    summary: SummaryBuilder,
    series: [Series; SERIES.len()],
    begin: Instant,
    /// Wall-clock time of the run up to its checkpoint, s.
    seconds_before: f64,
    /// Time of the last checkpoint.
    last_checkpoint: Instant,
    stop: Option<&'a AtomicBool>,
}

impl<'a, const D: usize> RunFiles<'a, D> {
    /// Creates the files of the run of a scenario, whose copy is in the directory, or cuts them back to a checkpoint.
    fn open(scenario: &Scenario, case: &Case<D>, directory: &Path, header: Option<Header>) -> Result<Self, Error> {
        let setup = &case.setup;
        let leading = leading_body(setup);
        let contact = setup.contacts.iter().find(|contact| Some(contact.body().index()) == leading);
        let units = UnitLabels::new(&scenario.units, scenario.dimension_of_whole());
        let start = Summary {
            case: scenario.name.to_string(),
            dimension: D,
            units: units.clone(),
            stabilisation: scenario.fluid.as_ref().map_or_else(String::new, Fluid::stabilisation_name),
            half_domain: case.half_domain,
            linear_solver: case.linear.clone(),
            dt: setup.dt,
            cells: setup.fluid.as_ref().map_or(0, |fluid| fluid.background.n_cells()),
            bodies: setup.bodies.iter().map(|body| body.name().to_owned()).collect(),
            leading: leading.map(|index| setup.bodies[index].name().to_owned()),
            contact_offset: contact.map(|contact| contact.form().law.offset()),
            ..Summary::default()
        };
        let lengths = header.as_ref().map(|header| header.histories);
        let mut files = Self {
            directory: directory.to_owned(),
            problem: problem_text(&ScenarioFile::read(&directory.join("scenario.toml"), &[])?)?,
            output: scenario.output.clone(),
            n_steps: case.n_steps,
            bottom: case.bottom,
            history: History::open(directory, setup, (case.probes.columns.clone(), &units), lengths)?,
            lines: (case.probes.lines.clone(), case.probes.line_header.clone()),
            summary: SummaryBuilder::new(start, setup.fluid.as_ref().map_or(0.0, |fluid| fluid.background.volume())),
            series: SERIES.map(|name| Series::new(directory, name)),
            begin: Instant::now(),
            seconds_before: 0.0,
            last_checkpoint: Instant::now(),
            stop: None,
        };
        if let Some(header) = header {
            files.seconds_before = header.summary.summary.wall_seconds;
            files.summary = header.summary;
            files.summary.summary.outside.clear();
            files.summary.summary.overlapping.clear();
            files.summary.summary.units = units;
            remove_fields(directory, |step| step > header.step)?;
            let mut series = files.series.iter_mut().zip(header.series);
            series.try_for_each(|(series, entries)| series.cut_back(entries))?;
        }
        Ok(files)
    }

    fn write_checkpoint(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        self.write_summary()?;
        let state = view.state;
        let (lists, memory) = (state.to_lists(), view.workspace.memory());
        let header = Header {
            step: state.step,
            n_steps: self.n_steps,
            time: state.time,
            scenario: self.problem.clone(),
            lists: lists.iter().map(Vec::len).collect(),
            memory: memory.iter().map(Vec::len).collect(),
            histories: self.history.lengths()?,
            summary: self.summary.clone(),
            series: self.series.iter().map(|series| series.entries().to_vec()).collect(),
        };
        self.last_checkpoint = Instant::now();
        Checkpoint { header, lists, memory }.write(&self.directory)
    }

    /// Returns whether a checkpoint is written at the end of a step.
    fn is_checkpoint(&self, step: usize) -> bool {
        let every = self.output.checkpoint_interval();
        if step == self.n_steps {
            // An earlier checkpoint, as of an interrupt, would make the finished run look unfinished.
            return every > 0 || !checkpoint_steps(&self.directory).is_empty();
        }
        let minutes = self.output.checkpoint_minutes.unwrap_or(0.0);
        let is_due = self.last_checkpoint.elapsed().as_secs_f64() >= 60.0 * minutes;
        every > 0 && step.is_multiple_of(every) && is_due
    }

    fn write_fields(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let (setup, state) = (view.setup, view.state);
        // No series without points: ParaView does not read empty grids.
        let fluid = setup.fluid.as_ref().zip(state.fluid.as_ref());
        let grids: [Option<Grid>; SERIES.len()] = [
            fluid.map(|(setup, fluid)| fluid_grid(&setup.background, fluid)),
            bodies_grid(setup, state, Shown::Cells),
            bodies_grid(setup, state, Shown::Surfaces),
            fluid.filter(|_| !setup.bodies.is_empty()).map(|(_, fluid)| interface_grid(fluid, view.report)),
            surface_grid(view),
        ];
        for (series, grid) in self.series.iter_mut().zip(grids) {
            if let Some(grid) = grid.and_then(|grid| grid.retain(|name| self.output.has_field(name))) {
                series.push(state.step, state.time, |path| grid.write(path, self.output.compression))?;
            }
        }
        let (lines, header) = &self.lines;
        for line in lines {
            let path = self.directory.join(LINES).join(format!("{}_{:06}.csv", line.name, state.step));
            write_whole(&path, csv(header, line.rows(view)).as_bytes())?;
        }
        Ok(())
    }

    fn write_summary(&mut self) -> Result<(), Error> {
        self.history.check()?;
        let summary = &mut self.summary.summary;
        summary.wall_seconds = self.seconds_before + self.begin.elapsed().as_secs_f64();
        summary.peak_rss_bytes = peak_rss_bytes();
        summary.write(&self.directory.join("summary.json"))
    }
}

/// Observer that writes the files of a step, calls the observer of the program, and writes a checkpoint if one is due.
/// At the checkpoint, files and observer have recorded the step.
struct FileObserver<'a, 'b, const D: usize> {
    files: &'a mut RunFiles<'b, D>,
    /// Whether the run is resumed from a checkpoint. Its first state is recorded already.
    resumes: bool,
    watch: Option<Box<dyn Observer<D> + 'a>>,
}

impl<const D: usize> Observer<D> for FileObserver<'_, '_, D> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        if view.report.is_some() || !self.resumes {
            self.files.write(view)?;
        }
        if let Some(watch) = &mut self.watch {
            watch.after_step(view)?;
        }
        if view.report.is_some() && view.ends_step() { self.files.end_step(view) } else { Ok(()) }
    }
}

impl<const D: usize> RunFiles<'_, D> {
    /// Writes the files of a step.
    fn write(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let clock = Instant::now();
        let step = view.state.step;
        let every = self.output.vtk_every;
        let is_output = view.ends_step() && every > 0 && (step.is_multiple_of(every) || step == self.n_steps);
        if is_output {
            self.write_fields(view)?;
        }
        let seconds = clock.elapsed().as_secs_f64();
        let bodies = (0..view.setup.bodies.len()).map(|index| BodyMeasures::new(view, index, self.bottom));
        let bodies: Vec<_> = bodies.flatten().collect();
        self.summary.add(view, &bodies, seconds);
        self.history.write(view, &bodies, seconds)?;
        if is_output || step.is_multiple_of(10) || step == self.n_steps {
            self.write_summary()?;
        }
        Ok(())
    }

    /// Writes a checkpoint if one is due, or if the run is to stop.
    ///
    /// # Errors
    /// The checkpoint cannot be written; [`Interrupted`].
    fn end_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let state = view.state;
        let stops = state.step < self.n_steps && self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
        if stops || self.is_checkpoint(state.step) {
            self.write_checkpoint(view)?;
        }
        if stops { Err(Box::new(Interrupted)) } else { Ok(()) }
    }
}
