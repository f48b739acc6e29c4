//! One time step, the entry point for readers.

use algebra::Workspace;

use crate::{Error, Setup, State, Step, StepError, StepReport, Substep};

/// Advances fluid, bodies and contacts by a step or substep, on the geometry at its start, or extrapolated to its stage
/// (generalised-α).
///
/// The result is a function of `setup`, `previous` and `substep`. `work` recycles memory, and factors of some solvers.
///
/// # Errors
/// [`StepError`] has the number of the step, its time and the cause; `previous` is unchanged.
pub fn advance<const D: usize>(
    setup: &Setup<D>,
    previous: &State<D>,
    substep: Substep,
    work: &mut Workspace,
) -> Result<(State<D>, StepReport<D>), StepError> {
    let time = previous.step_time(setup, substep.dt);
    let end = time.end;
    let failed = |error: Error| StepError::at(previous.step + 1, end, error);
    let mut step = Step::prepare(setup, previous, time).map_err(failed)?; // surfaces, cut, space, history, unknowns
    if step.has_collision() && previous.has_accelerations() {
        // Accelerations at the start are not valid in a step in which velocities jump.
        return advance(setup, &previous.clone().without_accelerations(), substep, work);
    }
    let mut x = step.guess();
    // Newton's method, repeated until multipliers of contacts and points of collisions no longer change.
    let solve = step.solve(&mut x, work).map_err(failed)?;
    let bodies = step.bodies_at_end(&x);
    step.check_contacts(&x, &bodies, &solve).map_err(failed)?;
    let problem = step.problem(); // contributions in the order of Eq. (11)
    let report = problem.report(substep, &x, &bodies, solve); // consumes the problem, which borrows the step
    report.check_volumes(setup).map_err(failed)?;
    Ok((step.finish(substep, &x, bodies, report.contact_energy()), report)) // moves cut and space into the new state
}
