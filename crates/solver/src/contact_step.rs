//! A contact in one step: search of obstacles, and the check that no contact was missed.

use std::collections::BTreeSet;
use std::sync::Arc;

use algebra::BlockLayout;
use body::{BodyStep, StepTime, SurfaceMotion, SurfaceStress};
use contact::{ContactItems, ContactPair, ContactSites, StressSource};
use interface_dg::{ClosedPoints, FluidStress, StressJump};
use mesh::{BodyId, Point, Vector, VertexId};

use crate::State;
use crate::fluid_step::FluidStep;
use crate::setup::Contact;

/// References to what the evaluation of contacts uses of a step: layout, fluid, bodies and time.
#[derive(Clone, Copy)]
pub(crate) struct StepRefs<'p, const D: usize> {
    pub(crate) layout: &'p BlockLayout,
    pub(crate) fluid: Option<&'p FluidStep<'p, D>>,
    pub(crate) bodies: &'p [Box<dyn BodyStep<D> + 'p>],
    pub(crate) time: &'p StepTime,
}

impl<'p, const D: usize> StepRefs<'p, D> {
    /// Returns the stress of the fluid on a body; `None` without a fluid.
    fn fluid_stress(&self, body: BodyId) -> Option<Arc<FluidStress<'p, D>>> {
        let fluid = self.fluid?;
        let (force, time) = (&fluid.setup.body_force, self.time.stage());
        let body_force = |x: &Point<D>| force.as_ref().map_or_else(Vector::zeros, |force| force(x, time));
        Some(Arc::new(FluidStress::new(fluid.interface(self.layout, self.bodies), body, body_force)))
    }

    /// Returns the parts of surfaces that border no fluid, of all bodies in contacts with [`StressSource::Jump`].
    pub(crate) fn closed(&self, contacts: &[Contact<D>]) -> Vec<(BodyId, ClosedPoints<'p, D>)> {
        let of_jump = contacts.iter().filter(|contact| contact.form().law.stress() == StressSource::Jump);
        let bodies: BTreeSet<BodyId> = of_jump.flat_map(|c| [Some(c.body()), c.master()]).flatten().collect();
        bodies.into_iter().filter_map(|body| Some((body, ClosedPoints::new(self.fluid_stress(body)?)))).collect()
    }
}

/// A contact in one step, without borrowed data; [`ContactStep::sites`] combines it with the bodies.
pub(crate) struct ContactStep<const D: usize> {
    items: ContactItems<D>,
    /// Distance within which obstacles were searched.
    pub(crate) reach: f64,
}

/// Returns whether a law with this source depends on the stress of a body or the fluid.
fn needs_stress(source: StressSource) -> bool {
    !matches!(source, StressSource::None | StressSource::Multiplier)
}

/// Returns the pair of slave and obstacle of a contact in a step.
fn pair<'p, const D: usize>(contact: &'p Contact<D>, refs: StepRefs<'p, D>) -> ContactPair<'p, D> {
    let surface = |id: BodyId| refs.bodies[id.index()].surface();
    let source = contact.form().law.stress();
    let body = &refs.bodies[contact.body().index()];
    let solid = || body.stress(refs.layout, &body.surface().start).map(Arc::from);
    let fluid =
        (source == StressSource::Fluid || source == StressSource::Jump).then(|| refs.fluid_stress(contact.body()));
    let fluid = fluid.flatten();
    let stress: Option<Arc<dyn SurfaceStress<D> + 'p>> = match (source, &fluid) {
        (StressSource::None | StressSource::Multiplier, _) => None,
        (StressSource::Fluid, fluid) => fluid.clone().map(|fluid| fluid as _),
        (StressSource::Jump, Some(fluid)) => {
            solid().map(|solid| Arc::new(StressJump { solid, fluid: Arc::clone(fluid) }) as _)
        }
        (StressSource::Solid | StressSource::Jump, _) => solid(),
    };
    let is_own = contact.master() == Some(contact.body());
    ContactPair {
        form: contact.form(),
        slave: surface(contact.body()),
        facets: contact.facets(),
        obstacle: contact.obstacle(),
        master: contact.master().map(surface),
        stress,
        // A law with stress is integrated over both surfaces of a body in contact with itself, each with half of the
        // traction.
        share: if is_own && needs_stress(source) { 0.5 } else { 1.0 },
        conserves: refs.time.weights.conserves,
    }
}

