//! A short run with field files, and the sizes that an independent reader has to find in them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use cutwater::algebra::Workspace;
use cutwater::io::scenario::{Case, CaseVisitor, lower};
use cutwater::io::{self, ScenarioFile};
use cutwater::solver::{Observer, ObserverError, State, StepView, TimeLoop};
use serde::Serialize;

use super::flow::wet;
use crate::case::scenario_path;
use crate::outcome::Outcome;

/// Steps between two sets of files.
const EVERY: usize = 5;
/// A coarse ball just above the barrier: a few steps of fall, then contact.
const SHORT: [&str; 7] = [
    "background.size.fine=0.4",
    "background.size.coarse=1.0",
    "body.0.shape.size=0.4",
    "body.0.shape.centre=[0.0, 7.02]",
    "time.step=1e-3",
    "time.end=0.02",
    "output.vtk_every=5",
];

/// Writes the files of a run and `expected.json`, for `check_vtk.py`. Runs give the same bits every time, so the
/// numbers are taken from a second run.
///
/// # Errors
/// A run fails, or a file cannot be written.
pub(super) fn check(out: &Path) -> Outcome {
    let set = SHORT.map(str::to_owned);
    let file = ScenarioFile::read(&scenario_path("virtual-barrier"), &set)?;
    io::run(&file, out, &mut ())?;
    let expected = lower(&file, Expect)??;
    fs::write(out.join("expected.json"), serde_json::to_string_pretty(&expected)?)?;
    println!("  {} files are in {}", expected.len(), out.display());
    Ok(true)
}

/// Contents of a file.
#[derive(Serialize)]
struct Content {
    /// Number of cells.
    cells: usize,
    /// Sum of their areas; lengths do not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    area: Option<f64>,
}

/// File to content.
#[derive(Default)]
struct Expected(BTreeMap<String, Content>);

impl<const D: usize> Observer<D> for Expected {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let step = view.state.step;
        if !view.ends_step() || !step.is_multiple_of(EVERY) {
            return Ok(());
        }
        let cut = &wet(view.state).cut;
        let pieces = |part| if cut.is_whole(part) { 1 } else { cut.part_pieces(part).len() };
        let solids = view.setup.bodies.iter().zip(&view.state.bodies).filter_map(|(body, now)| body.cells(now));
        let fluid = Content { cells: cut.all_parts().map(pieces).sum(), area: Some(cut.fluid_volume()) };
        let solid = Content { cells: solids.map(|solid| solid.mesh.n_cells()).sum(), area: None };
        let interface = Content { cells: cut.interface().len(), area: None };
        for (name, content) in [("fluid", fluid), ("solid", solid), ("interface", interface)] {
            self.0.insert(format!("vtk/{name}_{step:06}.vtu"), content);
        }
        Ok(())
    }
}

struct Expect;

impl CaseVisitor for Expect {
    type Output = Result<BTreeMap<String, Content>, io::Error>;

    fn visit<const D: usize>(self, case: Case<D>) -> Self::Output {
        let mut expected = Expected::default();
        let state = State::initial(&case.setup)?;
        TimeLoop::new(&case.setup, state, Workspace::new()).run(case.n_steps, &mut [&mut expected])?;
        Ok(expected.0)
    }
}
