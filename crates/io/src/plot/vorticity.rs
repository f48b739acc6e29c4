//! Isolines of the vorticity with velocity vectors, on the whole domain and near the lowest point of a body.

use mesh::Point;
use plotters::prelude::*;
use solver::{FluidState, Setup};

use super::canvas::{Canvas, Drawn, INK, Picture, nice_step, turning};
use super::flow::{FlowPoint, Lattice, flow_triangles, level_segment, quantile};
use super::view::{View, bounds, images, outlines, plane, solid_triangles};

/// Bodies are filled with it.
const SOLID: RGBColor = RGBColor(226, 228, 232);
/// Longer side of a panel in units.
const LONGEST: f64 = 680.0;
/// Distance between vectors and length of the longest one, in units.
const SPACING: f64 = 25.0;
const LONGEST_VECTOR: f64 = 33.0;
/// Levels on either side of zero.
const LEVELS: f64 = 10.0;
/// Width of the lower panel over that of the body, and its height over its width.
const ZOOM: f64 = 0.6;
const ZOOM_ASPECT: f64 = 0.55;

/// The picture of a flow.
pub(super) struct Vorticity<'a, const D: usize> {
    setup: &'a Setup<D>,
    positions: &'a [Vec<Point<D>>],
    triangles: Vec<[FlowPoint; 3]>,
    panels: Vec<FlowPanel>,
    mirror: Option<f64>,
}

struct FlowPanel {
    view: View,
    /// The largest value that has a colour of its own.
    largest: f64,
    /// Begins and ends.
    vectors: Vec<[[f64; 2]; 2]>,
    title: String,
}

impl<'a, const D: usize> Vorticity<'a, D> {
    /// The picture of a flow; the lower panel shows the surroundings of the lowest point of body `leading`. `mirror` is
    /// the plane of symmetry of a half domain.
    pub(super) fn new(
        setup: &'a Setup<D>,
        fluid: &'a FluidState<D>,
        leading: Option<usize>,
        time: f64,
        mirror: Option<f64>,
    ) -> Self {
        let triangles = flow_triangles(&setup.background, fluid);
        let (low, high) = bounds(setup.background.vertices(), mirror);
        let whole = View::new(low, high, LONGEST);
        let title = format!("vorticity and velocity at t = {time:.4} s");
        let mut panels = vec![FlowPanel::new(whole, title, &triangles, mirror)];
        if let Some(x) = leading.map(|body| &fluid.positions[body]) {
            let (body_low, body_high) = bounds(x, mirror);
            let lowest = x.iter().map(plane).fold([0.0, f64::INFINITY], |a, x| if x[1] < a[1] { x } else { a });
            let width = ZOOM * (body_high[0] - body_low[0]);
            let height = ZOOM_ASPECT * width;
            let bottom = low[1].max(body_low[1] - 0.4 * height);
            let corners = ([lowest[0] - 0.5 * width, bottom], [lowest[0] + 0.5 * width, bottom + height]);
            let view = View::new(corners.0, corners.1, LONGEST).below(panels[0].view.bottom());
            panels.push(FlowPanel::new(view, "near the lowest point".to_owned(), &triangles, mirror));
        }
        Self { setup, positions: &fluid.positions, triangles, panels, mirror }
    }
}

impl FlowPanel {
    fn new(view: View, mut title: String, triangles: &[[FlowPoint; 3]], mirror: Option<f64>) -> Self {
        let (low, high) = view.corners();
        let is_seen = |x: [f64; 2]| (0..2).all(|k| low[k] <= x[k] && x[k] <= high[k]);
        let seen = || triangles.iter().flatten().filter(|corner| is_seen(corner.x));
        let mut vorticities: Vec<f64> = seen().map(|corner| corner.vorticity.abs()).collect();
        let lattice = Lattice::new(low, high, view.length(SPACING));
        let (columns, rows) = (lattice.n[0], lattice.n[1]);
        let mut arrows: Vec<([f64; 2], [f64; 2])> = Vec::new();
        for image in images(mirror) {
            let mirrored: Vec<[FlowPoint; 3]> = triangles
                .iter()
                .map(|triangle| triangle.map(|c| FlowPoint { x: image.of(c.x), velocity: image.turn(c.velocity), ..c }))
                .collect();
            let found = lattice.velocities(&mirrored);
            let points = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
            arrows.extend(points.zip(found).filter_map(|((c, r), u)| Some((lattice.point(c, r), u?))));
        }
        let longest = arrows.iter().map(|(_, u)| u[0].hypot(u[1])).fold(0.0, f64::max);
        title += &format!("; longest vector {longest:.1} cm/s");
        let scale = view.length(LONGEST_VECTOR) / longest.max(1e-12);
        let vectors = arrows.iter().map(|(x, u)| [*x, [x[0] + scale * u[0], x[1] + scale * u[1]]]).collect();
        Self { largest: quantile(&mut vorticities, 0.98), view, vectors, title }
    }
}

impl<const D: usize> Picture for Vorticity<'_, D> {
    fn size(&self) -> (u32, u32) {
        let width = self.panels.iter().map(|panel| panel.view.size().0).max().unwrap_or(1);
        (width, self.panels.last().map_or(1.0, |panel| panel.view.bottom()).ceil() as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        for FlowPanel { view, largest, vectors, title } in &self.panels {
            let colour = |t: f64| turning(t);
            let step = nice_step(*largest, LEVELS);
            let last = (largest / step).floor() as i64;
            for image in images(self.mirror) {
                for triangle in solid_triangles(self.setup, self.positions) {
                    view.triangle(canvas, triangle.map(|x| image.of(x)), SOLID)?;
                }
                for level in (-last..=last).filter(|k| *k != 0).map(|k| k as f64 * step) {
                    let colour = colour(0.5 + 0.5 * level / largest);
                    for triangle in &self.triangles {
                        let values = triangle.map(|c| (image.of(c.x), image.sign() * c.vorticity));
                        if let Some(segment) = level_segment(values, level) {
                            view.segment(canvas, segment, colour.into(), 1.2)?;
                        }
                    }
                }
                for edge in outlines(self.setup, self.positions, self.mirror) {
                    view.segment(canvas, edge.map(|x| image.of(x)), INK.into(), 1.2)?;
                }
            }
            for &[from, to] in vectors {
                let [x, y] = [to[0] - from[0], to[1] - from[1]];
                if x.hypot(y) < view.length(1.5) {
                    continue;
                }
                let head = |turn: f64| [to[0] - 0.3 * x - turn * y, to[1] - 0.3 * y + turn * x];
                for segment in [[from, to], [to, head(0.16)], [to, head(-0.16)]] {
                    view.segment(canvas, segment, INK.mix(0.75), 0.8)?;
                }
            }
            view.decorate(canvas, title, "[1/s]", (-largest, *largest), &colour)?;
        }
        Ok(())
    }
}
