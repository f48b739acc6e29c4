//! Steps that follow the gap between bodies.

use mesh::{BodyId, VertexId};

use crate::setup::Contact;
use crate::{Setup, State};

/// Smallest length of a step relative to the time at its start; shorter ones are lost in the round-off of the time.
const ROUND_OFF: f64 = 1e-12;

/// Returns the longest step from a state with [`Setup::approach`], infinite without it. It depends only on positions
/// and velocities of the bodies, so that a resumed run takes the same steps.
pub(crate) fn longest_step<const D: usize>(setup: &Setup<D>, state: &State<D>) -> f64 {
    let Some(approach) = setup.approach else { return f64::INFINITY };
    let positions = setup.positions(&state.bodies);
    let fastest = |id: BodyId| state.bodies[id.index()].largest_speed();
    let of_contact = |contact: &Contact<D>| {
        let master_speed = contact.master().map_or(0.0, fastest);
        let speed = fastest(contact.body()) + master_speed;
        let master = contact.master().map_or(&[][..], |id| &positions[id.index()]);
        let slave = contact.body().index();
        let speed_of = |node: VertexId| state.bodies[slave].velocity()[node.index()].norm();
        let surface = setup.bodies[slave].surface();
        let gap = contact.smallest_gap(surface, [&positions[slave], master], speed_of, master_speed)?;
        (speed > 0.0).then(|| approach.fraction * gap / speed)
    };
    let longest = setup.contacts.iter().filter_map(of_contact).fold(f64::INFINITY, f64::min);
    longest.max(approach.smallest).max(ROUND_OFF * state.time)
}
