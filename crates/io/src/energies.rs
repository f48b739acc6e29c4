//! Energies that the steps of a run generated, and lost in contact and at surfaces, relative to the energies of the
//! run.

use contact::{ContactPoint, StressSource};
use mesh::Aabb;
use serde::{Deserialize, Serialize};
use solver::body::Balance;
use solver::{Contact, FluidSetup, Setup, State, StepReport, StepView};

/// Largest gain of energy in a step that counts as round-off, relative to the energies of the run.
const ENERGY_TOLERANCE: f64 = 1e-8;

/// Record of the gains of energy in the steps of a run, and of the energies with which they are compared.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Energies {
    /// Energy of gravity of each body at the start. Changes since then do not depend on the origin of the coordinates.
    gravity_at_start: Vec<f64>,
    /// Sum over the bodies of the weight times the largest extent, at its largest so far. It bounds the errors of
    /// bodies at rest, whose energies may be zero.
    of_weights: f64,
    /// Largest body force on the fluid so far times its volume and the largest extent of the background. It bounds the
    /// errors of fluid at rest.
    of_fluid: f64,
    /// Whether the time scheme has inertia. Without it the energy of a state is not that of the equations.
    has_inertia: bool,
    /// Largest sum of the kinetic, elastic and stored energies and the absolute changes of the energies of gravity.
    largest: f64,
    /// Largest line of the ledger.
    largest_line: f64,
    largest_gain: f64,
    /// Sum of the gains.
    generated: f64,
    /// Energy that the time scheme takes from bodies in steps with contact. Steps in which a law determines the
    /// velocity after an impact are left out, since it changes velocities at once.
    #[serde(default)]
    lost_in_contact: f64,
    /// Energy that the penalty on the normal velocity at surfaces takes.
    #[serde(default)]
    lost_at_surfaces: f64,
    /// Sum of the losses of energy of all steps.
    #[serde(default)]
    dissipated: f64,
    /// Whether the law of each contact determines the velocity after an impact: laws of collisions, and multipliers for
    /// a body that does not deform.
    #[serde(default)]
    determines_impact: Vec<bool>,
    /// Whether each contact may give back energy that it has taken: the other contacts whose laws store none.
    #[serde(default)]
    gives_back: Vec<bool>,
    /// Energy that the normal tractions of each contact have taken since the bodies touched, and have not given back.
    #[serde(default)]
    held_by_contact: Vec<f64>,
    largest_defect: f64,
    /// Whether the energy of a step was not a number.
    is_undefined: bool,
}

impl Energies {
    /// Creates the record of a run from its start.
    pub(crate) fn new<const D: usize>(setup: &Setup<D>, start: &State<D>) -> Self {
        let mut energies = Self { largest: start.fluid_energy() + start.contact_energy, ..Self::default() };
        let determines_impact = |contact: &Contact<D>| {
            let law = &contact.form().law;
            let is_rigid = !setup.bodies[contact.body().index()].deforms();
            law.restitution().is_some() || law.stress() == StressSource::Multiplier && is_rigid
        };
        energies.determines_impact = setup.contacts.iter().map(determines_impact).collect();
        let gives_back = |contact: &Contact<D>| {
            let stored = contact.form().law.energy_density(&ContactPoint::default());
            stored.is_none() && !determines_impact(contact)
        };
        energies.gives_back = setup.contacts.iter().map(gives_back).collect();
        energies.has_inertia = setup.scheme.weights(setup.dt, true).has_inertia();
        let balances: Vec<_> =
            setup.bodies.iter().zip(&start.bodies).map(|(body, state)| body.balance(state)).collect();
        let of_gravity = |balance: &Option<Balance<D>>| balance.as_ref().map_or(0.0, |of| of.potential_energy);
        energies.gravity_at_start = balances.iter().map(of_gravity).collect();
        energies.largest += balances.iter().flatten().map(|of| of.kinetic_energy + of.elastic_energy).sum::<f64>();
        energies.compare_with(setup, balances.iter().map(Option::as_ref), start.time);
        energies
    }

