//! The step: geometry, spaces and constraints, constant during Newton's method.

use std::sync::Arc;
use std::time::Instant;

use algebra::time::Row;
use algebra::{BlockLayout, Constraints, NewtonReport};
use body::{BodyState, BodyStep, StepTime};
use interface_dg::{InterfacePoints, Pocket, SolidShare, UnstableShare, pockets, unstable_share};

use crate::collision::Collision;
use crate::contact_step::{ContactStep, StepRefs};
use crate::fluid_step::FluidStep;
use crate::passage::passage;
use crate::{Contact, Error, Setup, State, StepSeconds};

/// Portion of a step of the setup that one call of [`crate::advance`] takes: all of it, or a substep of a divided one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substep {
    /// Length, a time.
    pub dt: f64,
    /// Whether a whole step ends with it.
    pub is_last: bool,
}

impl Substep {
    /// Creates a whole step.
    pub fn whole(dt: f64) -> Self {
        Self { dt, is_last: true }
    }
}

/// One step: fluid, bodies and contacts with their unknowns, on the geometry at its start, or extrapolated to its stage
/// (generalised-α).
pub struct Step<'a, const D: usize> {
    pub(crate) setup: &'a Setup<D>,
    pub(crate) previous: &'a State<D>,
    pub(crate) time: StepTime,
    /// The unknowns: velocity and pressure of the fluid, then those of each body.
    pub layout: BlockLayout,
    pub(crate) fluid: Option<FluidStep<'a, D>>,
    pub(crate) bodies: Vec<Box<dyn BodyStep<D> + 'a>>,
    pub(crate) contacts: Vec<ContactStep<D>>,
    /// Collisions, one entry per contact.
    pub(crate) collisions: Vec<Option<Collision<D>>>,
    pub(crate) constraints: Constraints,
    pub(crate) pockets: Vec<Pocket>,
    pub(crate) seconds: StepSeconds,
}

