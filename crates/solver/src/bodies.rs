//! The bodies and contacts of one step, with a fluid around them or without.

use algebra::{BlockLayout, Constraints, Contributions, DofId, FieldId, NewtonReport};
use contact::{ContactBody, ContactFacets, ContactPair};
use mesh::{BodyId, Point, Vector};
use solid_rigid::modes::n_modes;
use solid_rigid::{RigidMomentum, RigidMotion, RigidStep};
use solid_svk::boundary::{Support, support_values};
use solid_svk::{InternalWorkCells, LinearCells, SolidCells, SolidFacets, StepRule};

use crate::setup::{BodyKind, Contact, ContactObstacle, SupportKind};
use crate::state::{prescribed_body, rigid_body};
use crate::{Body, BodyState, ElasticBody, RigidBody, SetupError, Stage};

/// The velocities of the vertices of a body at the end of a step, and the positions that follow from them.
#[derive(Clone, Debug)]
pub struct BodyUnknown<const D: usize> {
    /// Velocities of the vertices.
    pub field: FieldId,
    /// Positions of the vertices at zero velocity.
    pub predicted: Vec<Point<D>>,
    /// Derivative of the positions with respect to the velocities.
    pub displacement_per_velocity: f64,
    /// What is known of the velocities.
    pub motion: Motion<D>,
}

/// What is known of the velocities of a body.
#[derive(Clone, Debug)]
pub enum Motion<const D: usize> {
    /// Nothing: each is an unknown. Displacement and acceleration follow from them.
    Elastic(StepRule<D>),
    /// They are tied to velocity and spin of the body.
    Rigid {
        /// The balance of momentum.
        step: RigidStep<D>,
        /// Velocity and spin.
        unknowns: FieldId,
    },
    /// All of them.
    Prescribed(Vec<Vector<D>>),
}

/// Adds the unknowns of the bodies to the layout; `None` for a body of prescribed motion that has no contacts.
pub(crate) fn unknowns<const D: usize>(
    bodies: &[Body<D>],
    contacts: &[Contact<D>],
    previous: &[BodyState<D>],
    (time, dt): (f64, f64),
    layout: &mut BlockLayout,
) -> Result<Vec<Option<BodyUnknown<D>>>, SetupError> {
    let unknown = |(b, (body, state)): (usize, (&Body<D>, &BodyState<D>))| match &body.kind {
        BodyKind::Elastic(elastic) => {
            let refuse = |source| SetupError::Solid { body: body.name.clone(), source };
            let rule = elastic
                .scheme
                .step(dt, &state.displacement, &state.velocity, state.acceleration.as_deref())
                .map_err(refuse)?;
            let displacement = &rule.end().displacement;
            Ok(Some(BodyUnknown {
                field: layout.push(&body.name, elastic.solid.n_dofs()),
                predicted: elastic.solid.positions(displacement.predicted()).map_err(refuse)?,
                displacement_per_velocity: displacement.slope(),
                motion: Motion::Elastic(rule),
            }))
        }
        BodyKind::Rigid(rigid) => {
            let refuse = |source| SetupError::Rigid { body: body.name.clone(), source };
            let begin = rigid_motion(rigid, state);
            Ok(Some(BodyUnknown {
                field: layout.push(&body.name, D * rigid.reference.len()),
                predicted: state.positions(&rigid.reference),
                displacement_per_velocity: dt,
                motion: Motion::Rigid {
                    step: RigidStep::new(&rigid.mass, &begin, rigid.gravity, dt).map_err(refuse)?,
                    unknowns: layout.push(&format!("{} as a whole", body.name), n_modes(D)),
                },
            }))
        }
        BodyKind::Prescribed(given) if contacts.iter().any(|contact| contact.names(b)) => {
            let end = prescribed_body(given, time);
            let positions = end.positions(&given.reference);
            Ok(Some(BodyUnknown {
                field: layout.push(&body.name, D * given.reference.len()),
                predicted: positions.iter().zip(&end.velocity).map(|(x, v)| x - v * dt).collect(),
                displacement_per_velocity: dt,
                motion: Motion::Prescribed(end.velocity),
            }))
        }
        BodyKind::Prescribed(_) => Ok(None),
    };
    bodies.iter().zip(previous).enumerate().map(unknown).collect()
}

