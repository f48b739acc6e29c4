//! The time loop of the checks, and points, vectors and tensors of the plane.

use cutwater::algebra::{LaggedSettings, LaggedSolver, Workspace};
use cutwater::mesh::{Point, Tensor, Vector};
use cutwater::solver::{Setup, State, StepReport, Substep, advance};

use crate::outcome::Failure;

pub(crate) type P = Point<2>;
pub(crate) type V = Vector<2>;
pub(crate) type T = Tensor<2>;

/// A problem and its state at a time.
pub(crate) struct DirectRun<const D: usize = 2> {
    pub(crate) setup: Setup<D>,
    pub(crate) state: State<D>,
    work: Workspace,
}

impl<const D: usize> DirectRun<D> {
    /// Creates the run of a setup from time zero, with the direct solver.
    pub(crate) fn new(setup: Setup<D>) -> Result<Self, Failure> {
        let state = State::initial(&setup)?;
        Ok(Self { setup, state, work: Workspace::new() })
    }

    /// Creates the run of a setup from time zero, with [`LaggedSolver`].
    pub(super) fn lagged(setup: Setup<D>) -> Result<Self, Failure> {
        let work = Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
        Ok(Self { work, ..Self::new(setup)? })
    }

    /// Takes steps by `step` until it returns a value, or the time is beyond `latest`. Returns the value, if any.
    pub(super) fn until<R>(
        &mut self,
        latest: f64,
        mut step: impl FnMut(&mut Self) -> Result<Option<R>, Failure>,
    ) -> Result<Option<R>, Failure> {
        loop {
            let found = step(self)?;
            if found.is_some() || self.state.time > latest {
                return Ok(found);
            }
        }
    }

    /// Takes some steps, and at least one. Returns the report of the last one.
    pub(super) fn advance_by(&mut self, n_steps: u32) -> Result<StepReport<D>, Failure> {
        for _ in 1..n_steps {
            self.advance()?;
        }
        self.advance()
    }

    /// Takes one step.
    pub(crate) fn advance(&mut self) -> Result<StepReport<D>, Failure> {
        let (state, report) = advance(&self.setup, &self.state, Substep::whole(self.setup.dt), &mut self.work)?;
        self.state = state;
        Ok(report)
    }
}
