//! The flow around the bodies: speed as colour, meshes as lines.

use plotters::prelude::*;
use solver::{FluidState, Setup};

use super::canvas::{Canvas, Drawn, INK, Picture, water};
use super::flow::{FlowPoint, flow_triangles, quantile};
use super::view::{View, bounds, images, outlines, plane, solid_triangles};

const SOLID: [u8; 3] = [236, 170, 92];

/// Speed of the fluid on its true domain, with background mesh and bodies.
pub(super) struct Field<'a, const D: usize> {
    setup: &'a Setup<D>,
    fluid: &'a FluidState<D>,
    triangles: Vec<[FlowPoint; 3]>,
    largest: f64,
    mirror: Option<f64>,
    view: View,
    title: String,
}

impl<'a, const D: usize> Field<'a, D> {
    /// The picture of a flow. `mirror` is the plane of symmetry of a half domain.
    pub(super) fn new(setup: &'a Setup<D>, fluid: &'a FluidState<D>, time: f64, mirror: Option<f64>) -> Self {
        let triangles = flow_triangles(&setup.background, fluid);
        // The fastest half percent would leave no colours for the rest.
        let mut speeds: Vec<f64> = triangles.iter().flatten().map(FlowPoint::speed).collect();
        let largest = quantile(&mut speeds, 0.995);
        let (low, high) = bounds(setup.background.vertices(), mirror);
        let view = View::new(low, high, 680.0);
        let title = format!("speed of the fluid at t = {time:.4} s");
        Self { setup, fluid, triangles, largest, mirror, view, title }
    }
}

impl<const D: usize> Picture for Field<'_, D> {
    fn size(&self) -> (u32, u32) {
        self.view.size()
    }

    fn paint(&self, pixels: &mut [u8], unit: f64) {
        pixels.fill(255);
        let width = (f64::from(self.size().0) * unit) as usize;
        let mut raster = Raster { pixels, width };
        for image in images(self.mirror) {
            let place = |x: [f64; 2]| self.view.place(image.of(x)).map(|c| c * unit);
            for triangle in &self.triangles {
                raster.fill(triangle.map(|corner| place(corner.x)), |l| {
                    let speed: f64 = triangle.iter().zip(l).map(|(corner, l)| corner.speed() * l).sum();
                    let RGBColor(r, g, b) = water(speed / self.largest);
                    [r, g, b]
                });
            }
            for triangle in solid_triangles(self.setup, &self.fluid.positions) {
                raster.fill(triangle.map(place), |_| SOLID);
            }
        }
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let background = &self.setup.background;
        for image in images(self.mirror) {
            for facet in background.facets() {
                let ends = background.facet(facet);
                let ends = [0, 1].map(|k| image.of(plane(&background.vertex(ends[k]))));
                let is_fluid = background
                    .facet_to_cell(facet)
                    .iter()
                    .flatten()
                    .any(|c| self.fluid.cut.cell_state(*c) == cutcell::CellState::Fluid);
                let on_plane = self.mirror.is_some_and(|plane| ends.iter().all(|x| (x[0] - plane).abs() < 1e-9));
                if is_fluid && !on_plane {
                    self.view.polyline(canvas, &ends, INK.mix(0.16), 0.5)?;
                }
            }
            for [a, b, c] in solid_triangles(self.setup, &self.fluid.positions) {
                self.view.polyline(canvas, &[a, b, c].map(|x| image.of(x)), INK.mix(0.16), 0.5)?;
            }
            for edge in outlines(self.setup, &self.fluid.positions, self.mirror) {
                self.view.polyline(canvas, &edge.map(|x| image.of(x)), INK.into(), 1.2)?;
            }
        }
        self.view.decorate(canvas, &self.title, "[cm/s]", (0.0, self.largest), &water)
    }
}

/// Pixels to be filled with triangles.
struct Raster<'a> {
    pixels: &'a mut [u8],
    width: usize,
}

impl Raster<'_> {
    /// Fills the pixels whose centres lie in a triangle; `colour` gets barycentric coordinates.
    fn fill(&mut self, corners: [[f64; 2]; 3], colour: impl Fn([f64; 3]) -> [u8; 3]) {
        let [a, b, c] = corners;
        let cross =
            |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let area = cross(a, b, c);
        if area == 0.0 {
            return;
        }
        let height = self.pixels.len() / 3 / self.width;
        let range = |k: usize, n: usize| {
            let low = corners.iter().map(|x| x[k]).fold(f64::INFINITY, f64::min) - 0.5;
            let high = corners.iter().map(|x| x[k]).fold(f64::NEG_INFINITY, f64::max) + 0.5;
            (low.max(0.0) as usize)..(high.max(0.0) as usize + 1).min(n)
        };
        // A hair of overlap leaves no gaps between neighbours.
        let hair = -1e-9;
        for y in range(1, height) {
            for x in range(0, self.width) {
                let at = [x as f64 + 0.5, y as f64 + 0.5];
                let l = [cross(at, b, c) / area, cross(at, c, a) / area, cross(at, a, b) / area];
                if l.iter().all(|l| *l >= hair) {
                    self.pixels[3 * (y * self.width + x)..][..3].copy_from_slice(&colour(l));
                }
            }
        }
    }
}
