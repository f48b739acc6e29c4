//! `summary.json`: sizes, contacts, checks and times of a run.

use std::path::Path;

use contact::ContactPoint;
use mesh::BodyId;
use serde::{Deserialize, Serialize};
use solver::{Contact, Setup, StepReport, StepView};

use crate::Error;
use crate::energies::Energies;
use crate::files::{read_text, write_whole};
use crate::measures::{BodyMeasures, acts_on, leading_body};
use crate::scenario::{Quantity, Units};

/// Sizes, contacts, checks and times of a run. Distances, penetrations and contacts are those of the leading body: the
/// slave of the first contact, else the first movable body, else the first body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// Dimension of the meshes. In 2D Cartesian coordinates forces, energies and volumes are per unit depth, in
    /// axisymmetric coordinates they are those of the whole.
    pub dimension: usize,
    /// Names of units.
    pub units: UnitLabels,
    /// Name of the set of stabilisation parameters; empty without a fluid.
    pub stabilisation: String,
    /// Whether forces, masses and energies are those of one half of a symmetric problem.
    pub half_domain: bool,
    /// Linear solver, and the reason for it.
    #[serde(default)]
    pub linear_solver: String,
    /// Time step.
    pub dt: f64,
    /// Steps done.
    pub steps: usize,
    /// Steps that were divided, because bodies were close to each other or a step failed. Not written if zero.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub divided_steps: usize,
    /// Cells of the background.
    pub cells: usize,
    /// Largest number of unknowns of a step.
    pub dofs: usize,
    /// Largest number of matrix entries of a step.
    pub nnz: usize,
    /// Names of the bodies, in the order of the columns of `history.csv`.
    #[serde(default)]
    pub bodies: Vec<String>,
    /// Name of the leading body.
    #[serde(default)]
    pub leading: Option<String>,
    /// Distance at which the first contact of the leading body begins.
    #[serde(default)]
    pub contact_offset: Option<f64>,
    /// End of the first step with contact.
    pub contact_time: Option<f64>,
    /// End of the first later step without contact.
    pub release_time: Option<f64>,
    /// Start and end of each contact of the leading body. A contact at the end of the run has no end.
    pub contact_intervals: Vec<(f64, Option<f64>)>,
    /// The two sides of the first contact of the leading body; not written if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_contact: Option<String>,
    /// Smallest gap of all contacts, and its two sides; not written if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest_gap: Option<(f64, String)>,
    /// Largest penetration over the contact size of all contacts with a penalty, and the two sides of its contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deepest_penalty: Option<(f64, String)>,
    /// Largest penetration `[ε - Δ]₊`.
    pub max_penetration: f64,
    /// `max_penetration` divided by the contact size of the first contact with the body as slave.
    pub max_penetration_over_s: Option<f64>,
    /// Smallest [`crate::distance`].
    pub min_distance: Option<f64>,
    /// Bodies that at the last step reach through no-slip sides farther than at the start, by more than the size of
    /// their contacts with obstacles at rest; not written if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<String>,
    /// Pairs of bodies that overlap at the last step and have no contact with each other; not written if there are
    /// none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overlapping: Vec<String>,
    /// Whether no step increased the energy by more than 1e-8 of the energies of the run, without the work of loads,
    /// forces, open boundaries and given velocities, and without increases below twice [`solver::Ledger::defect`]. The
    /// energies of the run are the largest sum of kinetic, elastic
    /// and stored energies and absolute changes of the energy of gravity since the start, here at least the weights of
    /// the bodies times their largest extents.
    pub energy_monotone: bool,
    /// Sum of all increases of the energy in steps, without the same work, divided by the energies of the run or, if it
    /// is larger, the largest line of [`solver::Ledger`]. Increases below the tolerance of Newton's method times the
    /// weights and extents are not counted, and increases below twice [`solver::Ledger::defect`]. None before the first
    /// step, if an energy was not a number, and for `quasi-static`.
    #[serde(default)]
    pub energy_generated: Option<f64>,
    /// Energy that the time scheme takes from bodies in the steps with contact and without collisions, divided by the
    /// energies of the run. It falls with the step. None in the same cases.
    #[serde(default)]
    pub energy_lost_in_contact: Option<f64>,
    /// Energy that the penalty on the normal velocity at surfaces takes, divided by the sum of the energies of the run
    /// and all energy that is lost. It falls with the cells. None in the same cases.
    #[serde(default)]
    pub energy_lost_at_surfaces: Option<f64>,
    /// Largest energy of a step that no line of [`solver::Ledger`] contains, divided by the same energies or line, at
    /// least the weights times the extents, and by the tolerance of Newton's method. None in the same cases.
    #[serde(default)]
    pub energy_defect: Option<f64>,
    /// Largest integral of `|(u - v)·n|` over the interface, divided by the displaced flow. None if bodies rest.
    #[serde(default)]
    pub max_interface_leak: Option<f64>,
    /// Sum over the steps of the largest relative change of the volume of a closed region of fluid by given velocities,
    /// which the fluid cannot follow; negative where it shrinks. None without closed regions.
    #[serde(default)]
    pub closed_volume_change: Option<f64>,
    /// Newton corrections.
    pub newton_iterations: usize,
    /// Factorisations.
    pub factorizations: usize,
    /// Factorisations repeated with pivoting over the whole matrix ([`algebra::NewtonReport::fallbacks`]).
    #[serde(default)]
    pub fallbacks: usize,
    /// Wall-clock time so far, s.
    pub wall_seconds: f64,
    /// Wall-clock time of each task, and within the assembly of each contribution.
    #[serde(default)]
    pub timings: Vec<Timing>,
    /// Largest resident memory of the process, where the operating system reports it.
    pub peak_rss_bytes: Option<u64>,
}

