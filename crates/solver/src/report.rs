//! What a step reports.

use algebra::NewtonReport;
use contact::ContactReport;
use cutcell::CutReport;
use interface_dg::{InterfaceFlow, InterfaceTraction, interface_flow, interface_tractions};
use mesh::{Point, Vector};
use solid_svk::energy::BodyBalance;

use crate::{FsiProblem, Setup, State, StepGeometry, StepSystem};

/// Wall-clock time per stage of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageSeconds {
    /// Cutting the background.
    pub cut: f64,
    /// Space, history, shape values.
    pub space: f64,
    /// Pattern and assembly.
    pub assembly: f64,
    /// Linear solver.
    pub linear: f64,
}

/// One body at the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyReport<const D: usize> {
    /// Energies, mass, centre, momentum; `None` for a body of prescribed motion.
    pub balance: Option<BodyBalance<D>>,
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
        geometry: &StepGeometry<D>,
        system: &StepSystem<D>,
        problem: &FsiProblem<'_, D>,
        newton: NewtonReport,
        x: &[f64],
        previous: &State<D>,
        state: &State<D>,
        seconds: StageSeconds,
    ) -> Self {
        Self {
            cut: state.fluid.cut.report().clone(),
            bodies: (0..setup.bodies.len()).map(|b| body_report(setup, b, previous, state)).collect(),
            contacts: problem.contacts.iter().map(|contact| ContactReport::new(contact, x)).collect(),
            fluid_kinetic_energy: fluid_kinetic_energy(setup, geometry, state),
            flow: interface_flow(&problem.interface, x),
            tractions: interface_tractions(&problem.interface, x),
            n_dofs: system.layout.len(),
            n_uncovered: geometry.history.n_uncovered(),
            n_pockets: system.pockets.len(),
            seconds: StageSeconds { assembly: newton.seconds_assembly, linear: newton.seconds_linear, ..seconds },
            newton,
        }
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

fn body_report<const D: usize>(setup: &Setup<D>, b: usize, previous: &State<D>, state: &State<D>) -> BodyReport<D> {
    let body = &setup.bodies[b];
    let now = &state.bodies[b];
    let positions = now.positions(body.reference());
    let height = |x: &Point<D>| x[D - 1];
    let lowest = (0..positions.len())
        .min_by(|&i, &j| height(&positions[i]).total_cmp(&height(&positions[j])))
        .unwrap_or_default();
    let at = |values: &[Vector<D>]| values.get(lowest).copied().unwrap_or_else(Vector::zeros);
    BodyReport {
        balance: body
            .elastic()
            .map(|elastic| BodyBalance::new(&elastic.solid, &elastic.form, &now.displacement, &now.velocity)),
        lowest: (lowest, at(&positions)),
        lowest_velocity: at(&now.velocity),
        lowest_acceleration: (at(&now.velocity) - at(&previous.bodies[b].velocity)) / setup.dt,
        highest: positions.iter().map(height).fold(f64::NEG_INFINITY, f64::max),
    }
}

fn fluid_kinetic_energy<const D: usize>(setup: &Setup<D>, geometry: &StepGeometry<D>, state: &State<D>) -> f64 {
    let mut twice = 0.0;
    for part in geometry.cut.all_parts() {
        let dofs = geometry.space.dofs(part);
        for q in geometry.parts.points(part) {
            let u: Vector<D> = dofs.iter().zip(&q.shape).map(|(&k, n)| state.fluid.velocity[k as usize] * *n).sum();
            twice += q.weight * u.norm_squared();
        }
    }
    0.5 * setup.fluid.material.density * twice
}
