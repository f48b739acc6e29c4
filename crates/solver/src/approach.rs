//! Steps that follow the gap between bodies.

use contact::Positions;
use mesh::BodyId;

use crate::setup::Contact;
use crate::{Setup, State};

/// Returns the longest step from a state with [`Setup::approach`], infinite without it. It depends only on positions
/// and velocities of the bodies, so that a resumed run takes the same steps.
pub(crate) fn longest_step<const D: usize>(setup: &Setup<D>, state: &State<D>) -> f64 {
    let Some(approach) = setup.approach else { return f64::INFINITY };
    let positions = setup.positions(&state.bodies);
    let fastest = |id: BodyId| state.bodies[id.index()].largest_speed();
    let of_contact = |contact: &Contact<D>| {
        let speed = fastest(contact.body()) + contact.master().map_or(0.0, fastest);
        let master = contact.master().map_or(&[][..], |id| &positions[id.index()]);
        let gap = contact.obstacle().smallest_gap(&positions[contact.body().index()], Positions::Fixed(master))?;
        (speed > 0.0).then(|| approach.fraction * gap / speed)
    };
    let longest = setup.contacts.iter().filter_map(of_contact).fold(f64::INFINITY, f64::min);
    longest.max(approach.smallest)
}
