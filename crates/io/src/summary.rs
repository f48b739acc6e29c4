//! `summary.json`: what a run comes down to.

use std::path::Path;

use serde::{Deserialize, Serialize};
use solver::{BodyKind, StageSeconds, StepReport, StepView};

use crate::Error;
use crate::files::write_whole;
use crate::measures::{BodyMeasures, leading_body};

/// A step may raise the energy by this fraction of the largest energy: round-off.
const ENERGY_TOLERANCE: f64 = 1e-8;
/// Time over which the first mean acceleration is taken, s.
const EARLY: f64 = 0.01;

/// What a run comes down to. Distances, velocities and penetrations are those of the leading body: the slave of the
/// first contact, else the first body that is not moved as it is told, else the first body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// Profile of the interior penalty of the velocity.
    pub profile: String,
    /// Whether forces, masses and energies are those of one half of a symmetric problem.
    pub half_domain: bool,
    /// Time step, s.
    pub dt: f64,
    /// Steps done.
    pub steps: usize,
    /// Steps that were divided, because Newton's method failed or contact may have been missed; not written if there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub divided_steps: usize,
    /// Cells of the background.
    pub cells: usize,
    /// Most unknowns of a step.
    pub dofs: usize,
    /// Most matrix entries of a step.
    pub nnz: usize,
    /// End of the first step with contact.
    pub contact_time: Option<f64>,
    /// End of the first later step without.
    pub release_time: Option<f64>,
    /// Begin and end of each contact; no end if it lasts.
    pub contact_intervals: Vec<(f64, Option<f64>)>,
    /// Largest smallest distance after the first release.
    pub max_height: Option<f64>,
    /// When.
    pub max_height_time: Option<f64>,
    /// Largest violation of the offset.
    pub max_penetration: f64,
    /// The same over the contact size.
    pub max_penetration_over_s: Option<f64>,
    /// Smallest distance.
    pub min_distance: Option<f64>,
    /// Vertical velocity of the centre after 10 ms over that time.
    pub mean_acceleration_10ms: Option<f64>,
    /// Whether no step raised the sum of all energies by more than 1e-8 of the largest.
    pub energy_monotone: bool,
    /// Largest net flow through the interface over the flow that the bodies displace.
    pub max_interface_leak: f64,
    /// Newton corrections.
    pub newton_iterations: usize,
    /// Factorisations.
    pub factorizations: usize,
    /// Wall-clock time so far.
    pub wall_seconds: f64,
    /// Wall-clock time per stage.
    pub seconds: SummarySeconds,
    /// The same in detail: each stage, and within the assembly each contribution.
    #[serde(default)]
    pub timings: Vec<Timing>,
    /// Wall-clock time of one factorisation of the last matrix, measured at the end of the run: the unit that a step is
    /// measured in.
    #[serde(default)]
    pub refactorization_seconds: Option<f64>,
    /// Largest resident memory of the process, where the system tells.
    pub peak_rss_bytes: Option<u64>,
    /// Comparisons with numbers known from elsewhere.
    pub comparisons: Vec<Comparison>,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // what serde asks for
fn is_zero(value: &usize) -> bool {
    *value == 0
}

/// Wall-clock time per stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SummarySeconds {
    /// Cutting.
    pub cut: f64,
    /// Space, history, shape values.
    pub space: f64,
    /// Pattern and assembly.
    pub assembly: f64,
    /// Linear solver.
    pub linear: f64,
    /// Files.
    pub output: f64,
}

/// Wall-clock time of a stage, or of a contribution within a stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The stage.
    pub stage: String,
    /// The contribution, if this is a part of the stage: `fluid cells`, `interface`, ...
    pub contribution: Option<String>,
    /// How often.
    pub calls: usize,
    /// All calls together.
    pub seconds: f64,
}

/// A computed number beside a known one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What.
    pub quantity: String,
    /// The known number.
    pub paper: Option<f64>,
    /// Ours.
    pub computed: Option<f64>,
    /// Ours minus the known one.
    pub deviation: Option<f64>,
    /// Accepted interval.
    pub band: Option<[f64; 2]>,
    /// Whether ours lies in it.
    pub verdict: String,
}

impl Summary {
    /// Adds to the time of a stage, or of a contribution within a stage.
    pub(crate) fn add_timing(&mut self, stage: &str, contribution: Option<&str>, calls: usize, seconds: f64) {
        let is_it = |timing: &&mut Timing| timing.stage == stage && timing.contribution.as_deref() == contribution;
        if let Some(timing) = self.timings.iter_mut().find(is_it) {
            timing.calls += calls;
            timing.seconds += seconds;
        } else {
            let contribution = contribution.map(str::to_owned);
            self.timings.push(Timing { stage: stage.to_owned(), contribution, calls, seconds });
        }
    }

