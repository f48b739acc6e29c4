//! The coupled problem of one step, by composition.

use algebra::{BlockLayout, Constraints, Contributions, FieldId, NonlinearProblem};
use contact::{ContactBody, ContactFacets, ContactPair};
use fluid_ns::terms::{Backflow, Traction};
use fluid_ns::{FluidCells, FluidConvection, FluidFaces, FluidForm, FluidGeometry, OpenBoundary};
use interface_dg::{BodySide, InterfacePieces};
use mesh::{BodyId, Tag, Vector};
use solid_svk::{InternalWorkCells, LinearCells, SolidCells, SolidFacets};
use xfem_space::{BoundaryValues, XfemSpace};

use crate::setup::{BodyKind, Contact, ContactObstacle, FluidBoundary};
use crate::system::fluid_geometry;
use crate::{Setup, SetupError, State, StepGeometry, StepSystem};

/// Degree of quadrature on open boundaries: products of three P1 functions.
const BOUNDARY_DEGREE: usize = 3;

/// What the contributions of a step borrow: the fluid's geometry and terms, and the body side of the interface.
pub struct StepForms<'a, const D: usize> {
    fluid_geometry: FluidGeometry<'a, D>,
    fluid: FluidForm<'a, D>,
    sides: Vec<BodySide<'a, D>>,
}

impl<'a, const D: usize> StepForms<'a, D> {
    /// The forms of a step.
    pub fn new(setup: &'a Setup<D>, geometry: &'a StepGeometry<D>, system: &StepSystem<D>) -> Self {
        let sides = setup.bodies.iter().zip(&system.bodies).map(|(body, unknown)| match (&body.kind, unknown) {
            (BodyKind::Prescribed(given), _) => {
                BodySide::Prescribed { velocity: given.velocity.as_ref(), time: system.time }
            }
            (BodyKind::Elastic(_), Some((field, _))) => BodySide::Elastic { field: *field, boundary: body.boundary() },
            (BodyKind::Elastic(_), None) => unreachable!("elastic bodies have a field"),
        });
        Self {
            fluid_geometry: fluid_geometry(setup, geometry),
            fluid: system.fluid_form(setup),
            sides: sides.collect(),
        }
    }
}

/// The coupled problem of one step; the order of its contributions is that of Eq. (11) of the paper.
pub struct FsiProblem<'a, const D: usize> {
    system: &'a StepSystem<D>,
    space: &'a XfemSpace<D>,
    fluid_cells: FluidCells<'a, D>,
    convection: FluidConvection<'a, D>,
    fluid_faces: FluidFaces<'a, D>,
    open_boundaries: Vec<OpenBoundary<'a, D>>,
    solids: Vec<(LinearCells<'a, D>, InternalWorkCells<'a, D>)>,
    loads: Vec<SolidFacets<'a, D>>,
    /// The interface.
    pub interface: InterfacePieces<'a, D>,
    /// The contacts, in the order of the setup.
    pub contacts: Vec<ContactFacets<'a, D>>,
}

impl<'a, const D: usize> FsiProblem<'a, D> {
    /// Composes the problem.
    ///
    /// # Errors
    /// [`SetupError`]: a solid or contact does not fit.
    pub fn new(
        setup: &'a Setup<D>,
        geometry: &'a StepGeometry<D>,
        system: &'a StepSystem<D>,
        forms: &'a StepForms<'a, D>,
        previous: &State<D>,
    ) -> Result<Self, SetupError> {
        let fields = system.fields();
        let mut solids = Vec::new();
        let mut loads = Vec::new();
        for (body, unknown) in setup.bodies.iter().zip(&system.bodies) {
            let (BodyKind::Elastic(elastic), Some((field, rule))) = (&body.kind, unknown) else { continue };
            let refuse = |source| SetupError::Solid { body: body.name.clone(), source };
            let cells = SolidCells::new(&elastic.solid, &elastic.form, rule, &system.layout, *field).map_err(refuse)?;
            solids.push((cells.linear(), cells.internal_work()));
            for (facets, term) in &elastic.loads {
                loads.push(
                    SolidFacets::new(&elastic.solid, term.as_ref(), facets, rule, &system.layout, *field)
                        .map_err(refuse)?,
                );
            }
        }
        let contacts = setup
            .contacts
            .iter()
            .enumerate()
            .map(|(index, contact)| contact_facets(setup, geometry, system, previous, index, contact))
            .collect::<Result<_, _>>()?;
        let fluid_geometry = &forms.fluid_geometry;
        Ok(Self {
            system,
            space: &geometry.space,
            fluid_cells: FluidCells { geometry: fluid_geometry, fields, form: &forms.fluid },
            convection: FluidConvection { geometry: fluid_geometry, fields, form: &forms.fluid },
            fluid_faces: FluidFaces::new(fluid_geometry, fields, &forms.fluid),
            open_boundaries: open_boundaries(setup, geometry, system, fluid_geometry),
            solids,
            loads,
            interface: InterfacePieces {
                geometry: fluid_geometry,
                fields,
                values: &geometry.pieces,
                bodies: &forms.sides,
                form: &system.mortar,
            },
            contacts,
        })
    }

