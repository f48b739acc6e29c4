//! A short run with field files, and the sizes that an independent reader has to find in them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use cutwater::io::{self, Case, ScenarioFile, Watch};
use cutwater::solver::{Observer, ObserverError, StepView};
use serde::Serialize;

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

/// Writes the files of a run and `expected.json`, for `check_vtk.py`.
pub(super) fn check(out: &Path) -> Outcome {
    let file = ScenarioFile::read(&scenario_path("virtual-barrier"), &SHORT.map(str::to_owned))?;
    let mut expected = Expected::default();
    io::run(&file, out, &mut expected)?;
    fs::write(out.join("expected.json"), serde_json::to_string_pretty(&expected.0)?)?;
    println!("  {} files are in {}", expected.0.len(), out.display());
    Ok(true)
}

#[derive(Serialize)]
struct Content {
    cells: usize,
    /// Sum of the areas of the polygons. `None` for files whose area is not checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    area: Option<f64>,
}

/// Expected content of each file, by its path.
#[derive(Default)]
struct Expected(BTreeMap<String, Content>);

impl Watch for Expected {
    fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        Some(Box::new(self))
    }
}

impl<const D: usize> Observer<D> for &mut Expected {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let step = view.state.step;
        if !view.ends_step() || !step.is_multiple_of(EVERY) {
            return Ok(());
        }
        let cut = &view.state.fluid.as_ref().ok_or("there is no fluid")?.cut;
        let pieces = |part| if cut.is_whole(part) { 1 } else { cut.part_pieces(part).len() };
        let solids = view.setup.bodies.iter().zip(&view.state.bodies).filter_map(|(body, now)| body.cells(now));
        let fluid = Content { cells: cut.all_parts().map(pieces).sum(), area: Some(cut.fluid_volume()) };
        let solid = Content { cells: solids.map(|solid| solid.stress.len()).sum(), area: None };
        let interface = Content { cells: cut.interface().len(), area: None };
        for (name, content) in [("fluid", fluid), ("solid", solid), ("interface", interface)] {
            self.0.insert(format!("vtk/{name}_{step:06}.vtu"), content);
        }
        Ok(())
    }
}
