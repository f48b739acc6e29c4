//! The energy of a step, term by term.

use algebra::time::Row;
use algebra::{BlockLayout, Contributions, Integral, Term, power};
use body::{Balance, BodyState};
use contact::ContactSites;
use fluid_ns::{FluidCell, FluidCells, FluidFace, face_powers};
use interface_dg::interface_power;

use crate::Problem;
use crate::fluid_step::FluidStep;
use crate::problem::{closed_pressure, contact_work, moved_pressure};
use crate::state::KineticProducts;

/// Energy removed by each part of the discrete problem in a step; negative if the part adds energy.
///
/// The weak form is tested with its own solution `(u, p, v_s)`. Each line is the power of a term times the step, minus
/// the change of the energy of the scheme ([`algebra::time::Weights::of_energy`]) that the term stores: kinetic,
/// elastic, of gravity, of contact. Including `scheme_storage`, the sum of all lines is minus the change of the energy,
/// up to the residual of Newton's method.
///
/// Units: energy (2D: per unit depth).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Change of the sum of all energies.
    pub change: f64,
    /// Transfer to the new domain: kinetic energy of the scheme on the previous space minus that on the new space.
    pub transfer: f64,
    /// Inertia of the fluid: dissipation of its time scheme.
    pub fluid_scheme: f64,
    /// Viscous dissipation `Δt ∫ 2 μ |D(u)|²`.
    pub viscosity: f64,
    /// Convection `Δt c(u, u, u)`. The sign varies; `transfer` and `backflow` balance this line in part.
    pub convection: f64,
    /// Interior penalty of the velocity.
    pub cip_velocity: f64,
    /// Interior penalty of the pressure.
    pub cip_pressure: f64,
    /// Ghost penalty.
    pub ghost_penalty: f64,
    /// Dissipation of the flux along films that cells do not resolve.
    pub film: f64,
    /// Work that the pressure of films does on vapour.
    pub cavitation: f64,
    /// Work against the body force of the fluid.
    pub fluid_force: f64,
    /// Work against the tractions on open boundaries.
    pub open_boundary: f64,
    /// Backflow term on open boundaries. It removes the kinetic energy of the inflow, which is a gain in `convection`.
    pub backflow: f64,
    /// Consistency and adjoint consistency of the mortar.
    pub mortar: f64,
    /// Normal part of the mortar's penalty.
    pub penalty_normal: f64,
    /// Tangential part of the mortar's penalty.
    pub penalty_tangential: f64,
    /// Inertia, internal work and body force of the bodies: dissipation of their time schemes.
    pub body_scheme: f64,
    /// Work against the pressure on the moved surfaces of bodies that deform, minus that at the cut
    /// ([`interface_dg::terms::MovedPressure`]). Its sign varies.
    pub moved_surface: f64,
    /// Work against loads on bodies, also gravity that varies in time, and against pressure on closed surfaces.
    pub loads: f64,
    /// Contacts: work of tractions without the energy that the laws store, and work of collisions. It contains changes
    /// of the stored energy that are not work: by the area of facets, by their division along the edges of the
    /// obstacle, and by the shift of positions if `Δt` changes.
    pub contact: f64,
    /// Work against given velocities: on boundaries, and on bodies of prescribed motion, by the fluid and by contacts.
    pub given_velocities: f64,
    /// Change of the energy that the time scheme stores in accelerations, in addition to the energy at the end of the
    /// step. It is released later. Zero for implicit Euler.
    pub scheme_storage: f64,
    /// All other terms, such as the hoop terms of axisymmetric coordinates.
    pub other: f64,
}

