//! The solve of a step, repeated until the multipliers of contacts and the points of collisions no longer change.

use std::time::Instant;

use algebra::{Anderson, NewtonError, NewtonReport, NewtonSettings, Workspace, newton};
use contact::{Multipliers, StressSource};

use crate::{Error, Step};

/// Largest number of solves of a step in which multipliers change.
const MOST_SOLVES: usize = 200;
/// Number of differences of multipliers with which their iteration is accelerated.
const DEPTH: usize = 8;
/// Tolerance to which a step with a collision is refined, relative to that of other steps.
const IN_COLLISION: f64 = 1e-4;
/// Smallest tolerance that a collision sets, well above round-off.
const LEAST_TOLERANCE: f64 = 1e-12;

impl<const D: usize> Step<'_, D> {
    /// Solves the step from the guess `x` by Newton's method. With [`contact::AugmentedLagrangianLaw`] the tractions of
    /// contact become the multipliers of another solve, until they no longer change. A collision at several points is
    /// solved again with the points that push.
    ///
    /// The pressure of each pocket has the mean zero. The report, also that of an error, contains the counts and times
    /// of all solves, and the history of the last one.
    ///
    /// # Errors
    /// Newton's method fails, or the multipliers still change after the largest number of solves.
    pub(crate) fn solve(&mut self, x: &mut [f64], work: &mut Workspace) -> Result<NewtonReport, Error> {
        let mut report = self.solve_from(x, true, work)?;
        let (first, multipliers, mut anderson) = (x.to_vec(), self.multipliers(), Anderson::new(DEPTH));
        let mut settled = self.settle(x, work, &mut anderson, &mut report);
        if settled.is_err() && anderson.is_accelerated() {
            // Accelerated multipliers may be those of no state, or never settle.
            x.copy_from_slice(&first);
            self.set_multipliers(&multipliers);
            settled = self.settle(x, work, &mut Anderson::new(0), &mut report);
        }
        settled?;
        self.refine_collision(x, work, &mut report);
        self.remove_pressure_means(x);
        Ok(report)
    }

    /// Solves the step again from its solution `x` until multipliers and points of collisions no longer change. The
    /// work is added to the report.
    fn settle(
        &mut self,
        x: &mut [f64],
        work: &mut Workspace,
        anderson: &mut Anderson,
        report: &mut NewtonReport,
    ) -> Result<(), Error> {
        let mut solves = 1;
        loop {
            // Each point of a collision is added at most a given number of times, so that collisions settle.
            let has_other_points = self.settle_collisions(x);
            if has_other_points {
                anderson.forget();
            }
            let clock = Instant::now();
            let unsettled = self.augment(x, anderson);
            self.seconds.multipliers += clock.elapsed().as_secs_f64();
            match unsettled {
                None if !has_other_points => return Ok(()),
                Some(Unsettled { contact, change, accepted }) if !has_other_points && solves >= MOST_SOLVES => {
                    let newton = Box::new(report.clone());
                    return Err(Error::Multipliers { contact, solves, change, accepted, newton });
                }
                _ => {}
            }
            let before = report.clone();
            let mut solved = self.solve_from(x, false, work);
            *report = solved.as_mut().map_or_else(|error| error.report_mut().clone(), |last| last.clone());
            report.add_work(&before);
            solved.map_err(|mut error| {
                *error.report_mut() = report.clone();
                error
            })?;
            solves += 1;
        }
    }

    /// Solves the step by Newton's method from the guess `x`. Without inertia, bodies at rest are another guess, with
    /// which `is_first` solves begin and which others use if the first one fails: contact may hold bodies at one guess
    /// and not at the other, where the matrix is singular. The motion of the step before may carry a body out of
    /// contact, contact may end at the places of the start, and smaller multipliers open it at a distance above the
    /// offset.
    fn solve_from(&self, x: &mut [f64], is_first: bool, work: &mut Workspace) -> Result<NewtonReport, NewtonError> {
        let (equations, settings) = (&self.problem().equations, &self.setup.newton);
        let mut other = self.guess_at_rest();
        if self.time.weights.has_inertia() || other == x {
            return newton(equations, x, work, settings);
        }
        if is_first {
            x.swap_with_slice(&mut other);
        }
        newton(equations, x, work, settings).or_else(|mut failed| {
            x.swap_with_slice(&mut other);
            let mut solved = newton(equations, x, work, settings);
            let report = solved.as_mut().unwrap_or_else(|error| error.report_mut());
            report.add_work(failed.report_mut());
            solved
        })
    }

    /// Solves a step with a collision to a smaller tolerance: the weight of a collision amplifies errors of velocities,
    /// which are below the tolerance, to errors of its force. If that fails, the solution is kept as it is.
    fn refine_collision(&self, x: &mut [f64], work: &mut Workspace, report: &mut NewtonReport) {
        let settings = self.setup.newton;
        let tolerance = (IN_COLLISION * settings.tolerance).max(LEAST_TOLERANCE);
        if !self.has_collision() || tolerance >= settings.tolerance {
            return;
        }
        let mut refined = x.to_vec();
        let settings = NewtonSettings { tolerance, ..settings };
        match newton(&self.problem().equations, &mut refined, work, &settings) {
            Ok(last) => {
                x.copy_from_slice(&refined);
                report.residual_power = last.residual_power;
                report.add_work(&last);
            }
            Err(mut error) => report.add_work(error.report_mut()),
        }
    }

    /// Subtracts the mean from the pressure of each pocket, whose constant the equations do not determine.
    fn remove_pressure_means(&self, x: &mut [f64]) {
        let Some(fluid) = &self.fluid else { return };
        let pressure = &mut x[self.layout.range(fluid.pressure)];
        self.pockets.iter().for_each(|pocket| pocket.remove_mean(fluid.geometry(), pressure));
    }

    /// Sets the points of collisions that act in the next solve. Returns whether they have changed.
    fn settle_collisions(&mut self, x: &[f64]) -> bool {
        self.collisions.iter_mut().flatten().fold(false, |changed, collision| collision.settle(x) | changed)
    }

    /// Returns the components of the multipliers of all contacts that have some, in order.
    fn multipliers(&self) -> Vec<f64> {
        let contacts = self.setup.contacts.iter().zip(&self.contacts);
        let with_multipliers = contacts.filter(|(contact, _)| contact.form().law.stress() == StressSource::Multiplier);
        with_multipliers.flat_map(|(_, step)| step.multipliers()).collect()
    }

    /// Sets the multipliers of the next solve, for all contacts in order.
    fn set_multipliers(&mut self, mut components: &[f64]) {
        let contacts = self.setup.contacts.iter().zip(&mut self.contacts);
        let with_multipliers = contacts.filter(|(contact, _)| contact.form().law.stress() == StressSource::Multiplier);
        with_multipliers.for_each(|(_, step)| step.set_multipliers(&mut components));
    }

    /// Sets the multipliers of the next solve. Returns the contact whose multipliers changed most, compared with what
    /// its law accepts; `None` if all changes are accepted.
    fn augment(&mut self, x: &[f64], anderson: &mut Anderson) -> Option<Unsettled> {
        let contacts = || self.setup.contacts.iter().zip(&self.contacts);
        let found: Vec<Option<Multipliers>> =
            contacts().map(|(contact, step)| step.sites(contact, self.refs()).multipliers(x)).collect();
        let changes = found.iter().zip(&self.setup.contacts).enumerate();
        let changes = changes.filter_map(|(index, (found, contact))| {
            let Multipliers { change, largest, .. } = *found.as_ref()?;
            let accepted = contact.form().law.accepted_change(largest);
            (change > accepted).then_some(Unsettled { contact: index, change, accepted })
        });
        let unsettled = changes.reduce(|a, b| if b.ratio() > a.ratio() { b } else { a })?;
        // Relative to what the laws accept: contacts may have pressures of different magnitudes.
        let found = found.into_iter().zip(&self.setup.contacts);
        let found =
            found.filter_map(|(found, contact)| Some((found?, contact.form().law.accepted_change(f64::INFINITY))));
        let (mut components, mut scales) = (Vec::new(), Vec::new());
        for (found, scale) in found {
            components.extend(found.components.iter().map(|component| component / scale));
            scales.resize(components.len(), scale);
        }
        let next: Vec<f64> = anderson.next(components).iter().zip(scales).map(|(next, scale)| next * scale).collect();
        self.set_multipliers(&next);
        Some(unsettled)
    }
}

/// A contact whose multipliers have changed by more than its law accepts.
struct Unsettled {
    contact: usize,
    change: f64,
    accepted: f64,
}

impl Unsettled {
    /// Returns the change relative to what is accepted.
    fn ratio(&self) -> f64 {
        self.change / self.accepted
    }
}
