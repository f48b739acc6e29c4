//! What a step reports.

use algebra::NewtonReport;
use contact::ContactReport;
use cutcell::{CutMesh, CutReport};
use interface_dg::{InterfaceFlow, InterfaceTraction, interface_flow, interface_tractions};
use mesh::{Placed, Point, Vector};
use solid_svk::energy::BodyBalance;
use xfem_space::PartValues;

use crate::setup::BodyKind;
use crate::{Body, BodyState, FsiProblem, Setup, State, StepGeometry, StepSystem, Substep};

/// Wall-clock time per stage of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageSeconds {
    /// Cutting the background.
    pub cut: f64,
    /// Space, history, shape values.
    pub space: f64,
    /// The history's share of it.
    pub transfer: f64,
    /// Pattern and assembly.
    pub assembly: f64,
    /// Linear solver.
    pub linear: f64,
}

/// The forces on an elastic or rigid body over a step, of which inertia is the sum: a balance that closes to the accuracy of
/// the nonlinear solve in every direction that no support holds.
///
/// Units (cgs, per unit depth in 2D): dyn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceBalance<const D: usize> {
    /// Rate of change of momentum, `m (v^{n+1} - v^n)/dt`.
    pub inertia: Vector<D>,
    /// Body force.
    pub body_force: Vector<D>,
    /// Pressure of the fluid.
    pub pressure: Vector<D>,
    /// Viscous traction of the fluid.
    pub viscous: Vector<D>,
    /// Penalty of the mortar.
    pub penalty: Vector<D>,
    /// Contacts, as slave.
    pub contact: Vector<D>,
}

impl<const D: usize> ForceBalance<D> {
    /// What supports, loads and contacts as master have to make up for: inertia minus all forces.
    pub fn remainder(&self) -> Vector<D> {
        self.inertia - self.body_force - self.pressure - self.viscous - self.penalty - self.contact
    }
}

/// One body at the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyReport<const D: usize> {
    /// Energies, mass, centre, momentum; `None` for a body of prescribed motion.
    pub balance: Option<BodyBalance<D>>,
    /// Forces over the step; `None` for a body of prescribed motion.
    pub forces: Option<ForceBalance<D>>,
    /// The vertex with the lowest last coordinate, and where it is.
    pub lowest: (usize, Point<D>),
    /// Velocity of that vertex.
    pub lowest_velocity: Vector<D>,
    /// Change of the velocity of that vertex over the step, per time.
    pub lowest_acceleration: Vector<D>,
    /// Largest last coordinate.
    pub highest: f64,
}

/// Everything that a step has to say about itself.
#[derive(Clone, Debug)]
pub struct StepReport<const D: usize> {
    /// The step, or the part of a step.
    pub substep: Substep,
    /// Newton's method.
    pub newton: NewtonReport,
    /// The cut.
    pub cut: CutReport,
    /// The bodies.
    pub bodies: Vec<BodyReport<D>>,
    /// The contacts.
    pub contacts: Vec<ContactReport<D>>,
    /// Kinetic energy of the fluid, on the geometry of the step.
    pub fluid_kinetic_energy: f64,
    /// Flow through the interface.
    pub flow: InterfaceFlow,
    /// Tractions on the interface pieces of the step.
    pub tractions: Vec<InterfaceTraction<D>>,
    /// Number of unknowns.
    pub n_dofs: usize,
    /// Velocity dofs that took their history from a body.
    pub n_uncovered: usize,
    /// Pockets of fluid whose mean pressure was fixed.
    pub n_pockets: usize,
    /// Wall-clock time per stage.
    pub seconds: StageSeconds,
}

impl<const D: usize> StepReport<D> {
    /// The report of a step from its solution `x` and new state.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn new(
        setup: &Setup<D>,
        substep: Substep,
        geometry: &StepGeometry<D>,
        system: &StepSystem<D>,
        problem: &FsiProblem<'_, D>,
        newton: NewtonReport,
        x: &[f64],
        previous: &State<D>,
        state: &State<D>,
        seconds: StageSeconds,
    ) -> Self {
        let contacts: Vec<_> = problem.bodies.contacts.iter().map(|contact| ContactReport::new(contact, x)).collect();
        let tractions = interface_tractions(&problem.interface, x);
        let mut bodies: Vec<_> =
            (0..setup.bodies.len()).map(|b| body_report(setup, b, substep.dt, previous, state)).collect();
        add_forces(setup, &state.fluid.cut, &tractions, &contacts, &mut bodies);
        Self {
            substep,
            cut: state.fluid.cut.report().clone(),
            bodies,
            contacts,
            fluid_kinetic_energy: fluid_kinetic_energy(setup, &geometry.parts, state),
            flow: interface_flow(&problem.interface, x),
            tractions,
            n_dofs: system.layout.len(),
            n_uncovered: geometry.history.n_uncovered(),
            n_pockets: system.pockets.len(),
            seconds: StageSeconds { assembly: newton.seconds_assembly, linear: newton.seconds_linear, ..seconds },
            newton,
        }
    }

    /// Adds the work of nonlinear solves that came to nothing.
    pub(crate) fn add_work(&mut self, lost: &NewtonReport) {
        self.newton.add_work(lost);
        self.seconds.assembly += lost.seconds_assembly;
        self.seconds.linear += lost.seconds_linear;
    }

    /// Sum of all energies: kinetic of fluid and solids, elastic, of gravity, stored in contacts.
    pub fn total_energy(&self) -> f64 {
        let solids: f64 = self
            .bodies
            .iter()
            .filter_map(|body| body.balance.as_ref())
            .map(|b| b.kinetic_energy + b.elastic_energy + b.potential_energy)
            .sum();
        solids + self.fluid_kinetic_energy + self.contacts.iter().map(|c| c.stored_energy).sum::<f64>()
    }
}