/// Motion of a rigid body; at the start if the state has none.
fn rigid_motion<const D: usize>(body: &RigidBody<D>, state: &BodyState<D>) -> RigidMotion<D> {
    state.rigid.unwrap_or_else(|| RigidMotion::initial(&body.mass, body.initial_velocity, body.initial_spin))
}

/// Prescribes the unknowns that supports hold, at the time of the end of the step, and ties those of rigid bodies.
pub(crate) fn constrain<const D: usize>(
    bodies: &[Body<D>],
    unknowns: &[Option<BodyUnknown<D>>],
    layout: &BlockLayout,
    time: f64,
    constraints: &mut Constraints,
) -> Result<(), SetupError> {
    for (body, unknown) in bodies.iter().zip(unknowns) {
        let Some(unknown) = unknown else { continue };
        match (&body.kind, &unknown.motion) {
            (BodyKind::Elastic(elastic), Motion::Elastic(rule)) => {
                let values = held(elastic, rule, layout, unknown.field, time)
                    .map_err(|source| SetupError::Solid { body: body.name.clone(), source })?;
                values.into_iter().for_each(|(dof, value)| constraints.set(dof, value));
            }
            (BodyKind::Rigid(rigid), Motion::Rigid { step, unknowns }) => {
                step.tie(&unknown.predicted, layout, unknown.field, *unknowns, constraints)
                    .map_err(|source| SetupError::Rigid { body: body.name.clone(), source })?;
                let held = (0..n_modes(D)).filter(|m| if *m < D { rigid.held_axes[*m] } else { rigid.holds_rotation });
                held.for_each(|m| constraints.set(layout.dof(*unknowns, m), 0.0));
            }
            (_, Motion::Prescribed(velocity)) => {
                for (i, v) in velocity.iter().enumerate() {
                    (0..D).for_each(|a| constraints.set(layout.dof(unknown.field, D * i + a), v[a]));
                }
            }
            _ => unreachable!("unknowns are made for the kind of the body"),
        }
    }
    Ok(())
}

/// What the supports of an elastic body prescribe.
fn held<const D: usize>(
    elastic: &ElasticBody<D>,
    rule: &StepRule<D>,
    layout: &BlockLayout,
    field: FieldId,
    time: f64,
) -> Result<Vec<(DofId, f64)>, solid_svk::Error> {
    let mut all = Vec::new();
    for support in &elastic.supports {
        let displacement;
        let kind = match &support.kind {
            SupportKind::Clamped => Support::Clamped,
            SupportKind::Symmetry { axis } => Support::Symmetry { axis: *axis },
            SupportKind::Displacement(given) => {
                displacement = move |x: &Point<D>| given(x, time);
                Support::Displacement(&displacement)
            }
        };
        all.extend(support_values(&elastic.solid, &support.vertices, kind, rule, layout, field)?);
    }
    Ok(all)
}

/// What the bodies of a step and their contacts add to the system.
pub struct BodyForms<'a, const D: usize> {
    cells: Vec<(LinearCells<'a, D>, InternalWorkCells<'a, D>)>,
    loads: Vec<SolidFacets<'a, D>>,
    rigid: Vec<RigidMomentum<D>>,
    /// The contacts, in the order of the setup.
    pub contacts: Vec<ContactFacets<'a, D>>,
    dt: f64,
}

