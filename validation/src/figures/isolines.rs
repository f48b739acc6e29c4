//! Isolines of the vertical displacement on deformed bodies.

use crate::units::cgs;
use cutwater::mesh::Point;
use cutwater::report::plane::outline;
use cutwater::solver::Setup;
use cutwater::solver::body::BodyState;

use super::view::{View, bounds, picture};
use crate::metrics::PLATE;

/// Longer side of a view in pixels.
const LONGEST: f64 = 600.0;
// Width of the part of a plate that is shown, divided by its height, and the stretch of its heights.
const PLATE_WINDOW: f64 = 25.0;
const PLATE_STRETCH: f64 = 5.0;
/// Levels between the smallest and the largest displacement.
const LEVELS: f64 = 24.0;
const OUTLINE: &str = "fill=\"none\" stroke=\"#282c34\" stroke-width=\"1.4\"";

/// Returns the figure of the deformable bodies, each with its own range of colours, one below the other.
pub(super) fn draw<const D: usize>(
    setup: &Setup<D>,
    states: &[BodyState<D>],
    indices: &[usize],
    time: f64,
    mirror: Option<f64>,
) -> String {
    let flat = |x: &Point<D>| [x[0], x[1]];
    let mut views = Vec::new();
    for &index in indices {
        let (body, state) = (setup.bodies[index].as_ref(), &states[index]);
        let Some(cells) = body.cells(state) else { continue };
        let positions = state.positions(body.reference());
        let (mut low, mut high) = bounds(positions.iter().map(flat), mirror);
        let height = high[1] - low[1];
        let is_plate = high[0] - low[0] > PLATE * height;
        let mut margins = [0.04 * height; 2];
        if is_plate {
            let middle = mirror.unwrap_or(0.5 * (low[0] + high[0]));
            (low[0], high[0]) = (middle - 0.5 * PLATE_WINDOW * height, middle + 0.5 * PLATE_WINDOW * height);
            margins = [0.0, 0.08 * height];
        }
        let stretch = if is_plate { PLATE_STRETCH } else { 1.0 };
        let corners = ([0, 1].map(|k| low[k] - margins[k]), [0, 1].map(|k| high[k] + margins[k]));
        let mut view = View::new(corners.0, corners.1, LONGEST, stretch, mirror);
        let vertical = || state.displacement().iter().map(|d| d[1]);
        let range = (vertical().fold(f64::INFINITY, f64::min), vertical().fold(f64::NEG_INFINITY, f64::max));
        let value = |k: usize| (flat(&positions[k]), state.displacement()[k][1]);
        let triangles: Vec<_> = cells.cells().map(|cell| [0, 1, 2].map(|k| value(cell[k].index()))).collect();
        view.isolines(&triangles, range, LEVELS, false);
        view.draw(OUTLINE, outline(body, &positions, mirror).into_iter());
        view.bar(range, &cgs("<length>"));
        let scale = if is_plate { ", middle, heights times 5" } else { "" };
        views.push((format!("{}: vertical displacement at t = {time:.4} s{scale}", body.name()), view));
    }
    picture(views)
}