fn body_report<const D: usize>(
    setup: &Setup<D>,
    b: usize,
    dt: f64,
    previous: &State<D>,
    state: &State<D>,
) -> BodyReport<D> {
    let body = &setup.bodies[b];
    let now = &state.bodies[b];
    let positions = now.positions(body.reference());
    let height = |x: &Point<D>| x[D - 1];
    let lowest = (0..positions.len())
        .min_by(|&i, &j| height(&positions[i]).total_cmp(&height(&positions[j])))
        .unwrap_or_default();
    let at = |values: &[Vector<D>]| values.get(lowest).copied().unwrap_or_else(Vector::zeros);
    let forces = body.balance(&previous.bodies[b]).zip(body.balance(now)).map(|(before, after)| ForceBalance {
        inertia: (after.momentum - before.momentum) / dt,
        body_force: body.gravity() * after.mass,
        pressure: Vector::zeros(),
        viscous: Vector::zeros(),
        penalty: Vector::zeros(),
        contact: Vector::zeros(),
    });
    BodyReport {
        balance: body.balance(now),
        forces,
        lowest: (lowest, at(&positions)),
        lowest_velocity: at(&now.velocity),
        lowest_acceleration: (at(&now.velocity) - at(&previous.bodies[b].velocity)) / dt,
        highest: positions.iter().map(height).fold(f64::NEG_INFINITY, f64::max),
    }
}

impl<const D: usize> Body<D> {
    /// Acceleration of gravity; none where it has no part in the motion.
    pub(crate) fn gravity(&self) -> Vector<D> {
        match &self.kind {
            BodyKind::Elastic(elastic) => elastic.form.body_force.acceleration,
            BodyKind::Rigid(rigid) => rigid.gravity,
            BodyKind::Prescribed(_) => Vector::zeros(),
        }
    }

    /// Energies, momentum and volume in a state; `None` if the motion is prescribed.
    pub fn balance(&self, state: &BodyState<D>) -> Option<BodyBalance<D>> {
        match (&self.kind, &state.rigid) {
            (BodyKind::Elastic(elastic), _) => {
                Some(BodyBalance::new(&elastic.solid, &elastic.form, &state.displacement, &state.velocity))
            }
            (BodyKind::Rigid(rigid), Some(motion)) => Some(BodyBalance {
                kinetic_energy: motion.kinetic_energy(&rigid.mass),
                elastic_energy: 0.0,
                potential_energy: -rigid.mass.mass * rigid.gravity.dot(&motion.centre),
                mass: rigid.mass.mass,
                centre_of_mass: motion.centre,
                momentum: motion.velocity * rigid.mass.mass,
                volume: Placed::new(&rigid.boundary, &rigid.reference).enclosed_volume(),
                smallest_volume_ratio: 1.0,
            }),
            _ => None,
        }
    }
}

/// Adds what fluid and contacts do to the bodies.
fn add_forces<const D: usize>(
    setup: &Setup<D>,
    cut: &CutMesh<D>,
    tractions: &[InterfaceTraction<D>],
    contacts: &[ContactReport<D>],
    bodies: &mut [BodyReport<D>],
) {
    for (piece, traction) in cut.interface().iter().zip(tractions) {
        if let Some(forces) = &mut bodies[piece.body.index()].forces {
            forces.pressure += traction.pressure * piece.measure;
            forces.viscous += (traction.fluid - traction.pressure) * piece.measure;
            forces.penalty += traction.penalty * piece.measure;
        }
    }
    for (contact, report) in setup.contacts.iter().zip(contacts) {
        if let Some(forces) = &mut bodies[contact.body.index()].forces {
            forces.contact += report.force;
        }
    }
}

impl<const D: usize> State<D> {
    /// Sum of all energies but those stored in contacts: kinetic of fluid and solids, elastic, of gravity.
    pub fn total_energy(&self, setup: &Setup<D>) -> f64 {
        let parts = PartValues::new(&setup.background, &self.fluid.cut, 2);
        let solids = setup.bodies.iter().zip(&self.bodies).filter_map(|(body, state)| {
            let b = body.balance(state)?;
            Some(b.kinetic_energy + b.elastic_energy + b.potential_energy)
        });
        solids.sum::<f64>() + fluid_kinetic_energy(setup, &parts, self)
    }
}

fn fluid_kinetic_energy<const D: usize>(setup: &Setup<D>, parts: &PartValues<D>, state: &State<D>) -> f64 {
    let mut twice = 0.0;
    for part in state.fluid.cut.all_parts() {
        let dofs = state.fluid.space.dofs(part);
        for q in parts.points(part) {
            let u: Vector<D> = dofs.iter().zip(&q.shape).map(|(&k, n)| state.fluid.velocity[k as usize] * *n).sum();
            twice += q.weight * u.norm_squared();
        }
    }
    0.5 * setup.fluid.material.density * twice
}
