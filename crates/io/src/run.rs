//! From a scenario to a directory of results.

use std::path::{Path, PathBuf};
use std::time::Instant;

use algebra::{BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, Fill, LaggedSettings, LaggedSolver, Workspace};
use solver::solid_rigid::modes::n_modes;
use solver::{Body, BodyKind, Observer, ObserverError, Setup, State, StepView, TimeLoop};

use crate::diagnostics::Diagnostics;
use crate::files::{create_directory, write_whole};
use crate::history::{History, HistoryTable, column_prefix};
use crate::measures::{BodyMeasures, leading_body};
use crate::scenario::lower::{Case, CaseVisitor, lower};
use crate::scenario::schema::{Blocks, BodyBlock, Cip, FluidBlock, Linear, Motion, Output, Preconditioner};
use crate::scenario::{Scenario, ScenarioFile};
use crate::summary::{Summary, SummaryBuilder, peak_rss_bytes};
use crate::vtk::fluid::fluid_grid;
use crate::vtk::interface::interface_grid;
use crate::vtk::rigid::rigid_grid;
use crate::vtk::series::Series;
use crate::vtk::solid::solid_grid;
use crate::{Error, plot};

/// How to run a scenario.
pub struct RunOptions<'a> {
    /// Where results go.
    pub directory: PathBuf,
    /// Called after every step.
    pub progress: Option<&'a mut dyn FnMut(&StepProgress)>,
}

impl RunOptions<'_> {
    /// Results into a directory, without progress.
    pub fn into_directory(directory: impl Into<PathBuf>) -> Self {
        Self { directory: directory.into(), progress: None }
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepProgress {
    /// Steps done.
    pub step: usize,
    /// Steps in all.
    pub n_steps: usize,
    /// Time reached.
    pub time: f64,
    /// Smallest distance of the leading body.
    pub d_min: Option<f64>,
    /// Newton corrections of the step.
    pub newton_iterations: usize,
    /// Whether there is contact.
    pub in_contact: bool,
}

/// Where results go if the command line names no directory.
pub fn default_directory(scenario: &Scenario) -> PathBuf {
    scenario.output.directory.as_ref().map_or_else(|| Path::new("results").join(&scenario.name), PathBuf::from)
}

/// Runs a scenario and writes `history.csv`, `diagnostics.csv`, `summary.json`, `scenario.toml`, VTK series, pictures and
/// the frames of an animation, `frames.json`.
///
/// # Errors
/// [`Error`]; if a step failed, the files are complete up to the step before it.
pub fn run(file: &ScenarioFile, options: RunOptions<'_>) -> Result<Summary, Error> {
    lower(file, Run { file, options })?
}

struct Run<'a, 'p> {
    file: &'a ScenarioFile,
    options: RunOptions<'p>,
}

impl CaseVisitor for Run<'_, '_> {
    type Output = Result<Summary, Error>;

    fn visit<const D: usize>(self, case: Case<D>) -> Result<Summary, Error> {
        let directory = &self.options.directory;
        let scenario = self.file.scenario();
        remove_series(directory)?;
        create_directory(&directory.join("vtk"))?;
        write_scenario(self.file, directory)?;
        let mut files = RunFiles::new(scenario, &case, directory)?;
        let mut progress = Progress { report: self.options.progress, n_steps: case.n_steps, bottom: case.bottom };
        let state = State::initial(&case.setup)?;
        let mut time_loop = TimeLoop::new(&case.setup, state, workspace(&scenario.solver.linear));
        let outcome = time_loop.run(case.n_steps, &mut [&mut files, &mut progress]);
        if outcome.is_ok() {
            let clock = Instant::now();
            files.summary.summary.refactorization_seconds = time_loop.workspace().time_refactorization().ok();
            files.summary.summary.add_timing("measuring a refactorisation", None, 1, clock.elapsed().as_secs_f64());
        }
        let files = files.finish(scenario, &case.setup);
        // A step that failed says more than a picture that could not be drawn.
        outcome?;
        files
    }
}

/// Removes series of fields that an older run has left: they would be taken for those of the new one.
fn remove_series(directory: &Path) -> Result<(), Error> {
    const SERIES: [&str; 4] = ["fluid", "solid", "rigid", "interface"];
    for (folder, ending) in [(directory.to_owned(), "pvd"), (directory.join("vtk"), "vtu")] {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let is_ours = SERIES.iter().any(|series| name.starts_with(series));
            if is_ours && path.extension().is_some_and(|found| found == ending) {
                std::fs::remove_file(&path).map_err(|source| Error::Write { path, source })?;
            }
        }
    }
    Ok(())
}