    /// The previous state on the new space, as a starting guess.
    pub fn initial_guess(&self, geometry: &StepGeometry<D>, previous: &State<D>) -> Vec<f64> {
        let layout = &self.system.layout;
        let mut x = vec![0.0; layout.len()];
        let velocity = &mut x[layout.range(self.system.velocity)];
        for (slot, u) in velocity.chunks_exact_mut(D).zip(&geometry.history.values) {
            slot.copy_from_slice(u.as_slice());
        }
        let pressure = &mut x[layout.range(self.system.pressure)];
        for (slot, source) in pressure.iter_mut().zip(&geometry.history.sources) {
            *slot = source.map_or(0.0, |dof| previous.fluid.pressure[dof as usize]);
        }
        for (unknown, state) in self.system.bodies.iter().zip(&previous.bodies) {
            let Some((field, _)) = unknown else { continue };
            for (slot, v) in x[layout.range(*field)].chunks_exact_mut(D).zip(&state.velocity) {
                slot.copy_from_slice(v.as_slice());
            }
        }
        x
    }
}

fn open_boundaries<'a, const D: usize>(
    setup: &'a Setup<D>,
    geometry: &'a StepGeometry<D>,
    system: &'a StepSystem<D>,
    fluid_geometry: &'a FluidGeometry<'a, D>,
) -> Vec<OpenBoundary<'a, D>> {
    let open = |tag: Tag, traction: Option<&'a crate::TractionField<D>>, backflow: bool| OpenBoundary {
        geometry: fluid_geometry,
        fields: system.fields(),
        values: BoundaryValues::new(&setup.background, &geometry.cut, tag, BOUNDARY_DEGREE),
        traction: Traction { traction: traction.map(|t| t.as_ref() as _), time: system.time },
        backflow: backflow.then_some(Backflow { density: setup.fluid.material.density }),
    };
    setup
        .fluid
        .boundary
        .iter()
        .filter_map(|(tag, condition)| match condition {
            FluidBoundary::Open { traction, backflow } if traction.is_some() || *backflow => {
                Some(open(*tag, traction.as_ref(), *backflow))
            }
            _ => None,
        })
        .collect()
}

fn contact_facets<'a, const D: usize>(
    setup: &'a Setup<D>,
    geometry: &'a StepGeometry<D>,
    system: &'a StepSystem<D>,
    previous: &State<D>,
    index: usize,
    contact: &'a Contact<D>,
) -> Result<ContactFacets<'a, D>, SetupError> {
    let refuse = |source| SetupError::Contact { index, source };
    let body = |id: BodyId| -> Result<ContactBody<'a, D>, SetupError> {
        let Some((field, rule)) = &system.bodies[id.index()] else {
            return Err(SetupError::NotElastic { index, body: id });
        };
        let boundary = setup.bodies[id.index()].boundary();
        let positions = &geometry.positions[id.index()];
        ContactBody::new(boundary, positions, rule.displacement_per_velocity(), &system.layout, *field).map_err(refuse)
    };
    let fastest =
        |id: BodyId| previous.bodies[id.index()].velocity.iter().map(Vector::norm).fold(0.0, f64::max) * system.dt;
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

impl<const D: usize> NonlinearProblem for FsiProblem<'_, D> {
    fn layout(&self) -> &BlockLayout {
        &self.system.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        let mut all: Vec<&dyn Contributions> = vec![&self.fluid_cells, &self.convection, &self.fluid_faces];
        all.extend(self.open_boundaries.iter().map(|c| c as &dyn Contributions));
        for (linear, internal_work) in &self.solids {
            all.push(linear);
            all.push(internal_work);
        }
        all.extend(self.loads.iter().map(|c| c as &dyn Contributions));
        all.push(&self.interface);
        all.extend(self.contacts.iter().map(|c| c as &dyn Contributions));
        all
    }

    fn constraints(&self) -> &Constraints {
        &self.system.constraints
    }

    /// Unknowns of the fluid by vertex, component and place among the dofs of the vertex; those of bodies by field and
    /// position.
    fn keys(&self) -> Vec<u64> {
        let n_vertices = self.space.vertices().iter().map(|v| v.index() + 1).max().unwrap_or(0);
        let mut seen = vec![0_u64; n_vertices];
        let scalar: Vec<u64> = self
            .space
            .vertices()
            .iter()
            .map(|vertex| {
                let place = &mut seen[vertex.index()];
                *place += 1;
                (*place - 1) << 32 | vertex.index() as u64
            })
            .collect();
        let layout = &self.system.layout;
        let tag = |field: FieldId, component: usize| (field.0 as u64) << 56 | (component as u64) << 52;
        let mut keys = Vec::with_capacity(layout.len());
        keys.extend(scalar.iter().flat_map(|key| (0..D).map(move |a| tag(self.system.velocity, a) | key)));
        keys.extend(scalar.iter().map(|key| tag(self.system.pressure, 0) | key));
        for (field, _) in self.system.bodies.iter().flatten() {
            keys.extend((0..layout.range(*field).len()).map(|k| tag(*field, 0) | k as u64));
        }
        keys
    }

    fn regime(&self, x: &[f64]) -> u64 {
        self.contacts.iter().fold(0, |hash, contact| hash.rotate_left(1) ^ contact.regime(x))
    }
}