impl<'a, const D: usize> BodyForms<'a, D> {
    /// The forms of a step of length `dt`.
    pub(crate) fn new(
        bodies: &'a [Body<D>],
        contacts: &'a [Contact<D>],
        unknowns: &'a [Option<BodyUnknown<D>>],
        layout: &BlockLayout,
        previous: &[BodyState<D>],
        dt: f64,
    ) -> Result<Self, SetupError> {
        let mut forms = Self { cells: Vec::new(), loads: Vec::new(), rigid: Vec::new(), contacts: Vec::new(), dt };
        for (body, unknown) in bodies.iter().zip(unknowns) {
            let Some(BodyUnknown { field, motion, .. }) = unknown else { continue };
            if let Motion::Rigid { step, unknowns } = motion {
                let momentum = step.momentum(layout, *unknowns);
                forms.rigid.push(momentum.map_err(|source| SetupError::Rigid { body: body.name.clone(), source })?);
            }
            let (BodyKind::Elastic(elastic), Motion::Elastic(rule)) = (&body.kind, motion) else { continue };
            let refuse = |source| SetupError::Solid { body: body.name.clone(), source };
            let cells = SolidCells::new(&elastic.solid, &elastic.form, rule, layout, *field).map_err(refuse)?;
            forms.cells.push((cells.linear(), cells.internal_work()));
            for (facets, term) in &elastic.loads {
                let load = SolidFacets::new(&elastic.solid, term.as_ref(), facets, rule, layout, *field);
                forms.loads.push(load.map_err(refuse)?);
            }
        }
        for (index, contact) in contacts.iter().enumerate() {
            forms.contacts.push(contact_facets(bodies, unknowns, layout, previous, dt, index, contact)?);
        }
        Ok(forms)
    }

    /// Cells, then loads, then rigid bodies.
    pub(crate) fn solids(&self) -> impl Iterator<Item = &dyn Contributions> {
        let cells = self.cells.iter().flat_map(|(linear, work)| [linear as &dyn Contributions, work]);
        let loads = self.loads.iter().map(|load| load as &dyn Contributions);
        cells.chain(loads).chain(self.rigid.iter().map(|momentum| momentum as _))
    }

    /// Contacts.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = &dyn Contributions> {
        self.contacts.iter().map(|contact| contact as _)
    }

    /// Fingerprint of what is in contact.
    pub(crate) fn regime(&self, x: &[f64]) -> u64 {
        self.contacts.iter().fold(0, |hash, contact| hash.rotate_left(1) ^ contact.regime(x))
    }

    /// Refuses a step in which points of a contact moved farther than it was looked for obstacles: contact may have been
    /// missed.
    pub(crate) fn check_contacts(&self, x: &[f64], newton: &NewtonReport) -> Result<(), Stage> {
        let motion = |body: &ContactBody<'_, D>| {
            let speed =
                x[body.range()].chunks_exact(D).map(|v| Vector::<D>::from_column_slice(v).norm()).fold(0.0, f64::max);
            speed * self.dt
        };
        for (contact, facets) in self.contacts.iter().enumerate() {
            let pair = facets.pair();
            // A rigid obstacle is seen from everywhere.
            let Some(master) = &pair.master else { continue };
            let motion = motion(&pair.slave) + motion(master);
            let offset = facets.form().law.offset();
            let room = pair.reach - offset;
            let apart = distance_of_boxes(pair.slave.predicted(), master.predicted());
            if motion > room && apart <= motion + offset {
                return Err(Stage::MissedContact { contact, motion, room, newton: Box::new(newton.clone()) });
            }
        }
        Ok(())
    }
}

/// Distance of the bounding boxes of two sets of points, at most that of the points.
fn distance_of_boxes<const D: usize>(a: &[Point<D>], b: &[Point<D>]) -> f64 {
    let bound = |points: &[Point<D>], axis: usize, of: fn(f64, f64) -> f64| points.iter().map(|x| x[axis]).reduce(of);
    let gap = |axis: usize| {
        let [low_a, low_b] = [a, b].map(|points| bound(points, axis, f64::min).unwrap_or(f64::INFINITY));
        let [high_a, high_b] = [a, b].map(|points| bound(points, axis, f64::max).unwrap_or(f64::NEG_INFINITY));
        (low_a - high_b).max(low_b - high_a).max(0.0)
    };
    (0..D).map(|axis| gap(axis).powi(2)).sum::<f64>().sqrt()
}