/// Writes the scenario with copies of the tables that it names, so that it can be run again from the directory.
fn write_scenario(file: &ScenarioFile, directory: &Path) -> Result<(), Error> {
    let mut scenario = file.scenario().clone();
    for (body, source) in file.tables() {
        let table = std::fs::read(&source).map_err(|error| Error::Read { path: source, source: error })?;
        let body = &mut scenario.bodies[body];
        let name = format!("motion-{}.csv", body.name);
        write_whole(&directory.join(&name), &table)?;
        if let Some(Motion::Table { file, .. }) = &mut body.motion {
            *file = name;
        }
    }
    write_whole(&directory.join("scenario.toml"), toml::to_string(&scenario)?.as_bytes())
}

/// Memory with the linear solver of the scenario.
fn workspace(linear: &Linear) -> Workspace {
    match linear {
        Linear::Direct {} => Workspace::new(),
        Linear::Gmres { preconditioner: Preconditioner::LaggedLu, .. } => {
            Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())))
        }
        Linear::Gmres { preconditioner: Preconditioner::BlockGaussSeidel, restart, blocks } => {
            let mut settings = BlockGaussSeidelSettings::default();
            if let Some(restart) = restart {
                settings.restart = *restart;
            }
            if let Some(Blocks { fluid, bodies }) = blocks {
                let fluid = match fluid {
                    FluidBlock::Lu => BlockSolver::Lu,
                    FluidBlock::Ilu => BlockSolver::Incomplete(Fill::Pattern),
                    FluidBlock::Ilut => BlockSolver::Incomplete(Fill::THRESHOLD),
                };
                let bodies = match bodies {
                    BodyBlock::Lu => BlockSolver::Lu,
                    BodyBlock::Cholesky => BlockSolver::Cholesky,
                    BodyBlock::Ilu => BlockSolver::Incomplete(Fill::Pattern),
                    BodyBlock::Ilut => BlockSolver::Incomplete(Fill::THRESHOLD),
                };
                settings.solvers = vec![fluid, bodies];
            }
            Workspace::with_solver(Box::new(BlockGaussSeidel::new(settings)))
        }
    }
}

/// Writes everything that a run leaves behind.
struct RunFiles<const D: usize> {
    directory: PathBuf,
    output: Output,
    n_steps: usize,
    bottom: f64,
    history: History,
    diagnostics: Diagnostics,
    summary: SummaryBuilder,
    fluid: Series,
    solid: Series,
    rigid: Series,
    interface: Series,
    moments: plot::Moments<D>,
    frames: Option<plot::FrameRecorder>,
    begin: Instant,
}

impl<const D: usize> RunFiles<D> {
    fn new(scenario: &Scenario, case: &Case<D>, directory: &Path) -> Result<Self, Error> {
        let start = Summary {
            case: scenario.name.clone(),
            profile: match scenario.fluid.cip {
                Cip::Paper { .. } => "paper".to_owned(),
                Cip::Consistent { .. } => "consistent".to_owned(),
            },
            half_domain: case.half_domain,
            dt: case.setup.dt,
            cells: case.setup.background.n_cells(),
            ..Summary::default()
        };
        Ok(Self {
            directory: directory.to_owned(),
            output: scenario.output.clone(),
            n_steps: case.n_steps,
            bottom: case.bottom,
            history: History::create(&directory.join("history.csv"), case.bottom)?,
            diagnostics: Diagnostics::create(&directory.join("diagnostics.csv"), &case.setup)?,
            summary: SummaryBuilder::new(start, case.bottom),
            fluid: Series::new(directory, "fluid"),
            solid: Series::new(directory, "solid"),
            rigid: Series::new(directory, "rigid"),
            interface: Series::new(directory, "interface"),
            moments: plot::Moments::default(),
            frames: plot::FrameRecorder::new(&case.setup, case.n_steps).filter(|_| scenario.output.plots),
            begin: Instant::now(),
        })
    }

