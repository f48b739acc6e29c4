//! Steps that follow the gap between bodies.

use contact::Positions;
use mesh::{BodyId, Vector};

use crate::setup::{ApproachSteps, Contact};
use crate::{Setup, State};

impl ApproachSteps {
    /// Returns the longest step from a state. It is a function of positions and velocities of the bodies, so that a run that is resumed takes the same
    /// steps.
    pub(crate) fn longest<const D: usize>(&self, setup: &Setup<D>, state: &State<D>) -> f64 {
        let positions = setup.positions(&state.bodies);
        let fastest = |id: BodyId| {
            let velocity = state.bodies[id.index()].velocity();
            velocity.iter().map(Vector::norm).fold(0.0, f64::max)
        };
        let of_contact = |contact: &Contact<D>| {
            let speed = fastest(contact.body()) + contact.master().map_or(0.0, fastest);
            let master = contact.master().map_or(&[][..], |id| &positions[id.index()]);
            let gap = contact.geometry().smallest_gap(&positions[contact.body().index()], Positions::Fixed(master))?;
            (speed > 0.0).then(|| self.fraction * gap / speed)
        };
        let longest = setup.contacts.iter().filter_map(of_contact).fold(f64::INFINITY, f64::min);
        longest.max(self.smallest)
    }
}
