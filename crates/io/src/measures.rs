//! What histories and summaries say about each body after a step.

use mesh::Placed;
use solver::{BodyKind, BodyReport, ContactObstacle, Setup, StepView};

use crate::forces::enclosed;

/// One body after a step; `y` is the last coordinate.
///
/// Units (cgs, per unit depth in 2D): lengths cm, velocities cm/s, forces dyn/cm, powers erg/(s cm), energies erg/cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMeasures {
    /// Smallest gap to the obstacles of the body; without a contact, height of its lowest vertex over the bottom of the
    /// background.
    pub d_min: f64,
    /// `d_min` plus the height of the body.
    pub d_max: f64,
    /// Vertical extent.
    pub body_height: f64,
    /// Vertical velocity of the lowest vertex.
    pub lowest_velocity: f64,
    /// Change of that velocity over the step, per time.
    pub lowest_acceleration: f64,
    /// Height of the centre of mass; of the area, if the motion is prescribed.
    pub centre_y: f64,
    /// Vertical velocity of that centre.
    pub centre_velocity: f64,
    /// Vertical contact force on the body.
    pub contact_force: f64,
    /// Power of the contacts in which the body is the slave.
    pub contact_power: f64,
    /// Largest violation of the offset.
    pub max_penetration: f64,
    /// Quadrature points in contact.
    pub active_points: usize,
    /// Kinetic energy.
    pub energy_kinetic: f64,
    /// Elastic energy.
    pub energy_elastic: f64,
    /// Potential energy of gravity, zero at the origin.
    pub energy_gravity: f64,
    /// Energy stored in the contacts in which the body is the slave.
    pub energy_contact: f64,
}

impl BodyMeasures {
    /// The measures of body `index`; `None` before the first step.
    pub fn new<const D: usize>(view: &StepView<'_, D>, index: usize, bottom: f64) -> Option<Self> {
        let report = view.report?;
        let body: &BodyReport<D> = &report.bodies[index];
        let vertical = D - 1;
        let lowest = body.lowest.1[vertical];
        let body_height = body.highest - lowest;
        let mut measures = Self {
            d_min: f64::INFINITY,
            d_max: 0.0,
            body_height,
            lowest_velocity: body.lowest_velocity[vertical],
            lowest_acceleration: body.lowest_acceleration[vertical],
            centre_y: f64::NAN,
            centre_velocity: f64::NAN,
            contact_force: 0.0,
            contact_power: 0.0,
            max_penetration: 0.0,
            active_points: 0,
            energy_kinetic: 0.0,
            energy_elastic: 0.0,
            energy_gravity: 0.0,
            energy_contact: 0.0,
        };
        if let Some(balance) = &body.balance {
            measures.centre_y = balance.centre_of_mass[vertical];
            measures.centre_velocity = balance.momentum[vertical] / balance.mass;
            measures.energy_kinetic = balance.kinetic_energy;
            measures.energy_elastic = balance.elastic_energy;
            measures.energy_gravity = balance.potential_energy;
        }
        if let BodyKind::Prescribed(prescribed) = &view.setup.bodies[index].kind {
            let positions = view.state.bodies[index].positions(&prescribed.reference);
            let (_, centre) = enclosed(&Placed::new(&prescribed.boundary, &positions));
            measures.centre_y = centre[vertical];
            measures.centre_velocity = (prescribed.velocity)(&centre, [view.state.time; 2])[vertical];
        }
        for (contact, found) in view.setup.contacts.iter().zip(&report.contacts) {
            if contact.body.index() == index {
                measures.d_min = found.minimum_gap.map_or(measures.d_min, |gap| gap.min(measures.d_min));
                measures.contact_force += found.force[vertical];
                measures.contact_power += found.power;
                measures.max_penetration = measures.max_penetration.max(found.largest_penetration);
                measures.active_points += found.n_active;
                measures.energy_contact += found.stored_energy;
            }
            if let ContactObstacle::Body { body: master, .. } = &contact.obstacle
                && master.index() == index
            {
                measures.contact_force -= found.force[vertical];
            }
        }
        if measures.d_min.is_infinite() {
            measures.d_min = lowest - bottom;
        }
        measures.d_max = measures.d_min + body_height;
        Some(measures)
    }
}

/// The body that a summary speaks of: the slave of the first contact, else the first body that is moved by forces, else the first body.
pub(crate) fn leading_body<const D: usize>(setup: &Setup<D>) -> Option<usize> {
    let slave = setup.contacts.first().map(|contact| contact.body.index());
    let moved = || setup.bodies.iter().position(|body| !matches!(body.kind, BodyKind::Prescribed(_)));
    slave.or_else(moved).or((!setup.bodies.is_empty()).then_some(0))
}