impl Ledger {
    /// Returns the lines with their names, in the order of the fields.
    pub fn lines(&self) -> [(&'static str, f64); 22] {
        [
            ("transfer", self.transfer),
            ("fluid_scheme", self.fluid_scheme),
            ("viscosity", self.viscosity),
            ("convection", self.convection),
            ("cip_velocity", self.cip_velocity),
            ("cip_pressure", self.cip_pressure),
            ("ghost_penalty", self.ghost_penalty),
            ("film", self.film),
            ("cavitation", self.cavitation),
            ("fluid_force", self.fluid_force),
            ("open_boundary", self.open_boundary),
            ("backflow", self.backflow),
            ("mortar", self.mortar),
            ("penalty_normal", self.penalty_normal),
            ("penalty_tangential", self.penalty_tangential),
            ("body_scheme", self.body_scheme),
            ("moved_surface", self.moved_surface),
            ("loads", self.loads),
            ("contact", self.contact),
            ("given_velocities", self.given_velocities),
            ("scheme_storage", self.scheme_storage),
            ("other", self.other),
        ]
    }

    /// Returns the change of the energy that is in no other line: the residual of Newton's method times the solution.
    /// Stored energies cancel in it, so that it does not check their formulas.
    pub fn defect(&self) -> f64 {
        self.change + self.lines().iter().map(|(_, lost)| lost).sum::<f64>()
    }

    /// Returns the largest absolute value of the lines.
    pub fn largest_line(&self) -> f64 {
        self.lines().iter().map(|(_, lost)| lost.abs()).fold(0.0, f64::max)
    }

    /// Returns the loss of the energy of the scheme without work on loads, forces, open boundaries and given
    /// velocities: up to the defect, the sum of all other lines but `scheme_storage`. Negative if energy is generated.
    pub fn dissipation(&self) -> f64 {
        let given = self.given_velocities + self.fluid_force + self.loads + self.open_boundary;
        -self.change - self.scheme_storage - given
    }
}

/// Solution of a step, with the quantities from which its ledger is computed.
#[derive(Clone, Copy)]
pub(crate) struct Solution<'s, const D: usize> {
    /// Values of the unknowns.
    pub(crate) x: &'s [f64],
    /// [`algebra::Equations::reactions`] at `x`.
    pub(crate) reactions: &'s [f64],
    /// [`algebra::NewtonReport::residual_power`].
    pub(crate) residual_power: f64,
    /// Bodies at the end.
    pub(crate) ends: &'s [BodyState<D>],
    /// Balances of each body at the start and at the end.
    pub(crate) balances: &'s [[Option<Balance<D>>; 2]],
    /// Products of the fluid at the end.
    pub(crate) products: Option<KineticProducts>,
    /// Energy stored in contacts at the end.
    pub(crate) contact_energy: f64,
}

impl<const D: usize> Problem<'_, D> {
    /// Returns the ledger of a step.
    pub(crate) fn ledger(&self, solution: &Solution<'_, D>) -> Ledger {
        let step = self.step;
        let Solution { x, reactions, ends, balances, .. } = *solution;
        let (layout, dt, before) = (&step.layout, step.time.length, step.previous);
        let work = |terms: &dyn Contributions| dt * power(terms, x);
        // Means of pockets are removed from `x`, so that it may differ from the prescribed values.
        let prescribed = step.constraints.iter();
        let mut of_constraints: f64 = prescribed.map(|(dof, _)| x[dof.index()] * reactions[dof.index()]).sum();
        of_constraints += step.constraints.offsets().map(|(dof, x)| x * reactions[dof.index()]).sum::<f64>();
        // Prescribed masters of a tied dof prescribe a part of its value.
        for (dof, to) in step.constraints.ties() {
            let given = to.iter().filter_map(|(master, factor)| Some(factor * step.constraints.get(*master)?));
            of_constraints += reactions[dof.index()] * given.sum::<f64>();
        }
        let total = dt * (solution.residual_power + of_constraints);
        let mut ledger = Ledger { given_velocities: -dt * of_constraints, ..Ledger::default() };
        let mut known = 0.0;
        if let (Some(fluid), Some(points)) = (&step.fluid, &self.interface) {
            known += fluid.set_ledger_lines(&mut ledger, layout, x);
            let [carried, start] = fluid.scheme_energies(layout, x);
            let end = solution.products.map_or(0.0, |products| products.scheme_energy(&step.time.weights));
            let change = solution.products.map_or(0.0, |products| products.energy()) - before.fluid_energy();
            let transfer =
                before.fluid.as_ref().map_or(0.0, |fluid| fluid.products.scheme_energy(&step.time.weights)) - carried;
            ledger.transfer = transfer;
            ledger.fluid_scheme -= end - start;
            ledger.change += change;
            ledger.scheme_storage += end - start - transfer - change;
            let in_films = fluid.mortar.in_films(points.clone()).map_or(0.0, |slips| work(&slips));
            let mortar = work(&fluid.mortar.contributions(points.clone())) + in_films;
            known += mortar;
            let power = interface_power(points, &fluid.mortar.penalty, x);
            ledger.penalty_normal = dt * power.penalty_normal;
            ledger.penalty_tangential = dt * power.penalty_tangential;
            ledger.given_velocities += dt * power.given_motion;
            ledger.mortar = mortar - ledger.penalty_normal - ledger.penalty_tangential - dt * power.given_motion;
        }
        for (b, body) in step.bodies.iter().enumerate() {
            let own: f64 = body.contributions(layout).iter().map(|terms| work(terms.as_ref())).sum();
            let loads: f64 = body.loads(layout).iter().map(|terms| work(terms.as_ref())).sum();
            let (body, start, end) = (&step.setup.bodies[b], &before.bodies[b], &ends[b]);
            let energy = |balance: Option<Balance<D>>| balance.map_or(0.0, |balance| balance.energy());
            let scheme_energy = |state: &BodyState<D>, rates: &BodyState<D>, own: f64| {
                let motions = step.time.weights.of_energy.map(|rows| match rows {
                    [Row::DISPLACEMENT, Row::VELOCITY] => own,
                    rows => energy(body.balance(&body.at_rows(state, rates, &rows))),
                });
                0.5 * (motions[0] + motions[1])
            };
            // In the first step the acceleration at the start is unknown, and taken as that at the end.
            let rates = if start.level.acceleration.is_empty() { end } else { start };
            let [at_start, at_end] = balances[b].map(energy);
            let change = at_end - at_start;
            let scheme_change = scheme_energy(end, end, at_end) - scheme_energy(start, rates, at_start);
            // The motions of the scheme are extrapolated from the state, and a material may have no energy there. Then
            // the line has a jump of the energy that the scheme stores, in this step and the next.
            let scheme_change = if scheme_change.is_finite() { scheme_change } else { change };
            ledger.change += change;
            ledger.scheme_storage += scheme_change - change;
            ledger.body_scheme += own - scheme_change;
            ledger.loads += loads;
            known += own + loads;
        }
        ledger.moved_surface = self.moved.iter().map(|(_, surface)| work(&moved_pressure(surface.clone()))).sum();
        known += ledger.moved_surface;
        let by_laws: f64 = self.contacts.iter().map(|sites| work(&contact_work(sites.clone()))).sum();
        // Energy of contacts at the start of a run, which may begin in contact: with velocity zero, the positions at
        // which contact acts do not change in the step.
        let rest = vec![0.0; x.len()];
        let of_start = |sites: &ContactSites<'_, D>| sites.stored_energy(&rest);
        // If the first step is divided, `before.step` is zero in all of its substeps.
        let is_first = before.time == 0.0;
        let contact_before = if is_first { self.contacts.iter().map(of_start).sum() } else { before.contact_energy };
        let contact = by_laws + step.collisions.iter().flatten().map(|collision| work(collision)).sum::<f64>();
        let by_collisions: f64 = step.collisions.iter().flatten().map(|collision| collision.given_power(x)).sum();
        let by_given_motion =
            dt * (by_collisions + self.contacts.iter().map(|sites| sites.given_power(x)).sum::<f64>());
        let contact_change = solution.contact_energy - contact_before;
        ledger.contact = contact + by_given_motion - contact_change;
        ledger.given_velocities -= by_given_motion;
        ledger.change += contact_change;
        known += contact;
        let closed: f64 = self.closed.iter().map(|(_, points)| work(&closed_pressure(points.clone()))).sum();
        ledger.loads += closed;
        known += closed;
        ledger.other = total - known;
        ledger
    }
}

