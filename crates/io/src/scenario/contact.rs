//! Contacts and obstacles of a scenario.

use std::sync::Arc;

use contact::{ContactForm, DeformableObstacle, PenaltyLaw, RigidPlane};
use mesh::BodyId;
use solver::ContactObstacle;

use super::body::Built;
use super::error::ScenarioError;
use super::geometry::ZERO_VECTOR;
use super::key::Quantity;
use super::table::{At, Components, choices, keys};

keys! {
    /// Contact of a body (the slave) with an obstacle (the master).
    pub struct ContactKeys {
        /// Name of the slave.
        body: At<String>,
        /// Contact law.
        law: ContactLawChoice,
        /// Contact size `s`, by which the penalty is divided.
        size: f64 [unit(Quantity::LENGTH), positive],
        /// Offset `ε`: contact begins at this distance.
        offset: f64 [unit(Quantity::LENGTH), non_negative],
        /// The obstacle.
        obstacle: At<ObstacleChoice>,
    }
}

choices! {
    /// Contact law.
    pub enum ContactLawChoice ["kind"] {
        /// Pressure `γ_C0/s [ε - Δ]₊` at the distance `Δ`.
        Penalty = "penalty" {
            /// Penalty parameter `γ_C0`.
            gamma_contact_0: f64 [unit(Quantity::PRESSURE), positive],
        },
    }
}

choices! {
    /// Obstacle of a contact.
    pub enum ObstacleChoice ["kind"] {
        /// Plane at rest.
        RigidPlane = "rigid-plane" {
            /// A point on the plane.
            point: Components<f64> [unit(Quantity::LENGTH)],
            /// Normal of the plane, into the obstacle.
            normal: At<Components<f64>>,
        },
        /// Another body.
        Body = "body" {
            /// Name of the body.
            name: At<String>,
        },
    }
}

/// Builds a contact between bodies, which stand in the order of their tables.
pub(super) fn contact<const D: usize>(
    given: &At<ContactKeys>,
    built: &[Built<D>],
) -> Result<solver::Contact<D>, ScenarioError> {
    let bodies: Vec<_> = built.iter().map(|built| Arc::clone(&built.body)).collect();
    let fail = |error: contact::Error| given.at.error(error);
    let find = |name: &At<String>| {
        let found = bodies.iter().position(|body| body.name() == name.as_str()).map(BodyId::new);
        found.ok_or_else(|| name.at.unknown("body", name, bodies.iter().map(|body| body.name())))
    };
    let free_facets = |body: BodyId| built[body.index()].contact_facets.clone();
    let slave = find(&given.body)?;
    let immovable = |why| {
        let name = given.body.as_str();
        given.obstacle.at.invalid(format!(
            "neither `{name}` nor its obstacle can move: {why}; take the contact out, or make `{name}` elastic or free"
        ))
    };
    let can_move = |body: BodyId| bodies[body.index()].is_movable();
    let ContactLawChoice::Penalty { gamma_contact_0 } = given.law;
    let law = PenaltyLaw::new(gamma_contact_0, given.offset).map_err(fail)?;
    let obstacle = match &*given.obstacle {
        ObstacleChoice::RigidPlane { .. } if !can_move(slave) => {
            return Err(immovable("one has a given motion, the other is a rigid plane"));
        }
        ObstacleChoice::RigidPlane { point, normal } => {
            let direction = normal.vector::<D>().try_normalize(0.0).ok_or_else(|| normal.at.invalid(ZERO_VECTOR))?;
            ContactObstacle::Rigid(Box::new(RigidPlane::new(point.vector(), direction).map_err(fail)?))
        }
        ObstacleChoice::Body { name } => {
            let body = find(name)?;
            if body == slave {
                return Err(name.at.error(contact::Error::SelfContact));
            }
            if !can_move(slave) && !can_move(body) {
                return Err(immovable("both have a given motion"));
            }
            let boundary = bodies[body.index()].surface().clone();
            ContactObstacle::Body { body, surface: DeformableObstacle::new(boundary, free_facets(body)).map_err(fail)? }
        }
    };
    let form = ContactForm::new(law, given.size).map_err(fail)?;
    solver::Contact::new(&bodies, slave, free_facets(slave), form, obstacle).map_err(fail)
}
