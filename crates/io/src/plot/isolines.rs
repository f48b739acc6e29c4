//! Isolines of the vertical displacement on the deformed bodies.

use mesh::{Point, SimplexMesh};
use plotters::prelude::*;
use solver::{BodyState, Setup};

use super::canvas::{Canvas, Drawn, INK, Picture, nice_step, viridis};
use super::flow::level_segment;
use super::view::{View, bounds, images, outline, plane};

/// Bodies this many times wider than high are plates: shown near the plane of symmetry only, and stretched.
pub(crate) const PLATE: f64 = 8.0;
/// Width of the part of a plate that is shown, over its height.
const PLATE_WINDOW: f64 = 25.0;
const PLATE_STRETCH: f64 = 5.0;
/// Longer side of a panel in units.
const LONGEST: f64 = 620.0;

/// Isolines of the vertical displacement of bodies, each with its own range of colours, one below the other.
pub(super) struct Isolines<'a, const D: usize> {
    panels: Vec<BodyPanel<'a, D>>,
    mirror: Option<f64>,
}

struct BodyPanel<'a, const D: usize> {
    mesh: &'a SimplexMesh<D>,
    positions: Vec<Point<D>>,
    displacement: Vec<f64>,
    outline: Vec<[[f64; 2]; 2]>,
    range: (f64, f64),
    view: View,
    title: String,
}

impl<'a, const D: usize> Isolines<'a, D> {
    /// The picture of the elastic ones of some bodies; `None` if there is none. `mirror` is the plane of symmetry of a
    /// half domain.
    pub(super) fn new(
        setup: &'a Setup<D>,
        bodies: &[BodyState<D>],
        indices: &[usize],
        time: f64,
        mirror: Option<f64>,
    ) -> Option<Self> {
        let mut panels: Vec<BodyPanel<'a, D>> = Vec::new();
        for &index in indices {
            let body = &setup.bodies[index];
            let Some(elastic) = body.elastic() else { continue };
            let positions = bodies[index].positions(body.reference());
            let displacement: Vec<f64> = bodies[index].displacement.iter().map(|d| d[1]).collect();
            let extent = |(a, b): (f64, f64), d: &f64| (a.min(*d), b.max(*d));
            let range = displacement.iter().fold((f64::INFINITY, f64::NEG_INFINITY), extent);
            let top = panels.last().map_or(0.0, |panel| panel.view.bottom());
            let (view, scale) = view_of(&positions, mirror);
            panels.push(BodyPanel {
                mesh: elastic.solid.mesh(),
                outline: outline(body, &positions, mirror).collect(),
                positions,
                displacement,
                range,
                view: view.below(top),
                title: format!("{}: vertical displacement at t = {time:.4} s{scale}", body.name),
            });
        }
        (!panels.is_empty()).then_some(Self { panels, mirror })
    }
}

/// What is shown of a body, and a word about it.
fn view_of<const D: usize>(positions: &[Point<D>], mirror: Option<f64>) -> (View, &'static str) {
    let (mut low, mut high) = bounds(positions, mirror);
    let height = high[1] - low[1];
    let margin = 0.04 * height;
    let is_plate = high[0] - low[0] > PLATE * height;
    if is_plate {
        let middle = mirror.unwrap_or(0.5 * (low[0] + high[0]));
        (low[0], high[0]) = (middle - 0.5 * PLATE_WINDOW * height, middle + 0.5 * PLATE_WINDOW * height);
        (low[1], high[1]) = (low[1] - 2.0 * margin, high[1] + 2.0 * margin);
        return (View::new(low, high, LONGEST).stretched(PLATE_STRETCH), ", middle, heights times 5");
    }
    (View::new(low.map(|x| x - margin), high.map(|x| x + margin), LONGEST), "")
}

impl<const D: usize> Picture for Isolines<'_, D> {
    fn size(&self) -> (u32, u32) {
        let width = self.panels.iter().map(|panel| panel.view.size().0).max().unwrap_or(1);
        let height = self.panels.last().map_or(1.0, |panel| panel.view.bottom());
        (width, height.ceil() as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        for panel in &self.panels {
            let (low, high) = panel.range;
            let colour = |value: f64| viridis((value - low) / (high - low));
            let step = nice_step(high - low, 24.0);
            let first = (low / step).ceil() as i64;
            for image in images(self.mirror) {
                for level in (first..).map(|k| k as f64 * step).take_while(|level| *level <= high) {
                    for cell in panel.mesh.cells() {
                        let corners = panel.mesh.cell(cell);
                        let at = |k: usize| corners[k].index();
                        let values = [0, 1, 2].map(|k| (plane(&panel.positions[at(k)]), panel.displacement[at(k)]));
                        if let Some(segment) = level_segment(values, level) {
                            let segment = segment.map(|x| image.of(x));
                            panel.view.segment(canvas, segment, colour(level).into(), 1.6)?;
                        }
                    }
                }
                for edge in &panel.outline {
                    panel.view.segment(canvas, edge.map(|x| image.of(x)), INK.into(), 1.4)?;
                }
            }
            panel.view.decorate(canvas, &panel.title, "[cm]", panel.range, &viridis)?;
        }
        Ok(())
    }
}
