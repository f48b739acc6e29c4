//! The time loop.

use std::iter::successors;

use algebra::{NewtonReport, Workspace};

use crate::approach::longest_step;
use crate::{Error, Observer, Setup, State, StepError, StepView, Substep, advance};

/// A run: the setup, the state so far, and recycled memory.
pub struct TimeLoop<'a, const D: usize> {
    setup: &'a Setup<D>,
    state: State<D>,
    work: Workspace,
    /// Work of failed attempts since the last substep that succeeded.
    lost: NewtonReport,
    /// Cause of the last of these failures.
    failure: Option<String>,
}

impl<'a, const D: usize> TimeLoop<'a, D> {
    /// Creates a run that starts from a state.
    pub fn new(setup: &'a Setup<D>, state: State<D>, work: Workspace) -> Self {
        Self { setup, state, work, lost: NewtonReport::default(), failure: None }
    }

    /// Returns the current state.
    pub fn state(&self) -> &State<D> {
        &self.state
    }

    /// Returns the recycled memory, with the system of the last step.
    pub fn workspace(&self) -> &Workspace {
        &self.work
    }

    /// Passes the state to the observers, then takes `n_steps` steps and passes the state after each of them.
    ///
    /// With [`Setup::approach`] a step is taken in substeps if bodies are close to each other. A step or substep is
    /// repeated in two halves from the same state if [`crate::Error::smaller_step_may_succeed`] holds. Halves are
    /// divided further, up to [`Setup::most_halvings`] times. The next half, and the next step, are tried undivided.
    /// Observers receive the substeps as well ([`crate::StepReport::substep`]). The report of a substep includes the
    /// work of the nonlinear solves that failed before it, and the cause of the last failure.
    ///
    /// # Errors
    /// The first step or observer that fails; the state is the last good one, at the end of a substep if the step was
    /// divided.
    pub fn run(&mut self, n_steps: usize, observers: &mut [&mut dyn Observer<D>]) -> Result<(), StepError> {
        let (step, time) = (self.state.step, self.state.time);
        (self.lost, self.failure) = (NewtonReport::default(), None);
        let start = StepView {
            setup: self.setup,
            previous: &self.state,
            state: &self.state,
            report: None,
            workspace: &self.work,
        };
        for observer in observers.iter_mut() {
            observer.after_step(&start).map_err(|e| StepError::at(step, time, Error::Observer(e)))?;
        }
        for _ in 0..n_steps {
            self.whole_step(observers)?;
        }
        Ok(())
    }

    /// Takes a step of the setup, in as many substeps as the gaps of contacts require.
    fn whole_step(&mut self, observers: &mut [&mut dyn Observer<D>]) -> Result<(), StepError> {
        let mut left = self.setup.dt;
        loop {
            let parts = (left / longest_step(self.setup, &self.state)).ceil().max(1.0);
            let substep = Substep { dt: left / parts, is_last: parts == 1.0 };
            self.step(substep, self.setup.most_halvings, observers)?;
            if substep.is_last {
                return Ok(());
            }
            left -= substep.dt;
        }
    }

    /// Takes a step or substep; if it fails, both halves of it.
    fn step(
        &mut self,
        substep: Substep,
        most_halvings: usize,
        observers: &mut [&mut dyn Observer<D>],
    ) -> Result<(), StepError> {
        match advance(self.setup, &self.state, substep, &mut self.work) {
            Ok((state, mut report)) => {
                report.add_work(&std::mem::take(&mut self.lost));
                report.failure = self.failure.take();
                let view = StepView {
                    setup: self.setup,
                    previous: &self.state,
                    state: &state,
                    report: Some(&report),
                    workspace: &self.work,
                };
                for observer in observers.iter_mut() {
                    observer
                        .after_step(&view)
                        .map_err(|e| StepError::at(state.step, state.time, Error::Observer(e)))?;
                }
                self.state = state;
                Ok(())
            }
            Err(failure) if most_halvings > 0 && failure.source.smaller_step_may_succeed() => {
                if let Some(newton) = failure.source.newton_report() {
                    self.lost.add_work(newton);
                }
                let causes = successors(Some(&failure.source as &dyn std::error::Error), |cause| cause.source());
                self.failure = Some(causes.map(ToString::to_string).collect::<Vec<_>>().join(": "));
                let dt = 0.5 * substep.dt;
                self.step(Substep { dt, is_last: false }, most_halvings - 1, observers)?;
                self.step(Substep { dt, ..substep }, most_halvings - 1, observers)
            }
            Err(failure) => Err(failure),
        }
    }
}