    fn write_fields(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let (step, time, level) = (view.state.step, view.state.time, self.output.compression);
        let fluid = fluid_grid(&view.setup.background, &view.state.fluid);
        self.fluid.push(step, time, |path| fluid.write(path, level))?;
        // Series of what there is: ParaView stumbles over grids without points.
        let bodies = &view.setup.bodies;
        if bodies.iter().any(|body| body.elastic().is_some()) {
            let solid = solid_grid(view.setup, view.state);
            self.solid.push(step, time, |path| solid.write(path, level))?;
        }
        if bodies.iter().any(is_rigid) {
            let rigid = rigid_grid(view.setup, view.state);
            self.rigid.push(step, time, |path| rigid.write(path, level))?;
        }
        if bodies.is_empty() {
            return Ok(());
        }
        let interface = interface_grid(&view.state.fluid, view.report);
        self.interface.push(step, time, |path| interface.write(path, level))
    }

    fn write_step(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let clock = Instant::now();
        let step = view.state.step;
        let every = self.output.vtk_every;
        let is_output = view.ends_step() && every > 0 && (step.is_multiple_of(every) || step == self.n_steps);
        if is_output {
            self.write_fields(view)?;
        }
        if self.output.plots {
            self.moments.watch(view, step == self.n_steps);
        }
        if let Some(frames) = &mut self.frames {
            let leading = leading_body(view.setup).and_then(|index| BodyMeasures::new(view, index, self.bottom));
            frames.watch(view, leading.map(|body| body.d_min));
        }
        let seconds = clock.elapsed().as_secs_f64();
        self.summary.add(view, seconds, self.begin.elapsed().as_secs_f64());
        self.history.write(view, seconds)?;
        self.diagnostics.write(view)?;
        if is_output || step.is_multiple_of(10) || step == self.n_steps {
            self.write_summary()?;
        }
        Ok(())
    }

    fn write_summary(&mut self) -> Result<(), Error> {
        self.summary.summary.peak_rss_bytes = peak_rss_bytes();
        self.summary.summary.write(&self.directory.join("summary.json"))
    }

    /// Draws the history, the fields at contact, after the rebound and at the deepest contact.
    fn draw(&self, scenario: &Scenario, setup: &Setup<D>) -> Result<(), Error> {
        let file = |name: &str| self.directory.join(name);
        if let Some(leading) = leading_body(setup) {
            self.draw_histories(scenario, setup, leading)?;
        }
        self.draw_fields(setup, leading_body(setup))?;
        if let Some(frames) = &self.frames {
            write_whole(&file("frames.json"), serde_json::to_string(frames.frames())?.as_bytes())?;
        }
        Ok(())
    }

    fn draw_histories(&self, scenario: &Scenario, setup: &Setup<D>, leading: usize) -> Result<(), Error> {
        let file = |name: &str| self.directory.join(name);
        let table = HistoryTable::read(&file("history.csv"))?;
        let (prefix, marks) = (column_prefix(setup, leading), &scenario.output.marks);
        plot::draw_chart(&file("history"), &plot::body_chart(&table, &prefix, marks))?;
        let offset = scenario.contacts.iter().find(|c| c.body == setup.bodies[leading].name).map(|c| c.offset);
        if let Some(chart) = plot::contact_chart(&table, &self.summary.summary, &prefix, marks, offset) {
            plot::draw_chart(&file("contact"), &chart)?;
        }
        if let Some(chart) = plot::thickness_chart(&HistoryTable::read(&file("diagnostics.csv"))?, marks) {
            plot::draw_chart(&file("thickness"), &chart)?;
        }
        let bodies = setup.bodies.iter().enumerate().filter(|(_, body)| is_rigid(body));
        let named: Vec<_> = bodies.map(|(k, body)| (body.name.clone(), column_prefix(setup, k))).collect();
        if let Some(chart) = plot::force_chart(&table, &named) {
            plot::draw_chart(&file("forces"), &chart)?;
        }
        Ok(())
    }

    fn draw_fields(&self, setup: &Setup<D>, leading: Option<usize>) -> Result<(), Error> {
        let file = |name: &str| self.directory.join(name);
        if let (Some((time, bodies)), Some(leading)) = (&self.moments.deepest, leading) {
            plot::draw_isolines(&file("displacement"), setup, bodies, &[leading], *time)?;
        }
        if let Some(plot::Moment { time, fluid, bodies }) = &self.moments.contact {
            plot::draw_flow(&file("flow.png"), setup, fluid, *time)?;
            plot::draw_vorticity(&file("vorticity"), setup, fluid, leading, *time)?;
            let all: Vec<usize> = (0..setup.bodies.len()).collect();
            plot::draw_isolines(&file("displacement-contact"), setup, bodies, &all, *time)?;
        }
        if let Some(plot::Moment { time, fluid, .. }) = &self.moments.second_contact {
            plot::draw_vorticity(&file("vorticity-second-contact"), setup, fluid, leading, *time)?;
        }
        Ok(())
    }

