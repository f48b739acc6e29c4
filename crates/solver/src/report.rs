//! Reports of time steps.

use std::time::Instant;

use algebra::NewtonReport;
use algebra::time::Weights;
use body::{Balance, BodyState};
use contact::{ContactReport, ContactSites};
use cutcell::CutReport;
use interface_dg::{InterfaceFlow, InterfaceTraction, Pocket, interface_flow, interface_tractions};
use mesh::{BodyId, Coordinates, Point, Vector};

use crate::fluid_step::FluidStep;
use crate::ledger::Solution;
use crate::setup::Contact;
use crate::state::KineticProducts;
use crate::{Error, Ledger, Problem, Setup, SideForce, Step, StepSeconds, Substep};

/// Forces on a movable body at the stage of a step. Inertia is the sum of the others, up to the error of the nonlinear
/// solve, in every direction without supports and loads.
///
/// Units: force (2D: per unit depth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceBalance<const D: usize> {
    /// Rate of change of momentum at the stage of the step; implicit Euler: `m (v^{n+1} - v^n)/Δt`.
    pub inertia: Vector<D>,
    /// Body force.
    pub body_force: Vector<D>,
    /// Pressure of the fluid on wet and closed parts of the surface. On bodies that deform it acts at the positions of
    /// [`interface_dg::MovedSurface`].
    pub pressure: Vector<D>,
    /// Viscous traction of the fluid.
    pub viscous: Vector<D>,
    /// Exchange of the fluid's traction for that of the solid, `(1 - α) (T^s - T^f) n`; zero for `α = 1`.
    pub exchange: Vector<D>,
    /// Penalty of the mortar.
    pub penalty: Vector<D>,
    /// Contacts, as slave and as master.
    pub contact: Vector<D>,
}

impl<const D: usize> ForceBalance<D> {
    /// Returns the balance without the components that cancel over the whole body ([`Coordinates::resultant`]).
    fn resultant(self, coordinates: Coordinates) -> Self {
        let of = |force| coordinates.resultant(force);
        Self {
            inertia: of(self.inertia),
            body_force: of(self.body_force),
            pressure: of(self.pressure),
            viscous: of(self.viscous),
            exchange: of(self.exchange),
            penalty: of(self.penalty),
            contact: of(self.contact),
        }
    }

    /// Returns the inertia minus all other forces of this balance. It is the force of supports and loads.
    pub fn remainder(&self) -> Vector<D> {
        self.inertia - self.body_force - self.pressure - self.viscous - self.exchange - self.penalty - self.contact
    }
}

/// One body at the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyReport<const D: usize> {
    /// Energies, mass, centre, momentum; `None` for a body of prescribed motion.
    pub balance: Option<Balance<D>>,
    /// Forces at the stage of the step; `None` for a body of prescribed motion.
    pub forces: Option<ForceBalance<D>>,
    /// Index and position of the vertex with the lowest last coordinate.
    pub lowest: (usize, Point<D>),
    /// Velocity of that vertex.
    pub lowest_velocity: Vector<D>,
    /// Change of the velocity of that vertex over the step, per time.
    pub lowest_acceleration: Vector<D>,
    /// Largest last coordinate.
    pub highest: f64,
}

/// The fluid and its interface in one step.
#[derive(Clone, Debug)]
pub struct FluidReport<const D: usize> {
    /// The cut.
    pub cut: CutReport,
    /// Volume (2D: area), on the geometry of the step.
    pub volume: f64,
    /// Kinetic energy, on the geometry of the step.
    pub kinetic_energy: f64,
    /// Flow through the interface.
    pub flow: InterfaceFlow,
    /// Tractions on the interface pieces of the step.
    pub tractions: Vec<InterfaceTraction<D>>,
    /// Force and moment of the fluid on each part of the background's boundary, in the order of
    /// [`crate::FluidSetup::boundary`]; zero for parts that fluid may cross.
    pub side_forces: Vec<SideForce<D>>,
    /// Number of uncovered dofs, whose history is an extension.
    pub n_uncovered: usize,
    /// Number of pockets of fluid whose mean pressure was fixed.
    pub n_pockets: usize,
    /// Largest net flow that given velocities let into a pocket or out of it, relative to its volume, 1/time; negative
    /// if the pocket shrinks. The fluid is incompressible, so that the solution has a source of this size at one
    /// vertex.
    pub pocket_source: f64,
    /// Kinetic energy that fluid brings in during the step through sides with a given velocity or parallel flow, and
    /// through open ones without a term for inflow.
    pub inflow_energy: f64,
}

