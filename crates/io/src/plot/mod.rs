//! Pictures of a run: histories, isolines of the displacement, the flow.

mod canvas;
mod field;
mod histories;
mod isolines;
mod view;

use std::path::Path;

use solver::{BodyState, FluidBoundary, FluidState, Setup, StepView};

use crate::Error;
use crate::history::HistoryTable;
use crate::scenario::schema::Mark;
use canvas::{draw_png, draw_svg};
use field::Field;
use histories::Histories;
use isolines::Isolines;

/// Pixels per unit of length in bitmaps.
const RESOLUTION: u32 = 2;

/// Moments of a run that are worth a picture, kept until its end.
#[derive(Clone, Debug, Default)]
pub struct Moments<const D: usize> {
    /// Time and flow at the first contact, or at the end if there is none.
    pub flow: Option<(f64, FluidState<D>)>,
    /// Time and bodies at the largest violation of an offset, or at the end if there is none.
    pub deepest: Option<(f64, Vec<BodyState<D>>)>,
    depth: f64,
    had_contact: bool,
}

impl<const D: usize> Moments<D> {
    /// Looks at a step, and keeps it if it is worth it.
    pub fn watch(&mut self, view: &StepView<'_, D>, is_last: bool) {
        let Some(report) = view.report else { return };
        let depth = report.contacts.iter().map(|contact| contact.largest_penetration).fold(0.0, f64::max);
        let touches = report.contacts.iter().any(contact::ContactReport::is_active);
        if !self.had_contact && (touches || is_last) {
            self.flow = Some((view.state.time, view.state.fluid.clone()));
        }
        if depth > self.depth || (is_last && self.depth == 0.0) {
            self.deepest = Some((view.state.time, view.state.bodies.clone()));
        }
        self.depth = self.depth.max(depth);
        self.had_contact |= touches;
    }
}

/// Draws the four graphs of a history as `STEM.png` and `STEM.svg`; `prefix` is that of the columns of the body, empty
/// if there is only one.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_history(stem: &Path, table: &HistoryTable, prefix: &str, marks: &[Mark]) -> Result<(), Error> {
    let picture = Histories { table, prefix: prefix.to_owned(), marks };
    draw_png(&stem.with_extension("png"), &picture, RESOLUTION)?;
    draw_svg(&stem.with_extension("svg"), &picture)
}

/// Draws the isolines of the vertical displacement of a body as `STEM.png` and `STEM.svg`; nothing in 3D.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_isolines<const D: usize>(
    stem: &Path,
    setup: &Setup<D>,
    bodies: &[BodyState<D>],
    index: usize,
    time: f64,
) -> Result<(), Error> {
    let Some(picture) = Isolines::new(setup, bodies, index, time, mirror(setup)).filter(|_| D == 2) else {
        return Ok(());
    };
    draw_png(&stem.with_extension("png"), &picture, RESOLUTION)?;
    draw_svg(&stem.with_extension("svg"), &picture)
}

/// Draws the speed of the fluid with bodies and meshes; nothing in 3D.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_flow<const D: usize>(path: &Path, setup: &Setup<D>, fluid: &FluidState<D>, time: f64) -> Result<(), Error> {
    if D != 2 {
        return Ok(());
    }
    draw_png(path, &Field::new(setup, fluid, time, mirror(setup)), RESOLUTION)
}

/// Position of the left or right side if it is a plane of symmetry: pictures then show the whole.
fn mirror<const D: usize>(setup: &Setup<D>) -> Option<f64> {
    let (tag, _) = setup.fluid.boundary.iter().find(|(_, c)| matches!(c, FluidBoundary::Symmetry { axis: 0 }))?;
    let facet = setup.background.facets().find(|f| setup.background.facet_tag(*f) == Some(*tag))?;
    Some(setup.background.vertex(setup.background.facet(facet)[0])[0])
}