    fn add_timings<const D: usize>(&mut self, report: &StepReport<D>, seconds_output: f64) {
        let (seconds, newton) = (&report.seconds, &report.newton);
        self.add_timing("cut", None, 1, seconds.cut);
        self.add_timing("space", None, 1, seconds.space - seconds.transfer);
        self.add_timing("transfer", None, 1, seconds.transfer);
        self.add_timing("pattern", None, 1, newton.seconds_pattern);
        self.add_timing("assembly", None, newton.assemblies, seconds.assembly - newton.seconds_pattern);
        for timing in newton.timings.iter().filter(|timing| timing.calls > 0) {
            self.add_timing("assembly", Some(timing.name), timing.calls, timing.seconds);
        }
        self.add_timing("factorisation", None, newton.factorizations, newton.seconds_factorization);
        self.add_timing("linear solve", None, newton.solves, seconds.linear - newton.seconds_factorization);
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
    /// [`Error::Read`], [`Error::Json`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        Ok(serde_json::from_str(&text)?)
    }
}

/// Builds a summary from step to step.
#[derive(Clone, Debug)]
pub(crate) struct SummaryBuilder {
    pub(crate) summary: Summary,
    bottom: f64,
    energy: Option<f64>,
    largest_energy: f64,
    largest_rise: f64,
    largest_swept: f64,
}

impl SummaryBuilder {
    pub(crate) fn new(start: Summary, bottom: f64) -> Self {
        let summary = Summary { energy_monotone: true, ..start };
        Self { summary, bottom, energy: None, largest_energy: 0.0, largest_rise: 0.0, largest_swept: 0.0 }
    }

    /// Takes in a step.
    pub(crate) fn add<const D: usize>(&mut self, view: &StepView<'_, D>, seconds_output: f64, wall_seconds: f64) {
        let Some(report) = view.report else {
            self.add_energy(view.state.total_energy(view.setup));
            return;
        };
        let summary = &mut self.summary;
        summary.steps = view.state.step;
        summary.divided_steps += usize::from(view.ends_step() && report.substep.dt < view.setup.dt);
        summary.dofs = summary.dofs.max(report.n_dofs);
        summary.nnz = summary.nnz.max(report.newton.nnz);
        summary.newton_iterations += report.newton.iterations;
        summary.factorizations += report.newton.factorizations;
        summary.wall_seconds = wall_seconds;
        summary.add_timings(report, seconds_output);
        let StageSeconds { cut, space, assembly, linear, .. } = report.seconds;
        let total = &mut summary.seconds;
        for (sum, seconds) in [
            (&mut total.cut, cut),
            (&mut total.space, space),
            (&mut total.assembly, assembly),
            (&mut total.linear, linear),
            (&mut total.output, seconds_output),
        ] {
            *sum += seconds;
        }
        if report.flow.swept > 0.0 {
            // A body at rest displaces nothing: it is measured against a hundredth of what it displaced before.
            self.largest_swept = self.largest_swept.max(report.flow.swept);
            let leak = report.flow.leak_net.abs() / report.flow.swept.max(1e-2 * self.largest_swept);
            summary.max_interface_leak = summary.max_interface_leak.max(leak);
        }
        self.add_energy(report.total_energy());
        if let Some(body) = leading_body(view.setup) {
            self.add_body(view, body);
        }
    }

    fn add_energy(&mut self, energy: f64) {
        self.largest_energy = self.largest_energy.max(energy.abs());
        if let Some(before) = self.energy.replace(energy) {
            self.largest_rise = self.largest_rise.max(energy - before);
        }
        self.summary.energy_monotone = self.largest_rise <= ENERGY_TOLERANCE * self.largest_energy;
    }

    fn add_body<const D: usize>(&mut self, view: &StepView<'_, D>, index: usize) {
        let Some(body) = BodyMeasures::new(view, index, self.bottom) else { return };
        let time = view.state.time;
        let summary = &mut self.summary;
        summary.min_distance = Some(summary.min_distance.map_or(body.d_min, |d| d.min(body.d_min)));
        summary.max_penetration = summary.max_penetration.max(body.max_penetration);
        let size = view.setup.contacts.iter().find(|c| c.body.index() == index).map(|c| c.form.element_size());
        summary.max_penetration_over_s = size.map(|s| summary.max_penetration / s);
        if summary.mean_acceleration_10ms.is_none() && time >= EARLY * (1.0 - 1e-9) {
            // What is prescribed does not fall.
            let falls = !matches!(view.setup.bodies[index].kind, BodyKind::Prescribed(_));
            summary.mean_acceleration_10ms = falls.then(|| body.centre_velocity / time);
        }
        let lasts = summary.contact_intervals.last().is_some_and(|(_, end)| end.is_none());
        match (lasts, body.active_points > 0) {
            (false, true) => summary.contact_intervals.push((time, None)),
            (true, false) => {
                if let Some(last) = summary.contact_intervals.last_mut() {
                    last.1 = Some(time);
                }
            }
            _ => {}
        }
        summary.contact_time = summary.contact_intervals.first().map(|(begin, _)| *begin);
        summary.release_time = summary.contact_intervals.first().and_then(|(_, end)| *end);
        if summary.release_time.is_some() && summary.max_height.is_none_or(|height| body.d_min > height) {
            summary.max_height = Some(body.d_min);
            summary.max_height_time = Some(time);
        }
    }
}

/// Largest resident memory of this process, where `/proc` tells.
pub(crate) fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
