//! Moments of a run that are worth a picture, kept until its end.

use solver::{BodyState, FluidState, StepView};

/// The problem at a moment.
#[derive(Clone, Debug)]
pub struct Moment<const D: usize> {
    /// Time, s.
    pub time: f64,
    /// The flow.
    pub fluid: FluidState<D>,
    /// The bodies.
    pub bodies: Vec<BodyState<D>>,
}

/// Moments that are worth a picture.
#[derive(Clone, Debug, Default)]
pub struct Moments<const D: usize> {
    /// The first contact, or the end if there is none.
    pub contact: Option<Moment<D>>,
    /// The first contact after a rebound: after at least half as long without contact as the first contact lasted.
    pub second_contact: Option<Moment<D>>,
    /// Time and bodies at the largest violation of an offset, or at the end if there is none.
    pub deepest: Option<(f64, Vec<BodyState<D>>)>,
    depth: f64,
    first: Option<f64>,
    /// When the last contact ended, and how long the first one lasted.
    release: Option<(f64, f64)>,
    touches: bool,
}

impl<const D: usize> Moments<D> {
    /// Looks at a step, and keeps it if it is worth it.
    pub fn watch(&mut self, view: &StepView<'_, D>, is_last: bool) {
        let Some(report) = view.report else { return };
        let time = view.state.time;
        let moment = || Moment { time, fluid: view.state.fluid.clone(), bodies: view.state.bodies.clone() };
        let depth = report.contacts.iter().map(|contact| contact.largest_penetration).fold(0.0, f64::max);
        let touches = report.contacts.iter().any(contact::ContactReport::is_active);
        if self.first.is_none() && (touches || is_last) {
            self.contact = Some(moment());
        }
        if depth > self.depth || (is_last && self.depth == 0.0) {
            self.deepest = Some((time, view.state.bodies.clone()));
        }
        match (self.touches, touches) {
            (false, true) => {
                let first = *self.first.get_or_insert(time);
                let is_second = self.release.is_some_and(|(end, lasted)| time - end >= 0.5 * lasted && time > first);
                if is_second && self.second_contact.is_none() {
                    self.second_contact = Some(moment());
                }
            }
            (true, false) => {
                let lasted = self.release.map_or(time - self.first.unwrap_or(time), |(_, lasted)| lasted);
                self.release = Some((time, lasted));
            }
            _ => {}
        }
        self.depth = self.depth.max(depth);
        self.touches = touches;
    }
}
