//! Pictures of a run: histories, isolines of displacement and vorticity, the flow, frames of an animation.

mod canvas;
mod chart;
mod field;
mod flow;
mod frames;
mod histories;
mod isolines;
mod moments;
mod view;
mod vorticity;

use std::path::Path;

use solver::{BodyState, FluidBoundary, FluidState, Setup, StepView};

use crate::Error;
use canvas::{Picture, draw_png, draw_svg, svg_text};
use field::Field;
use isolines::Isolines;
use vorticity::Vorticity;

pub use chart::{Chart, Curve, Event, Panel};
pub use frames::{Frame, Frames};
pub use histories::{body_chart, column_curve, comparison_chart, contact_chart, force_chart, thickness_chart};
pub(crate) use isolines::PLATE;
pub use moments::{Moment, Moments};

/// Pixels per unit of length in bitmaps.
const RESOLUTION: u32 = 2;

/// Draws a chart as `STEM.png` and `STEM.svg`.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_chart(stem: &Path, chart: &Chart) -> Result<(), Error> {
    draw_both(stem, chart)
}

/// A panel as the text of an SVG picture.
///
/// # Errors
/// [`Error::Plot`].
pub fn panel_svg(panel: &Panel) -> Result<String, Error> {
    svg_text(&Chart { columns: 1, panels: vec![panel.clone()] })
        .map_err(|e| Error::Plot { path: panel.title.clone().into(), message: e.to_string() })
}

/// Draws the isolines of the vertical displacement of bodies as `STEM.png` and `STEM.svg`; nothing in 3D.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_isolines<const D: usize>(
    stem: &Path,
    setup: &Setup<D>,
    bodies: &[BodyState<D>],
    indices: &[usize],
    time: f64,
) -> Result<(), Error> {
    match Isolines::new(setup, bodies, indices, time, mirror(setup)).filter(|_| is_planar::<D>()) {
        Some(picture) => draw_both(stem, &picture),
        None => Ok(()),
    }
}

/// Draws the speed of the fluid with bodies and meshes; nothing in 3D.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_flow<const D: usize>(path: &Path, setup: &Setup<D>, fluid: &FluidState<D>, time: f64) -> Result<(), Error> {
    if !is_planar::<D>() {
        return Ok(());
    }
    draw_png(path, &Field::new(setup, fluid, time, mirror(setup)), RESOLUTION)
}

/// Draws isolines of the vorticity and velocity vectors as `STEM.png` and `STEM.svg`, once as a whole and once near the
/// lowest point of body `leading`; nothing in 3D.
///
/// # Errors
/// [`Error::Plot`], [`Error::Write`].
pub fn draw_vorticity<const D: usize>(
    stem: &Path,
    setup: &Setup<D>,
    fluid: &FluidState<D>,
    leading: Option<usize>,
    time: f64,
) -> Result<(), Error> {
    if !is_planar::<D>() {
        return Ok(());
    }
    draw_both(stem, &Vorticity::new(setup, fluid, leading, time, mirror(setup)))
}

/// Records the frames of an animation; `None` in 3D.
#[derive(Debug)]
pub struct FrameRecorder {
    frames: Frames,
    n_steps: usize,
}

impl FrameRecorder {
    /// A recorder for a run of that many steps.
    pub fn new<const D: usize>(setup: &Setup<D>, n_steps: usize) -> Option<Self> {
        is_planar::<D>().then(|| Self { frames: Frames::new(setup, mirror(setup)), n_steps })
    }

    /// Looks at a step, where the leading body has that smallest distance.
    pub fn watch<const D: usize>(&mut self, view: &StepView<'_, D>, distance: Option<f64>) {
        self.frames.watch(view, self.n_steps, distance);
    }

    /// What was recorded.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }
}

fn draw_both(stem: &Path, picture: &impl Picture) -> Result<(), Error> {
    draw_png(&stem.with_extension("png"), picture, RESOLUTION)?;
    draw_svg(&stem.with_extension("svg"), picture)
}

fn is_planar<const D: usize>() -> bool {
    D == 2
}

/// Position of the left or right side if it is a plane of symmetry: pictures then show the whole.
fn mirror<const D: usize>(setup: &Setup<D>) -> Option<f64> {
    let (tag, _) = setup.fluid.boundary.iter().find(|(_, c)| matches!(c, FluidBoundary::Symmetry { axis: 0 }))?;
    let facet = setup.background.facets().find(|f| setup.background.facet_tag(*f) == Some(*tag))?;
    Some(setup.background.vertex(setup.background.facet(facet)[0])[0])
}