    /// Writes the summary and the pictures.
    fn finish(mut self, scenario: &Scenario, setup: &Setup<D>) -> Result<Summary, Error> {
        let clock = Instant::now();
        // Complete before the pictures, whatever becomes of them.
        self.write_summary()?;
        if self.output.plots && self.summary.summary.steps > 0 {
            self.draw(scenario, setup)?;
        }
        let seconds = clock.elapsed().as_secs_f64();
        self.summary.summary.seconds.output += seconds;
        self.summary.summary.add_timing("output", None, 1, seconds);
        self.summary.summary.wall_seconds = self.begin.elapsed().as_secs_f64();
        self.write_summary()?;
        Ok(self.summary.summary)
    }
}

impl<const D: usize> Observer<D> for RunFiles<D> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        Ok(self.write_step(view)?)
    }
}

/// Whether a body does not deform.
fn is_rigid<const D: usize>(body: &Body<D>) -> bool {
    body.elastic().is_none()
}

/// Tells the caller where the run stands.
struct Progress<'p> {
    report: Option<&'p mut dyn FnMut(&StepProgress)>,
    n_steps: usize,
    bottom: f64,
}

impl<const D: usize> Observer<D> for Progress<'_> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let (Some(tell), Some(report)) = (self.report.as_mut(), view.report.filter(|_| view.ends_step())) else {
            return Ok(());
        };
        let leading = leading_body(view.setup).and_then(|index| BodyMeasures::new(view, index, self.bottom));
        tell(&StepProgress {
            step: view.state.step,
            n_steps: self.n_steps,
            time: view.state.time,
            d_min: leading.map(|body| body.d_min),
            newton_iterations: report.newton.iterations,
            in_contact: report.contacts.iter().any(contact::ContactReport::is_active),
        });
        Ok(())
    }
}

/// Sizes of a scenario that was not run.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Cells of the background.
    pub background_cells: usize,
    /// Vertices of the background.
    pub background_vertices: usize,
    /// Name, cells and vertices of each body; no cells where only the surface counts, because it does not deform.
    pub bodies: Vec<(String, usize, usize)>,
    /// Cut cells at the start.
    pub cut_cells: usize,
    /// Unknowns of the first step.
    pub dofs: usize,
    /// Steps.
    pub n_steps: usize,
    /// Whether half of a symmetric problem is solved.
    pub half_domain: bool,
}

/// Builds the meshes of a scenario and the first cut, and runs nothing.
///
/// # Errors
/// [`Error::Scenario`], [`Error::Step`].
pub fn sizes(file: &ScenarioFile) -> Result<Sizes, Error> {
    struct Measure;
    impl CaseVisitor for Measure {
        type Output = Result<Sizes, Error>;
        fn visit<const D: usize>(self, case: Case<D>) -> Result<Sizes, Error> {
            let state = State::initial(&case.setup)?;
            let size = |body: &Body<D>| match body.elastic() {
                Some(elastic) => (body.name.clone(), elastic.solid.mesh().n_cells(), body.reference().len()),
                None => (body.name.clone(), 0, body.reference().len()),
            };
            let bodies: Vec<_> = case.setup.bodies.iter().map(size).collect();
            let is_in_contact = |b: usize| case.setup.contacts.iter().any(|contact| contact.names(b));
            let of_body = |(b, body): (usize, &Body<D>)| match &body.kind {
                BodyKind::Elastic(_) => D * body.reference().len(),
                // Tied vertices, and the body as a whole.
                BodyKind::Rigid(_) => D * body.reference().len() + n_modes(D),
                BodyKind::Prescribed(_) if is_in_contact(b) => D * body.reference().len(),
                BodyKind::Prescribed(_) => 0,
            };
            let of_bodies: usize = case.setup.bodies.iter().enumerate().map(of_body).sum();
            Ok(Sizes {
                background_cells: case.setup.background.n_cells(),
                background_vertices: case.setup.background.n_vertices(),
                cut_cells: state.fluid.cut.report().n_cut_cells,
                dofs: (D + 1) * state.fluid.space.len() + of_bodies,
                n_steps: case.n_steps,
                half_domain: case.half_domain,
                bodies,
            })
        }
    }
    lower(file, Measure)?
}