/// Diagnostics of one time step.
#[derive(Clone, Debug)]
pub struct StepReport<const D: usize> {
    /// The step or substep.
    pub substep: Substep,
    /// Cause for which the time loop repeats a longer step as this substep and others; `None` for all but the first of
    /// them.
    pub failure: Option<String>,
    /// Newton's method.
    pub newton: NewtonReport,
    /// The fluid, if there is one.
    pub fluid: Option<FluidReport<D>>,
    /// The bodies.
    pub bodies: Vec<BodyReport<D>>,
    /// The contacts.
    pub contacts: Vec<ContactReport<D>>,
    /// The energy of the step, term by term.
    pub ledger: Ledger,
    /// Number of unknowns.
    pub n_dofs: usize,
    /// Wall-clock time of each part of the work.
    pub seconds: StepSeconds,
}

impl<const D: usize> Problem<'_, D> {
    /// Returns the report of a step for its solution `x` and the bodies at its end.
    pub(crate) fn report(
        self,
        substep: Substep,
        x: &[f64],
        ends: &[BodyState<D>],
        newton: NewtonReport,
    ) -> StepReport<D> {
        let clock = Instant::now();
        let step = self.step;
        let reactions = self.equations.reactions(x);
        let products = step.fluid.as_ref().map(|fluid| fluid.products_at_end(&step.layout, x));
        let fluid = step.fluid.as_ref().zip(self.interface.as_ref()).map(|(fluid, interface)| FluidReport {
            cut: fluid.cut.report().clone(),
            volume: fluid.cut.all_parts().map(|part| fluid.parts.moments(part).volume()).sum(),
            kinetic_energy: products.as_ref().map_or(0.0, KineticProducts::energy),
            flow: interface_flow(interface, x),
            tractions: interface_tractions(interface, &fluid.mortar.penalty, x),
            side_forces: fluid.side_forces(&step.layout, x, &reactions),
            n_uncovered: fluid.sources.n_uncovered(),
            n_pockets: step.pockets.len(),
            pocket_source: step.pocket_source(fluid, &reactions),
            inflow_energy: fluid.inflow_energy(&step.layout, x),
        });
        let positions = |id: BodyId| ends[id.index()].positions(step.setup.bodies[id.index()].reference());
        let contact = |(contact, sites): (&Contact<D>, &ContactSites<'_, D>)| {
            let master = contact.master().map(positions).unwrap_or_default();
            ContactReport::new(sites, x, [&positions(contact.body()), &master])
        };
        let mut contacts: Vec<_> = step.setup.contacts.iter().zip(&self.contacts).map(contact).collect();
        let collisions = step.setup.contacts.iter().zip(&step.collisions);
        for (report, (of, collision)) in contacts.iter_mut().zip(collisions) {
            let Some(collision) = collision else { continue };
            let coordinates = step.setup.bodies[of.body().index()].surface().coordinates();
            report.force += coordinates.resultant(collision.force(x));
            report.powers.iter_mut().zip(collision.powers(x)).for_each(|(power, of)| *power += of);
            report.n_active = report.n_active.max(collision.n_active());
        }
        let contact_energy = contacts.iter().map(|contact: &ContactReport<D>| contact.stored_energy).sum();
        let states = step.setup.bodies.iter().zip(step.previous.bodies.iter().zip(ends));
        let balances: Vec<_> = states.map(|(body, (start, end))| [body.balance(start), body.balance(end)]).collect();
        let ledger = self.ledger(&Solution {
            x,
            reactions: &reactions,
            residual_power: newton.residual_power,
            ends,
            balances: &balances,
            products,
            contact_energy,
        });
        let reports = ends.iter().zip(balances).enumerate();
        let mut bodies: Vec<_> = reports.map(|(b, (end, balances))| body_report(step, b, end, balances)).collect();
        for (body, points) in &self.closed {
            if let Some(forces) = &mut bodies[body.index()].forces {
                forces.pressure += points.force(x);
            }
        }
        for (body, surface) in &self.moved {
            if let Some(forces) = &mut bodies[body.index()].forces {
                forces.pressure += surface.force(x);
            }
        }
        add_forces(step, fluid.as_ref(), &contacts, &mut bodies);
        let [assembly, linear] = [newton.seconds_assembly, newton.seconds_linear];
        let seconds = StepSeconds { assembly, linear, report: clock.elapsed().as_secs_f64(), ..step.seconds };
        StepReport {
            substep,
            failure: None,
            newton,
            fluid,
            bodies,
            contacts,
            ledger,
            n_dofs: step.layout.len(),
            seconds,
        }
    }
}

impl<const D: usize> Step<'_, D> {
    /// Returns the largest source of a pocket relative to its volume. The source is the residual of the equation of the
    /// dof whose pressure the pocket prescribes. All other such equations of its parts hold, so that this residual is
    /// the net flow into the pocket.
    fn pocket_source(&self, fluid: &FluidStep<'_, D>, reactions: &[f64]) -> f64 {
        let source = |pocket: &Pocket| {
            let volume: f64 = pocket.parts.iter().map(|part| fluid.parts.moments(*part).volume()).sum();
            reactions[self.layout.dof(fluid.pressure, pocket.dof as usize, 0).index()] / volume
        };
        let larger = |most: f64, source: f64| if source.abs() > most.abs() { source } else { most };
        self.pockets.iter().map(source).fold(0.0, larger)
    }
}

