//! The flow around the bodies: speed as colour, meshes as lines.

use mesh::Point;
use plotters::prelude::*;
use solver::{FluidState, Setup};

use super::canvas::{Canvas, Drawn, INK, Picture, water};
use super::view::{View, images, plane};
use crate::vtk::fluid::fluid_polygons;

const SOLID: [u8; 3] = [236, 170, 92];

/// Speed of the fluid on its true domain, with background mesh and bodies.
pub(super) struct Field<'a, const D: usize> {
    setup: &'a Setup<D>,
    fluid: &'a FluidState<D>,
    /// Corners and speeds of triangles.
    triangles: Vec<[([f64; 2], f64); 3]>,
    largest: f64,
    mirror: Option<f64>,
    view: View,
    title: String,
}

impl<'a, const D: usize> Field<'a, D> {
    /// The picture of a flow. `mirror` is the plane of symmetry of a half domain.
    pub(super) fn new(setup: &'a Setup<D>, fluid: &'a FluidState<D>, time: f64, mirror: Option<f64>) -> Self {
        let mut triangles = Vec::new();
        let mut speeds = Vec::new();
        for (part, polygon) in fluid_polygons(&setup.background, &fluid.cut) {
            let simplex = setup.background.simplex(fluid.cut.part_cell(part));
            let speed = |x: &Point<D>| {
                let shape = simplex.barycentric(x).unwrap_or_default();
                let dofs = fluid.space.dofs(part);
                let u: Point<D> = dofs.iter().zip(shape).map(|(&k, n)| fluid.velocity[k as usize] * n).sum();
                (plane(x), u.norm())
            };
            let corners: Vec<_> = polygon.iter().map(speed).collect();
            speeds.extend(corners.iter().map(|(_, s)| *s));
            triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
        }
        // The fastest half percent would leave no colours for the rest.
        speeds.sort_by(f64::total_cmp);
        let largest = speeds.get(speeds.len().saturating_sub(1) * 199 / 200).copied().unwrap_or(0.0).max(1e-12);
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for image in images(mirror) {
            for x in setup.background.vertices() {
                let x = image.of(plane(x));
                for k in 0..2 {
                    low[k] = low[k].min(x[k]);
                    high[k] = high[k].max(x[k]);
                }
            }
        }
        let view = View::new(low, high, 680.0);
        let title = format!("speed of the fluid at t = {time:.4} s");
        Self { setup, fluid, triangles, largest, mirror, view, title }
    }

    /// Corners of the triangles of all bodies.
    fn solids(&self) -> impl Iterator<Item = [[f64; 2]; 3]> {
        let bodies = self.setup.bodies.iter().zip(&self.fluid.positions);
        bodies.filter_map(|(body, x)| Some((body.elastic()?.solid.mesh(), x))).flat_map(|(mesh, x)| {
            mesh.cells().map(|cell| {
                let corners = mesh.cell(cell);
                [0, 1, 2].map(|k| plane(&x[corners[k].index()]))
            })
        })
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
                raster.fill(triangle.map(|(x, _)| place(x)), |l| {
                    let speed: f64 = triangle.iter().zip(l).map(|((_, s), l)| s * l).sum();
                    let RGBColor(r, g, b) = water(speed / self.largest);
                    [r, g, b]
                });
            }
            for triangle in self.solids() {
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
            for [a, b, c] in self.solids() {
                self.view.polyline(canvas, &[a, b, c].map(|x| image.of(x)), INK.mix(0.16), 0.5)?;
            }
            for (body, x) in self.setup.bodies.iter().zip(&self.fluid.positions) {
                let boundary = body.boundary();
                for facet in boundary.facets() {
                    let ends = boundary.facet(facet);
                    let ends = [0, 1].map(|k| plane(&x[ends[k].index()]));
                    let inside = |x: [f64; 2]| self.mirror.is_some_and(|plane| (x[0] - plane).abs() < 1e-9);
                    if !ends.iter().all(|x| inside(*x)) {
                        self.view.polyline(canvas, &ends.map(|x| image.of(x)), INK.into(), 1.2)?;
                    }
                }
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
