//! Observers that a program attaches to a run.

use contact::ContactReport;
use solver::{Observer, ObserverError, StepView};

use crate::measures::{distance, leading_body};
use crate::scenario::Case;
use crate::sizes::Sizes;

/// A source of observers for a run. The dimension of the observer is determined when the scenario is read.
///
/// `()` and `None` attach no observer, a pair attaches the observers of both members.
pub trait Watch {
    /// Receives the sizes and the summary of the scenario before the first step.
    fn begin(&mut self, _: &Sizes) {}

    /// Returns the observer of a run, if any. It borrows from `self`, so that the collected data remain after the run.
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>>;
}

impl Watch for () {
    fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        None
    }
}

impl<W: Watch> Watch for Option<W> {
    fn begin(&mut self, sizes: &Sizes) {
        self.iter_mut().for_each(|watch| watch.begin(sizes));
    }

    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        self.as_mut()?.observer(case)
    }
}

impl<W: Watch> Watch for &mut W {
    fn begin(&mut self, sizes: &Sizes) {
        (**self).begin(sizes);
    }

    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        (**self).observer(case)
    }
}

impl<A: Watch, B: Watch> Watch for (A, B) {
    fn begin(&mut self, sizes: &Sizes) {
        self.0.begin(sizes);
        self.1.begin(sizes);
    }

    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        match (self.0.observer(case), self.1.observer(case)) {
            (Some(a), Some(b)) => Some(Box::new(Both(a, b))),
            (a, b) => a.or(b),
        }
    }
}

struct Both<'a, const D: usize>(Box<dyn Observer<D> + 'a>, Box<dyn Observer<D> + 'a>);

impl<const D: usize> Observer<D> for Both<'_, D> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        self.0.after_step(view)?;
        self.1.after_step(view)
    }
}

/// Watch that calls a function before the first step.
pub struct Begin<F>(pub F);

impl<F: FnMut(&Sizes)> Watch for Begin<F> {
    fn begin(&mut self, sizes: &Sizes) {
        (self.0)(sizes);
    }

    fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        None
    }
}

/// Progress of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct StepProgress {
    /// Steps done.
    pub step: usize,
    /// Steps in all.
    pub n_steps: usize,
    /// Time reached.
    pub time: f64,
    /// Distance of the leading body ([`crate::distance`]); `None` without a body.
    pub d_min: Option<f64>,
    /// Smallest gap of all contacts, if there are any.
    pub smallest_gap: Option<f64>,
    /// Newton corrections of the step, or of its last substep if it was divided.
    pub newton_iterations: usize,
    /// Iterations of the linear solver in these corrections.
    pub linear_iterations: usize,
    /// Last relative residual of Newton's method ([`algebra::NewtonReport::residual_history`]).
    pub residual: f64,
    /// Whether the step was divided into substeps, because it failed as a whole or bodies were close to each other.
    pub is_divided: bool,
    /// Cause for which the step, or a part of it, failed and was repeated in substeps; that of the last failure.
    pub failure: Option<String>,
    /// Whether any contact is active.
    pub in_contact: bool,
}

/// Observer that calls a function after every whole step.
pub struct Progress<F>(pub F);

impl<F: FnMut(&StepProgress)> Watch for Progress<F> {
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        Some(Box::new(ProgressObserver {
            call: &mut self.0,
            n_steps: case.n_steps,
            bottom: case.bottom,
            failure: None,
        }))
    }
}

struct ProgressObserver<'a, F> {
    call: &'a mut F,
    n_steps: usize,
    bottom: f64,
    /// Cause of the last failure in the present step.
    failure: Option<String>,
}

impl<F: FnMut(&StepProgress), const D: usize> Observer<D> for ProgressObserver<'_, F> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let failure = view.report.and_then(|report| report.failure.clone());
        self.failure = failure.or(self.failure.take());
        if let Some(report) = view.report.filter(|_| view.ends_step()) {
            (self.call)(&StepProgress {
                step: view.state.step,
                n_steps: self.n_steps,
                time: view.state.time,
                smallest_gap: report.contacts.iter().filter_map(|contact| contact.minimum_gap).reduce(f64::min),
                linear_iterations: report.newton.linear_iterations,
                residual: report.newton.residual_history.last().copied().unwrap_or(0.0),
                is_divided: report.substep.dt < view.setup.dt,
                failure: self.failure.take(),
                d_min: leading_body(view.setup).and_then(|index| distance(view, index, self.bottom)),
                newton_iterations: report.newton.iterations,
                in_contact: report.contacts.iter().any(ContactReport::is_active),
            });
        }
        Ok(())
    }
}