impl<const D: usize> FluidStep<'_, D> {
    /// Sets the lines of the fluid's terms; returns their sum.
    fn set_ledger_lines(&self, ledger: &mut Ledger, layout: &BlockLayout, x: &[f64]) -> f64 {
        let (geometry, fields, form, dt) = (self.geometry(), self.fields(layout), &self.form, self.time.length);
        let mut of_cells: Vec<(&dyn Term<FluidCell<'_, D>>, &mut f64)> = vec![(&form.viscous, &mut ledger.viscosity)];
        of_cells.extend(form.inertia.as_ref().map(|term| (term as _, &mut ledger.fluid_scheme)));
        of_cells.extend(form.convection.as_ref().map(|term| (term as _, &mut ledger.convection)));
        of_cells.extend(form.body_force.as_ref().map(|term| (term as _, &mut ledger.fluid_force)));
        of_cells.extend(form.film.as_ref().map(|term| (term as _, &mut ledger.film)));
        of_cells.extend(form.cavitation.as_ref().map(|term| (term as _, &mut ledger.cavitation)));
        let (terms, lines): (Vec<_>, Vec<_>) = of_cells.into_iter().unzip();
        let powers = Integral::linear("cells", FluidCells::new(geometry, fields), terms).powers(x);
        let mut known = 0.0;
        for (line, power) in lines.into_iter().zip(powers) {
            *line = dt * power;
            known += *line;
        }
        let weights = |face: &FluidFace<'_, D>| {
            [form.cip_velocity.weight(face), form.ghost_penalty.weight(face), form.cip_pressure.weight(face)]
        };
        let of_faces = face_powers(geometry, fields, form.body_force.as_ref(), x, weights).map(|power| dt * power);
        [ledger.cip_velocity, ledger.ghost_penalty, ledger.cip_pressure] = of_faces;
        let open = self.open_terms(layout).iter().map(|terms| dt * power(terms.as_ref(), x)).sum::<f64>();
        ledger.backflow = dt * self.backflow_power(layout, x);
        ledger.open_boundary = open - ledger.backflow;
        known + of_faces.iter().sum::<f64>() + open
    }
}
