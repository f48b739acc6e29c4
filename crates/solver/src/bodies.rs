//! The bodies and contacts of one step, with a fluid around them or without.

use algebra::{BlockLayout, Constraints, Contributions, FieldId, NewtonReport};
use contact::{ContactBody, ContactFacets, ContactPair};
use mesh::{BodyId, Point, Vector};
use solid_svk::boundary::{Support, support_values};
use solid_svk::{InternalWorkCells, LinearCells, SolidCells, SolidFacets, StepRule};

use crate::setup::{BodyKind, Contact, ContactObstacle, SupportKind};
use crate::state::prescribed_body;
use crate::{Body, BodyState, SetupError, Stage};

/// The unknown velocity of an elastic body, and what follows from it.
#[derive(Clone, Debug)]
pub struct BodyUnknown<const D: usize> {
    /// Velocity at the end of the step.
    pub field: FieldId,
    /// Displacement and acceleration.
    pub rule: StepRule<D>,
    /// Positions of the vertices at the end of the step, at zero velocity.
    pub predicted: Vec<Point<D>>,
}

/// Adds the unknowns of the elastic bodies to the layout; `None` where the motion is prescribed.
pub(crate) fn unknowns<const D: usize>(
    bodies: &[Body<D>],
    previous: &[BodyState<D>],
    dt: f64,
    layout: &mut BlockLayout,
) -> Result<Vec<Option<BodyUnknown<D>>>, SetupError> {
    let unknown = |(body, state): (&Body<D>, &BodyState<D>)| {
        let BodyKind::Elastic(elastic) = &body.kind else { return Ok(None) };
        let refuse = |source| SetupError::Solid { body: body.name.clone(), source };
        let rule = elastic
            .scheme
            .step(dt, &state.displacement, &state.velocity, state.acceleration.as_deref())
            .map_err(refuse)?;
        let predicted = elastic.solid.positions(rule.end().displacement.predicted()).map_err(refuse)?;
        Ok(Some(BodyUnknown { field: layout.push(&body.name, elastic.solid.n_dofs()), rule, predicted }))
    };
    bodies.iter().zip(previous).map(unknown).collect()
}

/// Prescribes the unknowns that supports hold, at the time of the end of the step.
pub(crate) fn constrain<const D: usize>(
    bodies: &[Body<D>],
    unknowns: &[Option<BodyUnknown<D>>],
    layout: &BlockLayout,
    time: f64,
    constraints: &mut Constraints,
) -> Result<(), SetupError> {
    for (body, unknown) in bodies.iter().zip(unknowns) {
        let (BodyKind::Elastic(elastic), Some(unknown)) = (&body.kind, unknown) else { continue };
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
            let values = support_values(&elastic.solid, &support.vertices, kind, &unknown.rule, layout, unknown.field)
                .map_err(|source| SetupError::Solid { body: body.name.clone(), source })?;
            values.into_iter().for_each(|(dof, value)| constraints.set(dof, value));
        }
    }
    Ok(())
}

/// What the bodies of a step and their contacts add to the system.
pub struct BodyForms<'a, const D: usize> {
    cells: Vec<(LinearCells<'a, D>, InternalWorkCells<'a, D>)>,
    loads: Vec<SolidFacets<'a, D>>,
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
        let mut forms = Self { cells: Vec::new(), loads: Vec::new(), contacts: Vec::new(), dt };
        for (body, unknown) in bodies.iter().zip(unknowns) {
            let (BodyKind::Elastic(elastic), Some(BodyUnknown { field, rule, .. })) = (&body.kind, unknown) else {
                continue;
            };
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

    /// Cells, then loads.
    pub(crate) fn solids(&self) -> impl Iterator<Item = &dyn Contributions> {
        let cells = self.cells.iter().flat_map(|(linear, work)| [linear as &dyn Contributions, work]);
        cells.chain(self.loads.iter().map(|load| load as _))
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
        let Some(BodyUnknown { field, rule, predicted }) = &unknowns[id.index()] else {
            return Err(SetupError::NotElastic { index, body: id });
        };
        let slope = rule.end().displacement.slope();
        ContactBody::new(bodies[id.index()].boundary(), predicted, slope, layout, *field).map_err(refuse)
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
        (BodyKind::Elastic(_), None) => unreachable!("elastic bodies have a field"),
        (BodyKind::Elastic(_), Some(BodyUnknown { field, rule, .. })) => {
            let velocity: Vec<Vector<D>> =
                x[layout.range(*field)].chunks_exact(D).map(Vector::from_column_slice).collect();
            let end = rule.end();
            BodyState {
                displacement: velocity.iter().enumerate().map(|(i, v)| end.displacement.at(i, v)).collect(),
                acceleration: Some(velocity.iter().enumerate().map(|(i, v)| end.acceleration.at(i, v)).collect()),
                velocity,
            }
        }
    };
    bodies.iter().zip(unknowns).map(state).collect()
}

/// Velocities of the elastic bodies, as a starting guess.
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
    }
}
