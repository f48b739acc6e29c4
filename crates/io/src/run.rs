//! From a scenario to a directory of results.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use solver::body::{Body, BodyState};
use solver::{Observer, ObserverError, State, Step, StepError, StepView, TimeLoop};

use crate::Error;
use crate::files::create_directory;
use crate::history::History;
use crate::measures::{BodyMeasures, leading_body};
use crate::scenario::{Case, CaseVisitor, Fluid, Output, Scenario, ScenarioFile, lower};
use crate::summary::{Summary, SummaryBuilder, UnitLabels, peak_rss_bytes};
use crate::vtk::Grid;
use crate::vtk::bodies::{Shown, bodies_grid};
use crate::vtk::fluid::fluid_grid;
use crate::vtk::interface::interface_grid;
use crate::vtk::series::Series;
use crate::watch::Watch;

/// Series of field files, by the names of their indices.
const SERIES: [&str; 4] = ["fluid", "solid", "rigid", "interface"];

/// Returns the directory of results if the command line names none.
pub fn default_directory(scenario: &Scenario) -> PathBuf {
    scenario.output.directory.as_ref().map_or_else(|| Path::new("results").join(scenario.name.as_str()), PathBuf::from)
}

/// Runs a scenario and writes `history.csv`, `diagnostics.csv`, `summary.json`, `scenario.toml` and field files into a
/// directory. `watch` attaches an observer to the run; `&mut ()` attaches none.
///
/// # Errors
/// [`Error`]; if a step failed, the files are complete up to the step before it.
pub fn run(file: &ScenarioFile, directory: &Path, watch: &mut impl Watch) -> Result<Summary, Error> {
    lower(file, Run { file, directory, watch })?
}

struct Run<'a, W> {
    file: &'a ScenarioFile,
    directory: &'a Path,
    watch: &'a mut W,
}

impl<W: Watch> CaseVisitor for Run<'_, W> {
    type Output = Result<Summary, Error>;

    fn visit<const D: usize>(self, case: Case<D>) -> Result<Summary, Error> {
        let Self { file, directory, watch } = self;
        remove_series(directory)?;
        create_directory(&directory.join("vtk"))?;
        file.write(directory)?;
        let mut files = RunFiles::new(file.scenario(), &case, directory)?;
        let mut observer = watch.observer(&case);
        let mut observers: Vec<&mut dyn Observer<D>> = vec![&mut files];
        if let Some(observer) = &mut observer {
            observers.push(observer.as_mut());
        }
        let state = State::initial(&case.setup)?;
        let outcome = TimeLoop::new(&case.setup, state, case.workspace).run(case.n_steps, &mut observers);
        drop(observer);
        files.write_summary()?;
        outcome?;
        Ok(files.summary.summary)
    }
}

/// Removes series of fields of an earlier run, which would otherwise mix with those of this one.
fn remove_series(directory: &Path) -> Result<(), Error> {
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

struct RunFiles<const D: usize> {
    directory: PathBuf,
    output: Output,
    n_steps: usize,
    bottom: f64,
    history: History<D>,
    summary: SummaryBuilder,
    series: [Series; 4],
    begin: Instant,
}

impl<const D: usize> RunFiles<D> {
    fn new(scenario: &Scenario, case: &Case<D>, directory: &Path) -> Result<Self, Error> {
        let setup = &case.setup;
        let leading = leading_body(setup);
        let contact = setup.contacts.iter().find(|contact| Some(contact.body().index()) == leading);
        let start = Summary {
            case: scenario.name.to_string(),
            dimension: D,
            units: UnitLabels::new(&scenario.units, D),
            stabilisation: scenario.fluid.as_ref().map_or_else(String::new, Fluid::stabilisation_name),
            half_domain: case.half_domain,
            dt: setup.dt,
            cells: setup.fluid.as_ref().map_or(0, |fluid| fluid.background.n_cells()),
            bodies: setup.bodies.iter().map(|body| body.name().to_owned()).collect(),
            leading: leading.map(|index| setup.bodies[index].name().to_owned()),
            contact_offset: contact.map(|contact| contact.form().law.offset()),
            ..Summary::default()
        };
        Ok(Self {
            directory: directory.to_owned(),
            output: scenario.output.clone(),
            n_steps: case.n_steps,
            bottom: case.bottom,
            history: History::create(directory, setup)?,
            summary: SummaryBuilder::new(start),
            series: SERIES.map(|name| Series::new(directory, name)),
            begin: Instant::now(),
        })
    }

    fn write_fields(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let (setup, state) = (view.setup, view.state);
        // No series without points: ParaView does not read empty grids.
        let fluid = setup.fluid.as_ref().zip(state.fluid.as_ref());
        let grids: [Option<Grid>; 4] = [
            fluid.map(|(setup, fluid)| fluid_grid(&setup.background, fluid)),
            bodies_grid(setup, state, Shown::Cells),
            bodies_grid(setup, state, Shown::Surfaces),
            fluid.filter(|_| !setup.bodies.is_empty()).map(|(_, fluid)| interface_grid(fluid, view.report)),
        ];
        for (series, grid) in self.series.iter_mut().zip(grids) {
            if let Some(grid) = grid {
                series.push(state.step, state.time, |path| grid.write(path, self.output.compression))?;
            }
        }
        Ok(())
    }

    fn write_summary(&mut self) -> Result<(), Error> {
        let summary = &mut self.summary.summary;
        summary.wall_seconds = self.begin.elapsed().as_secs_f64();
        summary.peak_rss_bytes = peak_rss_bytes();
        summary.write(&self.directory.join("summary.json"))
    }
}

impl<const D: usize> Observer<D> for RunFiles<D> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
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
}

/// Sizes of a scenario that was not run.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Cells of the background.
    pub background_cells: usize,
    /// Vertices of the background.
    pub background_vertices: usize,
    /// Name, cells and vertices of each body; no cells if only its surface is used, because it does not deform.
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
            let setup = &case.setup;
            let size = |body: &Arc<dyn Body<D>>, state: &BodyState<D>| {
                let cells = body.cells(state).map_or(0, |cells| cells.mesh.n_cells());
                (body.name().to_owned(), cells, body.reference().len())
            };
            let bodies = setup.bodies.iter().zip(&state.bodies).map(|(body, state)| size(body, state)).collect();
            let background = setup.fluid.as_ref().map(|fluid| &fluid.background);
            let step = Step::prepare(setup, &state, state.step_time(setup, setup.dt))
                .map_err(|stage| StepError::at(1, setup.dt, stage))?;
            Ok(Sizes {
                background_cells: background.map_or(0, |mesh| mesh.n_cells()),
                background_vertices: background.map_or(0, |mesh| mesh.n_vertices()),
                cut_cells: state.fluid.as_ref().map_or(0, |fluid| fluid.cut.report().n_cut_cells),
                dofs: step.layout.len(),
                n_steps: case.n_steps,
                half_domain: case.half_domain,
                bodies,
            })
        }
    }
    lower(file, Measure)?
}