impl<'a, const D: usize> Step<'a, D> {
    /// Prepares the step after `previous`.
    ///
    /// # Errors
    /// [`Error::Lists`]: the state belongs to another setup.
    /// [`Error::LeftDomain`], [`Error::Cut`] and [`Error::Interface`]: the bodies do not cut the background.
    /// [`Error::Extension`]: the velocity is not extended to uncovered fluid.
    /// [`Error::MissingStress`]: a contact law depends on a stress that the setup does not have.
    /// [`Error::UnstableShare`]: the penalty is too small for the share of the solid in the traction.
    pub fn prepare(setup: &'a Setup<D>, previous: &'a State<D>, time: StepTime) -> Result<Self, Error> {
        let clock = Instant::now();
        previous.check(setup)?;
        let mut layout = BlockLayout::new();
        let fluid = FluidStep::new(setup, previous, &time, &mut layout)?;
        let of_fluid = |fluid: &FluidStep<'_, D>| StepSeconds {
            cut: fluid.seconds_cut,
            transfer: fluid.seconds_transfer,
            ..StepSeconds::default()
        };
        let seconds = fluid.as_ref().map_or_else(StepSeconds::default, of_fluid);
        let begun = setup.bodies.iter().zip(&previous.bodies);
        let bodies: Vec<_> = begun.map(|(body, state)| body.step(state, &time, &mut layout)).collect();
        let mut step = Self {
            setup,
            previous,
            time,
            layout,
            fluid,
            bodies,
            contacts: Vec::new(),
            collisions: Vec::new(),
            constraints: Constraints::new(),
            pockets: Vec::new(),
            seconds,
        };
        let searched = Instant::now();
        let contact = |contact: &Contact<D>| {
            let name = || setup.bodies[contact.body().index()].name().to_owned();
            let missing = || Error::MissingStress { stress: contact.form().law.stress(), body: name() };
            ContactStep::new(contact, previous, step.refs()).ok_or_else(missing)
        };
        step.contacts = setup.contacts.iter().map(contact).collect::<Result<_, _>>()?;
        step.seconds.search = searched.elapsed().as_secs_f64();
        step.constrain();
        step.collisions = step.collisions();
        step.adapt_to_collision();
        step.check_share()?;
        step.seconds.space = clock.elapsed().as_secs_f64() - step.seconds.cut;
        Ok(step)
    }

    /// Returns the interface with the share of the solid in its traction.
    pub(crate) fn interface(&self) -> Option<InterfacePoints<'_, D>> {
        let fluid = self.fluid.as_ref()?;
        let (layout, alpha) = (&self.layout, fluid.setup.alpha);
        let solid = (alpha < 1.0).then(|| SolidShare {
            alpha,
            stresses: self
                .bodies
                .iter()
                .map(|body| body.stress(layout, &body.surface().geometry).map(Arc::from))
                .collect(),
            start: self.guess().into(),
        });
        Some(InterfacePoints { solid, ..fluid.interface(layout, &self.bodies) })
    }

    /// Returns an error if the penalty is too small for the share of the solid.
    fn check_share(&self) -> Result<(), Error> {
        let Some((fluid, points)) = self.fluid.as_ref().zip(self.interface()) else { return Ok(()) };
        match unstable_share(&points, &fluid.mortar.penalty) {
            Some(UnstableShare { body, penalty, required }) => Err(Error::UnstableShare {
                alpha: fluid.setup.alpha,
                body: self.setup.bodies[body.index()].name().to_owned(),
                penalty,
                required,
            }),
            None => Ok(()),
        }
    }

    /// Returns references to the fields of the step for the evaluation of contacts.
    pub(crate) fn refs(&self) -> StepRefs<'_, D> {
        let (layout, bodies) = (&self.layout, &self.bodies[..]);
        StepRefs { layout, fluid: self.fluid.as_ref(), bodies, time: &self.time }
    }

    /// Returns whether velocities jump in the step.
    pub(crate) fn has_collision(&self) -> bool {
        self.collisions.iter().any(Option::is_some)
    }

    /// Returns the collision of each contact, for the velocities at the start; `None` for all if nothing approaches.
    fn collisions(&self) -> Vec<Option<Collision<D>>> {
        if self.setup.contacts.iter().all(|contact| contact.form().law.restitution().is_none()) {
            return vec![None; self.setup.contacts.len()];
        }
        let mut x = self.guess();
        self.constraints.apply_ties(&mut x);
        let collision =
            |contact| Collision::new(contact, self.setup, self.previous, self.refs(), &self.constraints, &x);
        let found: Vec<_> = self.setup.contacts.iter().map(collision).collect();
        // If any contact collides, contacts at which nothing approaches take part in the collision.
        let approaches = found.iter().flatten().any(Collision::approaches);
        if approaches { found } else { vec![None; found.len()] }
    }

    /// Adapts the step to a collision: removes cavitation, and accelerations from the energy of the scheme.
    ///
    /// A collision lasts longer than the step in which it is computed. The pressure of the step is the whole impulse
    /// over the length of the step and would fall below the floor. The real pressure acts during the whole collision
    /// and stays above the floor. Accelerations have no energy because they are unknown after the step.
    fn adapt_to_collision(&mut self) {
        if self.has_collision() {
            self.time.weights.of_energy = [[Row::DISPLACEMENT, Row::VELOCITY]; 2];
            if let Some(fluid) = &mut self.fluid {
                fluid.form.cavitation = None;
                fluid.time.weights.of_energy = self.time.weights.of_energy;
            }
        }
    }

    /// Constrains boundary values of the fluid, then supports and ties of the bodies, then the pressures of pockets.
    fn constrain(&mut self) {
        let mut constraints = Constraints::new();
        if let Some(fluid) = &self.fluid {
            fluid.constrain(&self.layout, &mut constraints);
        }
        self.bodies.iter().for_each(|body| body.constrain(&self.layout, &mut constraints));
        if let Some(fluid) = &self.fluid {
            let points = fluid.interface(&self.layout, &self.bodies);
            self.pockets = pockets(&points, &constraints, |tag| fluid.setup.is_open(tag));
            for pocket in &self.pockets {
                constraints.set(self.layout.dof(fluid.pressure, pocket.dof as usize, 0), 0.0);
            }
        }
        if let Some(cavitation) = self.fluid.as_mut().and_then(|fluid| fluid.form.cavitation.as_mut()) {
            let coupled =
                |pocket: &Pocket| pocket.coupled.iter().flat_map(|(parts, _)| parts.clone()).collect::<Vec<_>>();
            let parts = self.pockets.iter().flat_map(|pocket| pocket.parts.iter().copied().chain(coupled(pocket)));
            cavitation.enclosed = parts.collect();
            cavitation.enclosed.sort_unstable();
        }
        self.constraints = constraints;
    }

    /// Returns the previous state on the new unknowns, as a starting guess.
    pub fn guess(&self) -> Vec<f64> {
        let mut x = self.guess_at_rest();
        self.bodies.iter().for_each(|body| body.guess(&self.layout, &mut x));
        x
    }

    /// Returns the same guess with bodies at rest.
    pub(crate) fn guess_at_rest(&self) -> Vec<f64> {
        let mut x = vec![0.0; self.layout.len()];
        if let (Some(fluid), Some(before)) = (&self.fluid, &self.previous.fluid) {
            fluid.guess(&self.layout, &before.pressure, &mut x);
        }
        x
    }

    /// Returns an error if a contact may have been missed: its bodies moved farther than the search allowed, or passed
    /// through each other.
    pub(crate) fn check_contacts(&self, x: &[f64], ends: &[BodyState<D>], newton: &NewtonReport) -> Result<(), Error> {
        let positions = [&self.previous.bodies[..], ends].map(|states| self.setup.positions(states));
        let [start, end] = positions.each_ref().map(Vec::as_slice);
        for (index, (contact, step)) in self.setup.contacts.iter().zip(&self.contacts).enumerate() {
            if let Some([motion, room]) = step.missed(contact, self.refs(), x) {
                return Err(Error::MissedContact { contact: index, motion, room, newton: Box::new(newton.clone()) });
            }
            if let Some(motion) = passage(contact, self.setup, [start, end], step.reach) {
                return Err(Error::PassedThrough { contact: index, motion, newton: Box::new(newton.clone()) });
            }
        }
        Ok(())
    }

    /// Returns the bodies at the end of the step.
    pub(crate) fn bodies_at_end(&self, x: &[f64]) -> Vec<BodyState<D>> {
        self.bodies.iter().map(|body| body.end(&self.layout, x)).collect()
    }

    /// Returns the state at the end of the step, with cut and space. Accelerations are unknown after a collision or a
    /// release, in which they jump.
    pub(crate) fn finish(
        self,
        substep: Substep,
        x: &[f64],
        bodies: Vec<BodyState<D>>,
        contact_energy: f64,
    ) -> State<D> {
        let jumps = self.has_collision() || self.setup.bodies.iter().any(|body| body.is_released(&self.time));
        let end = State {
            step: self.previous.step + usize::from(substep.is_last),
            time: self.time.end,
            fluid: self.fluid.map(|fluid| fluid.finish(&self.layout, x)),
            bodies,
            contact_energy,
        };
        if jumps { end.without_accelerations() } else { end }
    }
}