/// Names of the units of a run. In 2D Cartesian coordinates the units of force, energy, moment, power, volume and
/// flow are per unit depth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // each field is the unit of the quantity it names
pub struct UnitLabels {
    pub length: String,
    pub time: String,
    pub velocity: String,
    pub acceleration: String,
    pub force: String,
    pub energy: String,
    #[serde(default)]
    pub moment: String,
    pub volume: String,
    /// Volume per time.
    pub flow: String,
    #[serde(default)]
    pub power: String,
    #[serde(default)]
    pub angular_velocity: String,
}

impl UnitLabels {
    /// Returns the labels, with masses, forces, energies, volumes and flows of a domain of `dimension`.
    pub(crate) fn new(units: &Units, dimension: usize) -> Self {
        let volume = |time| Quantity { length: dimension as i8, mass: 0, time };
        Self {
            length: units.label(Quantity::LENGTH),
            time: units.label(Quantity::TIME),
            velocity: units.label(Quantity::VELOCITY),
            acceleration: units.label(Quantity::ACCELERATION),
            force: units.total_label(Quantity::FORCE, dimension),
            energy: units.total_label(Quantity::ENERGY, dimension),
            moment: units.moment_label(dimension),
            volume: units.label(volume(0)),
            flow: units.label(volume(-1)),
            power: units.total_label(Quantity::POWER, dimension),
            angular_velocity: format!("rad/{}", units.label(Quantity::TIME)),
        }
    }
}

#[allow(clippy::trivially_copy_pass_by_ref)] // the signature that serde requires
fn is_zero(value: &usize) -> bool {
    *value == 0
}

/// Wall-clock time of a task, or of a contribution within a task.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The task: `cut`, `assembly`, ...
    #[serde(alias = "stage")]
    pub task: String,
    /// The contribution, if this is a part of the task: `fluid cells`, `interface`, ...
    pub contribution: Option<String>,
    /// Number of calls.
    pub calls: usize,
    /// Wall-clock time of all calls together, s.
    pub seconds: f64,
}

