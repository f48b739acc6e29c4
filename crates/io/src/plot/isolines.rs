//! Isolines of the vertical displacement on the deformed bodies.

use mesh::{Point, SimplexMesh};
use plotters::prelude::*;
use solver::{BodyState, Setup};

use super::canvas::{Canvas, Drawn, INK, Picture, nice_step, viridis};
use super::view::{View, images, plane};

/// Isolines of the vertical displacement of one body.
pub(super) struct Isolines<'a, const D: usize> {
    mesh: &'a SimplexMesh<D>,
    positions: Vec<Point<D>>,
    displacement: Vec<f64>,
    outline: Vec<[[f64; 2]; 2]>,
    range: (f64, f64),
    mirror: Option<f64>,
    view: View,
    title: String,
}

impl<'a, const D: usize> Isolines<'a, D> {
    /// The picture of body `index`; `None` if it is not elastic. `mirror` is the plane of symmetry of a half domain.
    pub(super) fn new(
        setup: &'a Setup<D>,
        bodies: &[BodyState<D>],
        index: usize,
        time: f64,
        mirror: Option<f64>,
    ) -> Option<Self> {
        let body = &setup.bodies[index];
        let mesh = body.elastic()?.solid.mesh();
        let positions = bodies[index].positions(body.reference());
        let displacement: Vec<f64> = bodies[index].displacement.iter().map(|d| d[1]).collect();
        let range = displacement.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
        let boundary = body.boundary();
        let on_plane = |x: [f64; 2]| mirror.is_some_and(|plane| (x[0] - plane).abs() < 1e-9);
        let outline = boundary
            .facets()
            .map(|f| boundary.facet(f))
            .map(|f| [plane(&positions[f[0].index()]), plane(&positions[f[1].index()])])
            .filter(|[a, b]| !(on_plane(*a) && on_plane(*b)))
            .collect();
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for image in images(mirror) {
            for x in &positions {
                let x = image.of(plane(x));
                for k in 0..2 {
                    low[k] = low[k].min(x[k]);
                    high[k] = high[k].max(x[k]);
                }
            }
        }
        let margin = 0.04 * (high[1] - low[1]);
        let view = View::new(low.map(|x| x - margin), high.map(|x| x + margin), 620.0);
        let title = format!("{}: vertical displacement at t = {time:.4} s", body.name);
        Some(Self { mesh, positions, displacement, outline, range, mirror, view, title })
    }

    /// The segment of a level in a triangle.
    fn segment(&self, corners: &[usize], level: f64) -> Option<[[f64; 2]; 2]> {
        let mut ends = Vec::with_capacity(2);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (corners[i], corners[j]);
            let (va, vb) = (self.displacement[a] - level, self.displacement[b] - level);
            if (va < 0.0) != (vb < 0.0) {
                ends.push(plane(&(self.positions[a] + (self.positions[b] - self.positions[a]) * (va / (va - vb)))));
            }
        }
        <[[f64; 2]; 2]>::try_from(ends).ok()
    }
}

impl<const D: usize> Picture for Isolines<'_, D> {
    fn size(&self) -> (u32, u32) {
        self.view.size()
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let (low, high) = self.range;
        let colour = |value: f64| viridis((value - low) / (high - low));
        let step = nice_step(high - low, 24.0);
        let first = (low / step).ceil() as i64;
        for image in images(self.mirror) {
            for level in (first..).map(|k| k as f64 * step).take_while(|level| *level <= high) {
                for cell in self.mesh.cells() {
                    let corners: Vec<usize> = self.mesh.cell(cell).iter().map(|v| v.index()).collect();
                    if let Some(segment) = self.segment(&corners, level) {
                        self.view.polyline(canvas, &segment.map(|x| image.of(x)), colour(level).into(), 1.6)?;
                    }
                }
            }
            for edge in &self.outline {
                self.view.polyline(canvas, &edge.map(|x| image.of(x)), INK.into(), 1.4)?;
            }
        }
        self.view.decorate(canvas, &self.title, "[cm]", self.range, &viridis)
    }
}
