//! Unknowns, step rules and forms of one step.

use algebra::{BlockLayout, Constraints, FieldId};
use fluid_ns::terms::{
    BodyForce, CipPressure, CipVelocity, Convection, GhostPenalty, Incompressibility, Inertia, Viscous,
};
use fluid_ns::{FluidFields, FluidForm, FluidGeometry};
use interface_dg::MortarForm;
use xfem_space::boundary_dofs;

use crate::bodies::{self, BodyUnknown};
use crate::setup::FluidBoundary;
use crate::{Pocket, Setup, SetupError, State, StepGeometry, pockets};

/// The unknowns of a step and what is prescribed of them: velocity and pressure of the fluid, then the velocity of
/// each body that has an unknown one.
pub struct StepSystem<const D: usize> {
    /// Where the unknowns lie.
    pub layout: BlockLayout,
    /// Fluid velocity.
    pub velocity: FieldId,
    /// Fluid pressure.
    pub pressure: FieldId,
    /// Velocity of each body; `None` where the motion is prescribed and nobody asks.
    pub bodies: Vec<Option<BodyUnknown<D>>>,
    /// Prescribed unknowns.
    pub constraints: Constraints,
    /// Pockets with a free pressure constant.
    pub pockets: Vec<Pocket>,
    /// Length of the step.
    pub dt: f64,
    /// Time at the end of the step.
    pub time: f64,
    /// The mortar's form.
    pub mortar: MortarForm,
}

impl<const D: usize> StepSystem<D> {
    /// The system of the step of length `dt` after `previous`.
    ///
    /// # Errors
    /// [`SetupError`]: a support does not fit its body.
    pub fn new(setup: &Setup<D>, geometry: &StepGeometry<D>, previous: &State<D>, dt: f64) -> Result<Self, SetupError> {
        let mut layout = BlockLayout::new();
        let velocity = layout.push("velocity", D * geometry.space.len());
        let pressure = layout.push("pressure", geometry.space.len());
        let time = previous.next_time(dt);
        let bodies = bodies::unknowns(&setup.bodies, &setup.contacts, &previous.bodies, (time, dt), &mut layout)?;
        let mut system = Self {
            layout,
            velocity,
            pressure,
            bodies,
            constraints: Constraints::new(),
            pockets: Vec::new(),
            dt,
            time,
            mortar: MortarForm::new(setup.fluid.material, setup.gamma_sigma),
        };
        system.constrain_fluid(setup, geometry);
        bodies::constrain(&setup.bodies, &system.bodies, &system.layout, system.time, &mut system.constraints)?;
        system.pockets = pockets(setup, geometry, &system.layout, &system.bodies, &system.constraints);
        for pocket in &system.pockets {
            system.constraints.set(system.layout.dof(system.pressure, pocket.dof as usize), 0.0);
        }
        Ok(system)
    }

    /// The fluid's fields.
    pub fn fields(&self) -> FluidFields<'_> {
        FluidFields { layout: &self.layout, velocity: self.velocity, pressure: self.pressure }
    }

    /// The fluid's terms.
    pub(crate) fn fluid_form<'a>(&self, setup: &'a Setup<D>) -> FluidForm<'a, D> {
        let fluid = &setup.fluid;
        let (density, viscosity) = (fluid.material.density, fluid.material.viscosity);
        FluidForm {
            inertia: Some(Inertia { density, dt: self.dt }),
            viscous: Viscous { viscosity },
            incompressibility: Incompressibility,
            convection: fluid.convection.map(|skew| Convection { density, skew }),
            body_force: BodyForce { force: fluid.body_force.as_ref().map(|f| f.as_ref() as _), time: self.time },
            cip_velocity: CipVelocity { profile: fluid.cip, density },
            cip_pressure: CipPressure {
                gamma_pressure: fluid.gamma_pressure,
                density,
                viscosity,
                rate: self.dt.recip(),
            },
            ghost_penalty: GhostPenalty { gamma_ghost: fluid.gamma_ghost, viscosity },
        }
    }

    /// Symmetry planes, then prescribed velocities, then walls: where two meet, the later one holds.
    fn constrain_fluid(&mut self, setup: &Setup<D>, geometry: &StepGeometry<D>) {
        let background = &setup.background;
        let dofs = |tag| boundary_dofs(background, &geometry.cut, &geometry.space, tag);
        let row = |dof: u32, a: usize| self.layout.dof(self.velocity, D * dof as usize + a);
        for (tag, condition) in &setup.fluid.boundary {
            if let FluidBoundary::Symmetry { axis } = condition {
                dofs(*tag).into_iter().for_each(|dof| self.constraints.set(row(dof, *axis), 0.0));
            }
        }
        for (tag, condition) in &setup.fluid.boundary {
            if let FluidBoundary::Velocity(velocity) = condition {
                for dof in dofs(*tag) {
                    let value = velocity(&background.vertex(geometry.space.vertex(dof)), self.time);
                    (0..D).for_each(|a| self.constraints.set(row(dof, a), value[a]));
                }
            }
        }
        for (tag, condition) in &setup.fluid.boundary {
            if let FluidBoundary::NoSlip = condition {
                for dof in dofs(*tag) {
                    (0..D).for_each(|a| self.constraints.set(row(dof, a), 0.0));
                }
            }
        }
    }
}

/// What fluid terms see of the geometry of a step.
pub(crate) fn fluid_geometry<'a, const D: usize>(
    setup: &'a Setup<D>,
    geometry: &'a StepGeometry<D>,
) -> FluidGeometry<'a, D> {
    FluidGeometry {
        background: &setup.background,
        cut: &geometry.cut,
        space: &geometry.space,
        parts: &geometry.parts,
        faces: &geometry.faces,
        history: &geometry.history.values,
    }
}