fn contact_facets<'a, const D: usize>(
    bodies: &'a [Body<D>],
    unknowns: &'a [Option<BodyUnknown<D>>],
    layout: &BlockLayout,
    previous: &[BodyState<D>],
    dt: f64,
    index: usize,
    contact: &'a Contact<D>,
) -> Result<ContactFacets<'a, D>, SetupError> {
    let refuse = |source| SetupError::Contact { index, source };
    let body = |id: BodyId| -> Result<ContactBody<'a, D>, SetupError> {
        let BodyUnknown { field, predicted, displacement_per_velocity, .. } =
            unknowns[id.index()].as_ref().unwrap_or_else(|| unreachable!("bodies in contact have a field"));
        let boundary = bodies[id.index()].boundary();
        ContactBody::new(boundary, predicted, *displacement_per_velocity, layout, *field).map_err(refuse)
    };
    let fastest = |id: BodyId| previous[id.index()].velocity.iter().map(Vector::norm).fold(0.0, f64::max) * dt;
    let (master, motion) = match &contact.obstacle {
        ContactObstacle::Rigid(_) => (None, fastest(contact.body)),
        ContactObstacle::Body { body: master, .. } => (Some(body(*master)?), fastest(contact.body) + fastest(*master)),
    };
    let pair = ContactPair {
        slave: body(contact.body)?,
        facets: &contact.facets,
        obstacle: contact.obstacle.geometry(),
        master,
        // Twice the motion of the last step, and some room to penetrate.
        reach: contact.form.law.offset() + 2.0 * motion + 2.0 * contact.form.element_size(),
    };
    ContactFacets::new(&contact.form, pair).map_err(refuse)
}

/// The bodies at the end of a step.
pub(crate) fn accept<const D: usize>(
    bodies: &[Body<D>],
    unknowns: &[Option<BodyUnknown<D>>],
    layout: &BlockLayout,
    time: f64,
    x: &[f64],
) -> Vec<BodyState<D>> {
    let state = |(body, unknown): (&Body<D>, &Option<BodyUnknown<D>>)| match (&body.kind, unknown) {
        (BodyKind::Prescribed(given), _) => prescribed_body(given, time),
        (BodyKind::Rigid(rigid), Some(BodyUnknown { motion: Motion::Rigid { step, unknowns }, .. })) => {
            rigid_body(rigid, step.end(&x[layout.range(*unknowns)]))
        }
        (BodyKind::Elastic(_), Some(BodyUnknown { field, motion: Motion::Elastic(rule), .. })) => {
            let velocity: Vec<Vector<D>> =
                x[layout.range(*field)].chunks_exact(D).map(Vector::from_column_slice).collect();
            let end = rule.end();
            BodyState {
                displacement: velocity.iter().enumerate().map(|(i, v)| end.displacement.at(i, v)).collect(),
                acceleration: Some(velocity.iter().enumerate().map(|(i, v)| end.acceleration.at(i, v)).collect()),
                velocity,
                rigid: None,
            }
        }
        _ => unreachable!("unknowns are made for the kind of the body"),
    };
    bodies.iter().zip(unknowns).map(state).collect()
}

/// Velocities of the bodies, as a starting guess; those that are tied or prescribed follow.
pub(crate) fn set_velocities<const D: usize>(
    unknowns: &[Option<BodyUnknown<D>>],
    previous: &[BodyState<D>],
    layout: &BlockLayout,
    x: &mut [f64],
) {
    for (unknown, state) in unknowns.iter().zip(previous) {
        let Some(unknown) = unknown else { continue };
        for (slot, v) in x[layout.range(unknown.field)].chunks_exact_mut(D).zip(&state.velocity) {
            slot.copy_from_slice(v.as_slice());
        }
        if let (Motion::Rigid { unknowns, .. }, Some(motion)) = (&unknown.motion, &state.rigid) {
            let whole = &mut x[layout.range(*unknowns)];
            whole[..D].copy_from_slice(motion.velocity.as_slice());
            whole[D..].copy_from_slice(&motion.spin[..n_modes(D) - D]);
        }
    }
}