impl<const D: usize> ContactStep<D> {
    /// Searches for obstacles within the offset of the law, plus twice the contact size, plus twice the largest speeds
    /// of slave and master at the start times the length of the step. Returns `None` if the law depends on a stress
    /// that the setup does not have.
    pub(crate) fn new(contact: &Contact<D>, previous: &State<D>, refs: StepRefs<'_, D>) -> Option<Self> {
        let (pair, source) = (pair(contact, refs), contact.form().law.stress());
        if needs_stress(source) && pair.stress.is_none() {
            return None;
        }
        let motion = |id: BodyId| previous.bodies[id.index()].largest_speed() * refs.time.length;
        let motion = motion(contact.body()) + contact.master().map_or(0.0, motion);
        let reach = contact.form().law.offset() + 2.0 * motion + 2.0 * contact.form().size();
        let mut items = ContactItems::new(&pair, refs.layout, reach);
        if source == StressSource::Multiplier && !refs.time.weights.has_inertia() {
            // Bodies at rest have the offset as their distance up to the tolerance, and nothing else may hold them.
            items.begin_with(contact.form().law.accepted_change(f64::INFINITY));
        }
        Some(Self { items, reach })
    }

    /// Returns the quadrature points of the contact.
    pub(crate) fn sites<'p>(&'p self, contact: &'p Contact<D>, refs: StepRefs<'p, D>) -> ContactSites<'p, D> {
        ContactSites { items: &self.items, pair: pair(contact, refs), layout: refs.layout }
    }

    /// Returns the components of the multipliers of all points.
    pub(crate) fn multipliers(&self) -> Vec<f64> {
        self.items.multipliers()
    }

    /// Sets the multipliers of the next solve to the first components of a list, and removes these from it.
    pub(crate) fn set_multipliers(&mut self, components: &mut &[f64]) {
        self.items.set_multipliers(components);
    }

    /// Returns the sum of the largest motions of slave and master in the step, and the motion for which obstacles were
    /// searched, if the first is larger and the bodies may have touched. Returns `None` otherwise.
    pub(crate) fn missed(&self, contact: &Contact<D>, refs: StepRefs<'_, D>, x: &[f64]) -> Option<[f64; 2]> {
        if !self.items.is_searched() {
            return None;
        }
        let surface = |id: BodyId| refs.bodies[id.index()].surface();
        let (slave, master) = (surface(contact.body()), contact.master().map(surface));
        let speed_of = |surface: &SurfaceMotion<'_, D>, node| surface.velocity_at(node, refs.layout, x).norm();
        let fastest = |surface: &SurfaceMotion<'_, D>| {
            let nodes = (0..surface.start.len()).map(VertexId::new);
            nodes.map(|node| speed_of(surface, node)).fold(0.0, f64::max)
        };
        let master_speed = master.map_or(0.0, fastest);
        let motion = fastest(slave) * refs.time.length + master_speed * refs.time.length;
        let offset = contact.form().law.offset();
        let room = self.reach - offset;
        if motion <= room {
            return None;
        }
        let starts = [&slave.start[..], master.map_or(&[][..], |master| &master.start)];
        // The gap of a body to itself is not known (`None`). It is taken as zero, so that the contact counts as missed.
        let apart = contact.smallest_gap(slave.boundary, starts, |node| speed_of(slave, node), master_speed);
        (apart.unwrap_or(0.0) <= motion + offset).then_some([motion, room])
    }
}