impl<const D: usize> StepReport<D> {
    /// Returns [`Error::Inverted`] if a cell of a body is inside out.
    pub(crate) fn check_volumes(&self, setup: &Setup<D>) -> Result<(), Error> {
        for (body, report) in setup.bodies.iter().zip(&self.bodies) {
            let Some(balance) = &report.balance else { continue };
            let ratio = balance.smallest_volume_ratio;
            if ratio <= 0.0 || ratio.is_nan() {
                let (body, newton) = (body.name().to_owned(), Box::new(self.newton.clone()));
                let place = balance.smallest_volume_at.iter().copied().collect();
                return Err(Error::Inverted { body, place, ratio, newton });
            }
        }
        Ok(())
    }

    /// Adds the work of failed nonlinear solves.
    pub(crate) fn add_work(&mut self, lost: &NewtonReport) {
        self.newton.add_work(lost);
        self.seconds.assembly += lost.seconds_assembly;
        self.seconds.linear += lost.seconds_linear;
    }

    /// Returns the sum of all energies: kinetic of fluid and solids, elastic, of gravity, stored in contacts.
    pub fn total_energy(&self) -> f64 {
        let bodies: f64 = self.bodies.iter().filter_map(|body| Some(body.balance.as_ref()?.energy())).sum();
        let fluid = self.fluid.as_ref().map_or(0.0, |fluid| fluid.kinetic_energy);
        bodies + fluid + self.contact_energy()
    }

    /// Returns the energy stored in contacts.
    pub(crate) fn contact_energy(&self) -> f64 {
        self.contacts.iter().map(|contact| contact.stored_energy).sum()
    }
}

/// Returns the report of body `b` from its state at the end and its balances at the start and at the end.
fn body_report<const D: usize>(
    step: &Step<'_, D>,
    b: usize,
    end: &BodyState<D>,
    [before, balance]: [Option<Balance<D>>; 2],
) -> BodyReport<D> {
    let (body, start, dt) = (&step.setup.bodies[b], &step.previous.bodies[b], step.time.length);
    let positions = end.positions(body.reference());
    let height = |x: &Point<D>| x[D - 1];
    let lowest = (0..positions.len())
        .min_by(|&i, &j| height(&positions[i]).total_cmp(&height(&positions[j])))
        .unwrap_or_default();
    let at = |values: &[Vector<D>]| values.get(lowest).copied().unwrap_or_else(Vector::zeros);
    let forces = before.zip(balance).map(|(before, after)| ForceBalance {
        inertia: inertia(&step.time.weights, &before, &after),
        body_force: after.body_force + body.variable_gravity(step.time.stage()) * after.mass,
        pressure: Vector::zeros(),
        viscous: Vector::zeros(),
        exchange: Vector::zeros(),
        penalty: Vector::zeros(),
        contact: Vector::zeros(),
    });
    BodyReport {
        balance,
        forces,
        lowest: (lowest, at(&positions)),
        lowest_velocity: at(end.velocity()),
        lowest_acceleration: (at(end.velocity()) - at(start.velocity())) / dt,
        highest: positions.iter().map(height).fold(f64::NEG_INFINITY, f64::max),
    }
}

/// Returns the rate of change of the momentum at the stage, by the formulas that advance velocities.
fn inertia<const D: usize>(weights: &Weights, before: &Balance<D>, after: &Balance<D>) -> Vector<D> {
    let (row, alpha) = (&weights.stage_acceleration, weights.alpha_f);
    let at_stage = after.momentum * (1.0 - alpha) + before.momentum * alpha;
    at_stage * row.slope + before.momentum * row.velocity + before.momentum_rate * row.acceleration
}

/// Adds the forces of fluid and contacts on the bodies.
fn add_forces<const D: usize>(
    step: &Step<'_, D>,
    fluid: Option<&FluidReport<D>>,
    contacts: &[ContactReport<D>],
    bodies: &mut [BodyReport<D>],
) {
    if let (Some(fluid), Some(of_step)) = (fluid, &step.fluid) {
        for (piece, traction) in of_step.cut.interface().iter().zip(&fluid.tractions) {
            if let Some(forces) = &mut bodies[piece.body.index()].forces {
                forces.pressure += traction.pressure * traction.measure;
                forces.viscous += (traction.fluid - traction.pressure) * traction.measure;
                forces.exchange += traction.exchange * traction.measure;
                forces.penalty += traction.penalty * traction.measure;
            }
        }
    }
    for (contact, report) in step.setup.contacts.iter().zip(contacts) {
        for (body, force) in [(Some(contact.body()), report.force), (contact.master(), -report.force)] {
            if let Some(forces) = body.and_then(|body| bodies[body.index()].forces.as_mut()) {
                forces.contact += force;
            }
        }
    }
    for (body, report) in step.setup.bodies.iter().zip(bodies) {
        report.forces = report.forces.map(|forces| forces.resultant(body.surface().coordinates()));
    }
}
