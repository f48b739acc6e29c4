//! The coupled problem of one step, by composition.

use algebra::{BlockLayout, Constraints, Contributions, FieldId, NonlinearProblem};
use fluid_ns::terms::{Backflow, Traction};
use fluid_ns::{FluidCells, FluidConvection, FluidFaces, FluidForm, FluidGeometry, OpenBoundary};
use interface_dg::{BodySide, InterfacePieces};
use mesh::Tag;
use xfem_space::{BoundaryValues, XfemSpace};

use crate::bodies::{self, BodyForms};
use crate::setup::{BodyKind, FluidBoundary};
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
            (BodyKind::Prescribed(given), _) => BodySide::Prescribed {
                velocity: given.velocity.as_ref(),
                times: [system.time - system.dt, system.time],
            },
            (_, Some(unknown)) => BodySide::Unknown { field: unknown.field, boundary: body.boundary() },
            (_, None) => unreachable!("elastic and rigid bodies have a field"),
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
    /// Bodies and contacts.
    pub bodies: BodyForms<'a, D>,
    /// The interface.
    pub interface: InterfacePieces<'a, D>,
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
        let bodies = BodyForms::new(
            &setup.bodies,
            &setup.contacts,
            &system.bodies,
            &system.layout,
            &previous.bodies,
            system.dt,
        )?;
        let fluid_geometry = &forms.fluid_geometry;
        Ok(Self {
            system,
            space: &geometry.space,
            fluid_cells: FluidCells { geometry: fluid_geometry, fields, form: &forms.fluid },
            convection: FluidConvection { geometry: fluid_geometry, fields, form: &forms.fluid },
            fluid_faces: FluidFaces::new(fluid_geometry, fields, &forms.fluid),
            open_boundaries: open_boundaries(setup, geometry, system, fluid_geometry),
            bodies,
            interface: InterfacePieces {
                geometry: fluid_geometry,
                fields,
                values: &geometry.pieces,
                bodies: &forms.sides,
                form: &system.mortar,
            },
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
        bodies::set_velocities(&self.system.bodies, &previous.bodies, layout, &mut x);
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

impl<const D: usize> NonlinearProblem for FsiProblem<'_, D> {
    fn layout(&self) -> &BlockLayout {
        &self.system.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        let mut all: Vec<&dyn Contributions> = vec![&self.fluid_cells, &self.convection, &self.fluid_faces];
        all.extend(self.open_boundaries.iter().map(|c| c as &dyn Contributions));
        all.extend(self.bodies.solids());
        all.push(&self.interface);
        all.extend(self.bodies.contacts());
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
        // 32 bits of vertex, 12 of place, 4 of component, 16 of field.
        let tag = |field: FieldId, component: usize| (field.0 as u64) << 48 | (component as u64) << 44;
        let mut keys = Vec::with_capacity(layout.len());
        keys.extend(scalar.iter().flat_map(|key| (0..D).map(move |a| tag(self.system.velocity, a) | key)));
        keys.extend(scalar.iter().map(|key| tag(self.system.pressure, 0) | key));
        for field in layout.fields().filter(|field| ![self.system.velocity, self.system.pressure].contains(field)) {
            keys.extend((0..layout.range(field).len()).map(|k| tag(field, 0) | k as u64));
        }
        keys
    }

    fn regime(&self, x: &[f64]) -> u64 {
        self.bodies.regime(x)
    }
}