impl Summary {
    /// Adds to the time of a task, or of a contribution within a task.
    fn add_timing(&mut self, task: &str, contribution: Option<&str>, calls: usize, seconds: f64) {
        let is_it = |timing: &&mut Timing| timing.task == task && timing.contribution.as_deref() == contribution;
        if let Some(timing) = self.timings.iter_mut().find(is_it) {
            timing.calls += calls;
            timing.seconds += seconds;
        } else {
            let contribution = contribution.map(str::to_owned);
            self.timings.push(Timing { task: task.to_owned(), contribution, calls, seconds });
        }
    }

    fn add_timings<const D: usize>(&mut self, report: &StepReport<D>, seconds_output: f64) {
        let (seconds, newton) = (&report.seconds, &report.newton);
        self.add_timing("cut", None, 1, seconds.cut);
        self.add_timing("space", None, 1, seconds.space - seconds.transfer - seconds.search);
        self.add_timing("transfer", None, 1, seconds.transfer);
        self.add_timing("contact search", None, 1, seconds.search);
        self.add_timing("pattern", None, 1, newton.seconds_pattern);
        self.add_timing("assembly", None, newton.assemblies, seconds.assembly - newton.seconds_pattern);
        for timing in newton.timings.iter().filter(|timing| timing.calls > 0) {
            self.add_timing("assembly", Some(timing.name), timing.calls, timing.seconds);
        }
        self.add_timing("factorisation", None, newton.factorizations, newton.seconds_factorization);
        self.add_timing("linear solve", None, newton.solves, seconds.linear - newton.seconds_factorization);
        self.add_timing("multipliers", None, 1, seconds.multipliers);
        self.add_timing("report", None, 1, seconds.report);
        self.add_timing("output", None, 1, seconds_output);
    }

    /// Writes the summary; the file is complete whenever it is visible.
    ///
    /// # Errors
    /// [`Error::Json`], [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        write_whole(path, text.as_bytes())
    }

    /// Reads a summary.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Damaged`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let damaged = |error| Error::Damaged {
            place: path.display().to_string(),
            problem: format!("the file is damaged, not valid JSON of a summary: {error}"),
        };
        serde_json::from_str(&read_text(path)?).map_err(damaged)
    }
}

/// Builder that accumulates a summary step by step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SummaryBuilder {
    pub(crate) summary: Summary,
    energies: Energies,
    largest_swept: f64,
    /// Displaced flow of bodies up to which they are at rest.
    still: f64,
}

/// Largest volume that bodies at rest displace in a step, as a fraction of the volume of the domain.
const STILL: f64 = 1e-12;

impl SummaryBuilder {
    /// Creates the summary of a run. `domain` is the volume of the background.
    pub(crate) fn new(start: Summary, domain: f64) -> Self {
        let still = STILL * domain / start.dt;
        let summary = Summary { energy_monotone: true, ..start };
        Self { summary, energies: Energies::default(), largest_swept: 0.0, still }
    }

