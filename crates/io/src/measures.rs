//! What histories and summaries say about each body after a step.

use mesh::{Placed, Point, Vector};
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
    /// Horizontal position of that centre, along the first axis.
    pub centre_x: f64,
    /// Horizontal velocity of that centre.
    pub centre_velocity_x: f64,
    /// Angle by which the vertices are turned about their mean, in the plane of the first two axes, from -π to π.
    pub angle: f64,
    /// Angular velocity of the vertices about their mean, in that plane, 1/s.
    pub angular_velocity: f64,
    /// Horizontal contact force on the body, along the first axis.
    pub contact_force_x: f64,
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
            centre_x: f64::NAN,
            centre_velocity_x: f64::NAN,
            angle: 0.0,
            angular_velocity: 0.0,
            contact_force_x: 0.0,
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
            measures.centre_x = balance.centre_of_mass[0];
            measures.centre_velocity_x = balance.momentum[0] / balance.mass;
            measures.energy_kinetic = balance.kinetic_energy;
            measures.energy_elastic = balance.elastic_energy;
            measures.energy_gravity = balance.potential_energy;
        }
        if let BodyKind::Prescribed(prescribed) = &view.setup.bodies[index].kind {
            let positions = view.state.bodies[index].positions(&prescribed.reference);
            let (_, centre) = enclosed(&Placed::new(&prescribed.boundary, &positions));
            measures.centre_y = centre[vertical];
            let velocity = (prescribed.velocity)(&centre, [view.state.time; 2]);
            measures.centre_velocity = velocity[vertical];
            (measures.centre_x, measures.centre_velocity_x) = (centre[0], velocity[0]);
        }
        let now = &view.state.bodies[index];
        let reference = view.setup.bodies[index].reference();
        (measures.angle, measures.angular_velocity) = turn(reference, &now.positions(reference), &now.velocity);
        for (contact, found) in view.setup.contacts.iter().zip(&report.contacts) {
            if contact.body.index() == index {
                measures.d_min = found.minimum_gap.map_or(measures.d_min, |gap| gap.min(measures.d_min));
                measures.contact_force_x += found.force[0];
                measures.contact_force += found.force[vertical];
                measures.contact_power += found.power;
                measures.max_penetration = measures.max_penetration.max(found.largest_penetration);
                measures.active_points += found.n_active;
                measures.energy_contact += found.stored_energy;
            }
            if let ContactObstacle::Body { body: master, .. } = &contact.obstacle
                && master.index() == index
            {
                measures.contact_force_x -= found.force[0];
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

/// Angle by which points are turned about their mean in the plane of the first two axes, that of the rotation nearest to their motion,
/// and their angular velocity there.
fn turn<const D: usize>(reference: &[Point<D>], now: &[Point<D>], velocity: &[Vector<D>]) -> (f64, f64) {
    let mean = |points: &[Point<D>]| points.iter().sum::<Point<D>>() / points.len() as f64;
    let (before, after, drift) = (mean(reference), mean(now), mean(velocity));
    let (mut along, mut across, mut swept, mut square) = (0.0, 0.0, 0.0, 0.0);
    for ((x, y), v) in reference.iter().zip(now).zip(velocity) {
        let (r, s, v) = (x - before, y - after, v - drift);
        along += r[0] * s[0] + r[1] * s[1];
        across += r[0] * s[1] - r[1] * s[0];
        swept += s[0] * v[1] - s[1] * v[0];
        square += s[0] * s[0] + s[1] * s[1];
    }
    (across.atan2(along), swept / square)
}

/// The body that a summary speaks of: the slave of the first contact, else the first body that is moved by forces, else the first body.
pub(crate) fn leading_body<const D: usize>(setup: &Setup<D>) -> Option<usize> {
    let slave = setup.contacts.first().map(|contact| contact.body.index());
    let moved = || setup.bodies.iter().position(|body| !matches!(body.kind, BodyKind::Prescribed(_)));
    slave.or_else(moved).or((!setup.bodies.is_empty()).then_some(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_found_with_its_rate() {
        let reference = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0]].map(Point::<2>::from);
        let (angle, rate) = (2.0_f64, -1.5);
        let turned = |x: &Point<2>| {
            Point::<2>::new(3.0 + x[0] * angle.cos() - x[1] * angle.sin(), x[0] * angle.sin() + x[1] * angle.cos())
        };
        let now = reference.each_ref().map(turned);
        let velocity = now.map(|x| Vector::<2>::new(4.0 - rate * x[1], rate * x[0]));
        let (found, found_rate) = turn(&reference, &now, &velocity);
        assert!((found - angle).abs() < 1e-14 && (found_rate - rate).abs() < 1e-13);
    }
}
