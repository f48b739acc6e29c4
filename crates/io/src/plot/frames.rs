//! What an animation needs: outlines of the bodies and a coarse field of the speed, in few bytes.

use mesh::Point;
use serde::{Deserialize, Serialize};
use solver::{FluidState, Setup, StepView};

use super::flow::{FlowPoint, Lattice, flow_triangles};
use super::view::{bounds, outline};
use crate::files::base64;

/// Points of the speed field along the longer side of the background.
const RESOLUTION: f64 = 90.0;
/// Frames of a run, about.
const FRAMES: usize = 150;
/// Units of the outlines along the longer side of the background.
const UNITS: f64 = 30_000.0;
/// Speed that has the largest byte; the field of a frame is relative to it.
const LARGEST: u8 = 254;
/// The byte of points outside the fluid.
const OUTSIDE: u8 = 255;

/// The frames of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Lower left corner of the background.
    pub low: [f64; 2],
    /// Upper right corner of the background.
    pub high: [f64; 2],
    /// Position of the plane of symmetry, if only one half was computed.
    pub mirror: Option<f64>,
    /// Columns and rows of the speed field.
    pub n: [usize; 2],
    /// Length of a unit of the outlines.
    pub unit: f64,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// The frames.
    pub frames: Vec<Frame>,
}

/// A frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Time, s.
    pub time: f64,
    /// Smallest distance of the leading body, cm.
    pub distance: Option<f64>,
    /// Whether there is contact.
    pub touches: bool,
    /// Largest speed of the frame, cm/s: byte 254 of the field.
    pub largest: f64,
    /// Speed in bytes, row by row from below, 255 outside of the fluid; base64.
    pub speed: String,
    /// Outline of each body: pairs of 16-bit numbers, in units from the lower left corner; base64.
    pub outlines: Vec<String>,
}

impl Frames {
    /// No frames yet.
    pub(super) fn new<const D: usize>(setup: &Setup<D>, mirror: Option<f64>) -> Self {
        let (low, high) = bounds(setup.background.vertices(), None);
        let longer = (high[0] - low[0]).max(high[1] - low[1]);
        Self {
            n: Lattice::new(low, high, longer / RESOLUTION).n,
            unit: longer / UNITS,
            bodies: setup.bodies.iter().map(|body| body.name.clone()).collect(),
            frames: Vec::new(),
            low,
            high,
            mirror,
        }
    }

    /// Adds the state after a step if it is one of about 150 of the run.
    pub(super) fn watch<const D: usize>(&mut self, view: &StepView<'_, D>, n_steps: usize, distance: Option<f64>) {
        let every = n_steps.div_ceil(FRAMES).max(1);
        if !view.ends_step() || !view.state.step.is_multiple_of(every) && view.state.step != n_steps {
            return;
        }
        let touches = view.report.is_some_and(|r| r.contacts.iter().any(contact::ContactReport::is_active));
        let (largest, speed) = self.speed(view.setup, &view.state.fluid);
        let outlines = view.setup.bodies.iter().zip(&view.state.bodies).map(|(body, state)| {
            let positions: Vec<Point<D>> = state.positions(body.reference());
            self.packed(&closed(outline(body, &positions, self.mirror).collect()))
        });
        let outlines = outlines.collect();
        self.frames.push(Frame { time: view.state.time, distance, touches, largest, speed, outlines });
    }

    fn speed<const D: usize>(&self, setup: &Setup<D>, fluid: &FluidState<D>) -> (f64, String) {
        let triangles: Vec<[FlowPoint; 3]> = flow_triangles(&setup.background, fluid);
        let step = [0, 1].map(|k| (self.high[k] - self.low[k]) / self.n[k] as f64);
        let found = Lattice { low: self.low, step, n: self.n }.velocities(&triangles);
        let speeds = || found.iter().map(|u| u.map(|[a, b]| a.hypot(b)));
        let largest = speeds().flatten().fold(0.0, f64::max);
        let byte = |speed: f64| (speed / largest.max(1e-12) * f64::from(LARGEST)).round() as u8;
        let bytes: Vec<u8> = speeds().map(|speed| speed.map_or(OUTSIDE, byte)).collect();
        (largest, base64(&bytes))
    }

    fn packed(&self, points: &[[f64; 2]]) -> String {
        let units = |x: [f64; 2]| [0, 1].map(|k| ((x[k] - self.low[k]) / self.unit).round() as i16);
        base64(&points.iter().flat_map(|x| units(*x)).flat_map(i16::to_le_bytes).collect::<Vec<u8>>())
    }
}

/// Edges in the order in which they follow each other: the points of the outline.
fn closed(edges: Vec<[[f64; 2]; 2]>) -> Vec<[f64; 2]> {
    let key = |x: [f64; 2]| x.map(f64::to_bits);
    let mut next: std::collections::BTreeMap<[u64; 2], [f64; 2]> =
        edges.iter().map(|[from, to]| (key(*from), *to)).collect();
    // An open outline begins where no edge ends.
    let ends: std::collections::BTreeSet<[u64; 2]> = edges.iter().map(|[_, to]| key(*to)).collect();
    let first = edges.iter().map(|[from, _]| *from).find(|from| !ends.contains(&key(*from)));
    let Some(first) = first.or(edges.first().map(|[from, _]| *from)) else { return Vec::new() };
    let mut points = vec![first];
    let mut at = first;
    while let Some(to) = next.remove(&key(at)) {
        points.push(to);
        at = to;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges() -> Vec<[[f64; 2]; 2]> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        [2, 0, 3, 1].map(|k| [corners[k], corners[(k + 1) % 4]]).into()
    }

    #[test]
    fn edges_in_any_order_become_an_outline() {
        let points = closed(edges());
        assert_eq!((points.len(), points[0]), (5, points[4]));
        let open = closed(edges().into_iter().filter(|[from, _]| *from != [0.0, 1.0]).collect());
        assert_eq!(open, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    }
}