    /// Adds a step, with the measures of all bodies and the wall-clock time that output took.
    pub(crate) fn add<const D: usize>(
        &mut self,
        view: &StepView<'_, D>,
        bodies: &[BodyMeasures<'_, D>],
        seconds_output: f64,
    ) {
        let Some(report) = view.report else {
            self.energies = Energies::new(view.setup, view.state);
            return;
        };
        let summary = &mut self.summary;
        summary.steps = view.state.step;
        summary.divided_steps += usize::from(view.ends_step() && report.substep.dt < view.setup.dt);
        summary.dofs = summary.dofs.max(report.n_dofs);
        summary.nnz = summary.nnz.max(report.newton.nnz);
        summary.newton_iterations += report.newton.iterations;
        summary.factorizations += report.newton.factorizations;
        summary.fallbacks += report.newton.fallbacks;
        summary.add_timings(report, seconds_output);
        if let Some(flow) = report.fluid.as_ref().map(|fluid| fluid.flow).filter(|flow| flow.swept > self.still) {
            // A body at rest displaces nothing: the leak is divided by at least a hundredth of the largest displaced
            // flow.
            self.largest_swept = self.largest_swept.max(flow.swept);
            let leak = flow.leak_absolute / flow.swept.max(1e-2 * self.largest_swept);
            summary.max_interface_leak = Some(summary.max_interface_leak.map_or(leak, |largest| largest.max(leak)));
        }
        if let Some(fluid) = report.fluid.as_ref().filter(|fluid| fluid.n_pockets > 0) {
            *summary.closed_volume_change.get_or_insert(0.0) += report.substep.dt * fluid.pocket_source;
        }
        let tolerance = view.setup.newton.tolerance;
        self.energies.add(view, report);
        self.summary.energy_defect = self.energies.defect().map(|defect| defect / tolerance);
        self.summary.energy_monotone = self.energies.is_monotone();
        self.summary.energy_generated = self.energies.generated();
        self.summary.energy_lost_in_contact = self.energies.lost_in_contact();
        self.summary.energy_lost_at_surfaces = self.energies.lost_at_surfaces();
        for (contact, found) in view.setup.contacts.iter().zip(&report.contacts) {
            let least = self.summary.smallest_gap.as_ref().map_or(f64::INFINITY, |(least, _)| *least);
            if let Some(gap) = found.minimum_gap.filter(|gap| *gap < least) {
                self.summary.smallest_gap = Some((gap, sides(view.setup, contact)));
            }
            let form = contact.form();
            let depth = found.largest_penetration / form.size();
            let most = self.summary.deepest_penalty.as_ref().map_or(0.0, |(most, _)| *most);
            if depth > most && form.law.energy_density(&ContactPoint::default()).is_some() {
                self.summary.deepest_penalty = Some((depth, sides(view.setup, contact)));
            }
        }
        if let Some(leading) = leading_body(view.setup) {
            self.add_body(&bodies[leading]);
        }
    }

    fn add_body<const D: usize>(&mut self, body: &BodyMeasures<'_, D>) {
        let (setup, time) = (body.view.setup, body.view.state.time);
        let summary = &mut self.summary;
        summary.min_distance = Some(summary.min_distance.map_or(body.distance, |d| d.min(body.distance)));
        summary.max_penetration = summary.max_penetration.max(body.penetration());
        let size = setup.contacts.iter().find(|c| c.body().index() == body.index).map(|c| c.form().size());
        summary.max_penetration_over_s = size.map(|s| summary.max_penetration / s);
        if summary.first_contact.is_none() {
            let mut contacts = setup.contacts.iter().zip(&body.step.contacts);
            let first = contacts.find(|(contact, found)| acts_on(contact, body.index) && found.is_active());
            summary.first_contact = first.map(|(contact, _)| sides(setup, contact));
        }
        match summary.contact_intervals.last_mut().filter(|(_, end)| end.is_none()) {
            None if body.active_points() > 0 => summary.contact_intervals.push((time, None)),
            Some(lasting) if body.active_points() == 0 => lasting.1 = Some(time),
            _ => {}
        }
        summary.contact_time = summary.contact_intervals.first().map(|(begin, _)| *begin);
        summary.release_time = summary.contact_intervals.first().and_then(|(_, end)| *end);
    }
}

/// Describes the two sides of a contact.
fn sides<const D: usize>(setup: &Setup<D>, contact: &Contact<D>) -> String {
    let name = |body: BodyId| setup.bodies[body.index()].name();
    let slave = name(contact.body());
    match contact.master() {
        None => format!("{slave} and its obstacle at rest"),
        Some(master) if master == contact.body() => format!("{slave} and itself"),
        Some(master) => format!("{slave} and {}", name(master)),
    }
}

/// Returns the largest resident memory of this process, where `/proc` reports it.
pub(crate) fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
