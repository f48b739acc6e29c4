//! What one factorisation of a case's matrix costs on this machine, now.

use cutwater::algebra::Workspace;
use cutwater::io::scenario::lower::lower;
use cutwater::io::scenario::{Case, CaseVisitor};
use cutwater::io::{Error, ScenarioFile};
use cutwater::solver::{Stage, State, StepError, advance};

use crate::metrics::median;

/// Number of timed factorisations.
const REPETITIONS: usize = 7;

/// Median time of a numeric factorisation with known pattern, for the matrix of the first step of a scenario.
///
/// # Errors
/// The scenario cannot be lowered, or its first step fails.
pub(crate) fn refactorization_seconds(file: &ScenarioFile) -> Result<f64, Error> {
    lower(file, Refactorization)?
}

struct Refactorization;

impl CaseVisitor for Refactorization {
    type Output = Result<f64, Error>;

    fn visit<const D: usize>(self, case: Case<D>) -> Result<f64, Error> {
        let mut work = Workspace::new();
        advance(&case.setup, &State::initial(&case.setup)?, &mut work)?;
        let failed = |e| StepError::at(1, case.setup.dt, Stage::Observer(Box::new(e)));
        let measured: Result<Vec<f64>, _> = (0..REPETITIONS).map(|_| work.time_refactorization()).collect();
        Ok(median(&mut measured.map_err(failed)?).unwrap_or(f64::INFINITY))
    }
}