    /// Updates the energies of weights and of body forces, which may depend on time.
    fn compare_with<'b, const D: usize>(
        &mut self,
        setup: &Setup<D>,
        balances: impl Iterator<Item = Option<&'b Balance<D>>>,
        time: f64,
    ) {
        let mut of_weights = 0.0;
        for (body, balance) in setup.bodies.iter().zip(balances) {
            let Some(balance) = balance else { continue };
            let weight = balance.body_force + body.variable_gravity(time) * balance.mass;
            of_weights += weight.norm() * Aabb::of_points(body.reference()).extent().max();
        }
        self.of_weights = self.of_weights.max(of_weights);
        if let Some(FluidSetup { background, body_force: Some(force), .. }) = &setup.fluid {
            let largest = background.vertices().iter().map(|x| force(x, time).norm()).fold(0.0, f64::max);
            let extent = Aabb::of_points(background.vertices()).extent().max();
            self.of_fluid = self.of_fluid.max(largest * background.volume() * extent);
        }
    }

    /// Adds the step that ends at the state of a view.
    ///
    /// Normal tractions of a law without stored energy take energy while surfaces approach each other, and give it
    /// back. Gains from such energy are not counted up to the sum that the contact has taken since the bodies touched.
    ///
    /// Gains below the tolerance of Newton's method times the energies of weights are not counted, and gains below
    /// twice the defect of the ledger, which are errors of the nonlinear solve.
    pub(crate) fn add<const D: usize>(&mut self, view: &StepView<'_, D>, report: &StepReport<D>) {
        let balances = report.bodies.iter().map(|body| body.balance.as_ref());
        self.compare_with(view.setup, balances, view.state.time);
        let tolerance = view.setup.newton.tolerance;
        let of_bodies = report.bodies.iter().zip(&self.gravity_at_start).filter_map(|(body, at_start)| {
            let balance = body.balance.as_ref()?;
            let change = (balance.potential_energy - at_start).abs();
            Some(balance.kinetic_energy + balance.elastic_energy + change)
        });
        let of_contacts: f64 = report.contacts.iter().map(|contact| contact.stored_energy).sum();
        let of_fluid = report.fluid.as_ref().map_or(0.0, |fluid| fluid.kinetic_energy);
        self.largest = self.largest.max(of_bodies.sum::<f64>() + of_contacts + of_fluid);
        self.largest_line = self.largest_line.max(report.ledger.largest_line());
        let inflow = report.fluid.as_ref().map_or(0.0, |fluid| fluid.inflow_energy);
        let (gain, defect) = (-report.ledger.dissipation() - inflow, report.ledger.defect().abs());
        let is_active = |collides: bool| {
            let mut contacts = report.contacts.iter().zip(&self.determines_impact);
            contacts.any(|(contact, is_collision)| contact.n_active > 0 && *is_collision == collides)
        };
        if is_active(false) && !is_active(true) {
            self.lost_in_contact += report.ledger.body_scheme;
        }
        let mut given_back = 0.0;
        self.held_by_contact.resize(self.gives_back.len(), 0.0);
        for ((contact, gives_back), held) in report.contacts.iter().zip(&self.gives_back).zip(&mut self.held_by_contact)
        {
            let taken = -report.substep.dt * contact.normal_power;
            given_back += give_back(held, taken, *gives_back && contact.n_active > 0);
        }
        self.lost_at_surfaces += report.ledger.penalty_normal;
        self.dissipated += (-gain).max(0.0);
        self.is_undefined |= !(gain.is_finite() && defect.is_finite());
        self.largest_defect = self.largest_defect.max(defect);
        if gain > 2.0 * defect {
            self.largest_gain = self.largest_gain.max(gain);
            let generated = gain - given_back;
            self.generated += if generated > tolerance * self.of_weights { generated } else { 0.0 };
        }
    }

    /// Returns whether no step increased the energy; true for a scheme without inertia.
    pub(crate) fn is_monotone(&self) -> bool {
        !self.has_inertia
            || !self.is_undefined && self.largest_gain <= ENERGY_TOLERANCE * self.largest.max(self.of_weights)
    }

    /// Returns the sum of the gains relative to the energies of the run; `None` if an energy was not a number, and for
    /// a scheme without inertia.
    pub(crate) fn generated(&self) -> Option<f64> {
        let size = self.largest.max(self.largest_line).max(f64::MIN_POSITIVE);
        (self.has_inertia && !self.is_undefined).then_some(self.generated / size)
    }

    /// Returns the energy that the time scheme takes from bodies in contact, relative to the energies of the run.
    /// Returns `None` as [`Self::generated`] does.
    pub(crate) fn lost_in_contact(&self) -> Option<f64> {
        self.generated().map(|_| self.lost_in_contact / self.largest.max(f64::MIN_POSITIVE))
    }

    /// Returns the energy that the penalty on the normal velocity at surfaces takes, relative to the sum of the
    /// energies of the run and all losses. Returns `None` as [`Self::generated`] does.
    pub(crate) fn lost_at_surfaces(&self) -> Option<f64> {
        let size = (self.largest + self.dissipated).max(f64::MIN_POSITIVE);
        self.generated().map(|_| self.lost_at_surfaces / size)
    }

    /// Returns the largest energy of a step that no line of the ledger contains, relative to the energies of the run;
    /// `None` if an energy was not a number.
    pub(crate) fn defect(&self) -> Option<f64> {
        let size = self.largest.max(self.largest_line).max(self.of_weights).max(self.of_fluid).max(f64::MIN_POSITIVE);
        (!self.is_undefined).then_some(self.largest_defect / size)
    }
}

/// Adds the energy that a contact takes in a step, negative if it gives energy, to what it holds, and returns what it
/// gives back of this; a contact that ends holds nothing.
fn give_back(held: &mut f64, taken: f64, touches: bool) -> f64 {
    let given_back = if touches { held.min(-taken).max(0.0) } else { 0.0 };
    *held = if touches { (*held + taken).max(0.0) } else { 0.0 };
    given_back
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_gives_back_what_it_took_since_bodies_touched() {
        let mut held = 0.0;
        let mut step = |taken, touches| give_back(&mut held, taken, touches);
        assert_eq!(step(3.0, true), 0.0);
        assert_eq!([step(-2.0, true), step(-2.0, true), step(-2.0, true)], [2.0, 1.0, 0.0]);
        // The rest is lost when the bodies part.
        assert_eq!([step(3.0, true), step(0.0, false), step(-2.0, true)], [0.0; 3]);
        assert_eq!([step(1.0, true), step(-2.0, false), step(-1.0, true)], [0.0; 3]);
    }
}
