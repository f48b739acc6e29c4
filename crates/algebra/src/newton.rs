//! Newton's method with exact tangents and factorisations that are kept while they contract.

use std::time::Instant;

use crate::linear::{LinearError, LinearSolver};
use crate::{BlockLayout, BlockSystem, Constraints, ContributionTiming, Contributions, Workspace};

/// Successive growing corrections, each from an exact tangent, after which an iteration counts as diverged.
const MAX_GROWTHS: usize = 5;

/// A system of equations `Σ residuals of the contributions = 0`.
pub trait NonlinearProblem {
    /// The fields of the unknowns.
    fn layout(&self) -> &BlockLayout;

    /// The contributions to residual and tangent; the same at every call.
    fn contributions(&self) -> Vec<&dyn Contributions>;

    /// Unknowns with a prescribed value.
    fn constraints(&self) -> &Constraints;

    /// For each unknown a number by which it is known again in the problem of another time step, for solvers that keep
    /// old factors; empty if there is nothing to know again.
    fn keys(&self) -> Vec<u64> {
        Vec::new()
    }

    /// A hash of the non-smooth state at `x`, such as the set of facets in contact.
    ///
    /// When it changes the factorisation is renewed, and an iteration that changes it is never the last one.
    fn regime(&self, x: &[f64]) -> u64 {
        let _ = x;
        0
    }
}

/// When to stop, and when to renew the factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Largest accepted error and residual, relative to the state, in scaled norms (see [`newton`]).
    pub tolerance: f64,
    /// Most corrections.
    pub max_iterations: usize,
    /// The factorisation is kept while a correction with it is at most this fraction of the one before. Zero: exact
    /// Newton with one factorisation per correction.
    pub contraction: f64,
    /// Relative residual to which an iterative method solves for a correction.
    pub forcing: f64,
    /// Most halvings of a correction until the scaled residual decreases. Zero: no line search.
    pub max_halvings: usize,
}

impl NewtonSettings {
    /// Keeps factorisations down to a contraction of 0.25; at most 30 corrections; no line search.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_iterations: 30, contraction: 0.25, forcing: 1e-4, max_halvings: 0 }
    }
}

/// What a nonlinear solve did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NewtonReport {
    /// Corrections that were added to the state.
    pub iterations: usize,
    /// Factorisations of the tangent.
    pub factorizations: usize,
    /// Sum of the iterations of the linear solver (refinement steps of a direct one).
    pub linear_iterations: usize,
    /// Row-scaled residual of each iterate, the first one included, relative to the column-scaled state.
    pub residual_history: Vec<f64>,
    /// Column-scaled norm of each correction, relative to that of the state.
    pub correction_history: Vec<f64>,
    /// Wall-clock time of pattern and assembly.
    pub seconds_assembly: f64,
    /// The pattern's share of it.
    pub seconds_pattern: f64,
    /// How often the system was evaluated, with or without its matrix.
    pub assemblies: usize,
    /// Wall-clock time of the linear solver.
    pub seconds_linear: f64,
    /// The factorisations' share of it.
    pub seconds_factorization: f64,
    /// Linear solves.
    pub solves: usize,
    /// Entries of the matrix.
    pub nnz: usize,
    /// Times per contribution.
    pub timings: Vec<ContributionTiming>,
}

/// Why a nonlinear solve stopped; every variant holds the report up to that point with the full histories.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NewtonError {
    /// Corrections from exact tangents kept growing. Try a better starting guess, a smaller step or a line search.
    #[error("Newton diverged after {} iterations", .report.iterations)]
    Diverged {
        /// What was done.
        report: Box<NewtonReport>,
    },
    /// The iteration limit was reached, with `regime_changed` while the regime was still changing.
    #[error("Newton did not converge in {} iterations (last residual {:e})", .report.iterations, last(.report))]
    NotConverged {
        /// Whether the last correction changed the regime.
        regime_changed: bool,
        /// What was done.
        report: Box<NewtonReport>,
    },
    /// The linear system could not be solved.
    #[error("linear solve of Newton iteration {} failed", .report.iterations)]
    Linear {
        /// Why.
        source: LinearError,
        /// What was done.
        report: Box<NewtonReport>,
    },
    /// The residual is infinite or not a number.
    #[error("the residual is not finite after {} Newton iterations", .report.iterations)]
    NotFinite {
        /// What was done.
        report: Box<NewtonReport>,
    },
}

impl NewtonError {
    /// What was done before the error.
    pub fn report(&self) -> &NewtonReport {
        match self {
            Self::Diverged { report }
            | Self::NotConverged { report, .. }
            | Self::Linear { report, .. }
            | Self::NotFinite { report } => report,
        }
    }
}

fn last(report: &NewtonReport) -> f64 {
    report.residual_history.last().copied().unwrap_or(f64::NAN)
}

/// Solves a nonlinear problem from the starting guess `x`, into which the constraints are written first.
///
/// The tangent is factorised at the start, and again when the regime changes or when a correction with an old
/// factorisation is more than `contraction` times the one before; a correction with an old factorisation that does not
/// contract at all is discarded. Otherwise only the residual is evaluated anew (modified Newton).
///
/// **Convergence.** With the row and column scales R, C of the equilibrated tangent and Euclidean norms over the
/// unconstrained dofs, let `s = max(‖C⁻¹ x‖, ‖C⁻¹ x_start‖)` and `θ = ‖C⁻¹ dx‖ / ‖C⁻¹ dx_previous‖`. The state is accepted
/// if, after a full correction dx,
///
/// - the estimated error `θ/(1−θ) ‖C⁻¹ dx‖` is at most `tolerance · s` (for the first correction, which has no θ, the
///   correction itself; zero if every contribution is linear),
/// - the new residual satisfies `‖R r‖ ≤ tolerance · s`,
/// - the correction did not change the regime.
///
/// On error `x` is the starting guess with the constraints applied.
///
/// # Errors
/// See [`NewtonError`].
///
/// # Panics
/// `x` does not have the length of the layout, or a contribution or constraint names a dof outside of it.
pub fn newton(
    problem: &dyn NonlinearProblem,
    x: &mut [f64],
    work: &mut Workspace,
    settings: &NewtonSettings,
) -> Result<NewtonReport, NewtonError> {
    assert_eq!(x.len(), problem.layout().len(), "length of the starting guess");
    problem.constraints().apply(x);
    let contributions = problem.contributions();
    let begin = Instant::now();
    work.prepare(problem.layout(), &contributions, problem.constraints(), problem.keys());
    let n_factorizations = work.solver.n_factorizations();
    let report = NewtonReport {
        seconds_assembly: begin.elapsed().as_secs_f64(),
        seconds_pattern: work.system.seconds_pattern(),
        nnz: work.system.pattern().n_entries(),
        ..NewtonReport::default()
    };
    let mut solve = Solve {
        problem,
        contributions,
        settings,
        start: x.to_vec(),
        previous: vec![0.0; x.len()],
        correction: vec![0.0; x.len()],
        system: &mut work.system,
        solver: work.solver.as_mut(),
        report,
    };
    let outcome = if x.is_empty() { Ok(()) } else { solve.run(x) };
    let Solve { start, mut report, .. } = solve;
    report.timings = work.system.timings().to_vec();
    report.factorizations = work.solver.n_factorizations() - n_factorizations;
    let Err(stop) = outcome else { return Ok(report) };
    x.copy_from_slice(&start);
    let report = Box::new(report);
    Err(match stop {
        Stop::Diverged => NewtonError::Diverged { report },
        Stop::NotConverged { regime_changed } => NewtonError::NotConverged { regime_changed, report },
        Stop::Linear(source) => NewtonError::Linear { source, report },
        Stop::NotFinite => NewtonError::NotFinite { report },
    })
}

/// A reason to stop, before it is joined with the report.
enum Stop {
    Diverged,
    NotConverged { regime_changed: bool },
    Linear(LinearError),
    NotFinite,
}

/// A nonlinear solve on its way.
struct Solve<'a> {
    problem: &'a dyn NonlinearProblem,
    contributions: Vec<&'a dyn Contributions>,
    settings: &'a NewtonSettings,
    start: Vec<f64>,
    previous: Vec<f64>,
    correction: Vec<f64>,
    system: &'a mut BlockSystem,
    solver: &'a mut dyn LinearSolver,
    report: NewtonReport,
}

impl Solve<'_> {
    fn run(&mut self, x: &mut [f64]) -> Result<(), Stop> {
        let tolerance = self.settings.tolerance;
        let mut regime = self.problem.regime(x);
        let mut renew = true;
        let mut n_growths = 0;
        self.assemble(x, true)?;
        loop {
            // Correction at x, where the system is assembled: with its tangent if that is to be renewed.
            if renew {
                self.factorize()?;
            }
            self.solve()?;
            let mut theta = self.contraction();
            if !renew && theta.is_some_and(|t| t >= 1.0) {
                renew = true;
                self.assemble(x, true)?;
                self.factorize()?;
                self.solve()?;
                theta = self.contraction();
            }
            n_growths = if renew && theta.is_some_and(|t| t >= 1.0) { n_growths + 1 } else { 0 };
            let correction = self.column_norm(&self.correction);
            if self.report.residual_history.is_empty() {
                self.report.residual_history.push(ratio(self.row_norm(), self.size(x).max(correction)));
            }
            let step = self.step(x);
            self.report.iterations += 1;
            let correction = ratio(correction, self.size(x));
            self.report.correction_history.push(correction);
            let error = self.error_factor(theta, step) * correction;
            let is_exact = self.settings.contraction <= 0.0;
            renew = is_exact || step < 1.0 || (!renew && theta.is_some_and(|t| t > self.settings.contraction));
            std::mem::swap(&mut self.previous, &mut self.correction);

            // The new state: its regime and residual decide whether it is accepted.
            let old_regime = std::mem::replace(&mut regime, self.problem.regime(x));
            let regime_changed = regime != old_regime;
            renew |= regime_changed;
            let may_stop = error <= tolerance && !regime_changed;
            self.assemble(x, renew && !may_stop)?;
            let residual = ratio(self.row_norm(), self.size(x));
            self.report.residual_history.push(residual);
            if may_stop && residual <= tolerance {
                return Ok(());
            }
            if self.report.iterations >= self.settings.max_iterations {
                return Err(Stop::NotConverged { regime_changed });
            }
            if n_growths >= MAX_GROWTHS {
                return Err(Stop::Diverged);
            }
            if renew && may_stop {
                self.assemble(x, true)?;
            }
        }
    }

    /// Evaluates the residual at `x`, and the matrix if it is wanted.
    fn assemble(&mut self, x: &[f64], with_matrix: bool) -> Result<(), Stop> {
        let begin = Instant::now();
        if with_matrix {
            self.system.assemble(&self.contributions, x);
        } else {
            self.system.assemble_residual(&self.contributions, x);
        }
        self.report.seconds_assembly += begin.elapsed().as_secs_f64();
        self.report.assemblies += 1;
        if self.system.residual().iter().all(|r| r.is_finite()) { Ok(()) } else { Err(Stop::NotFinite) }
    }

    fn factorize(&mut self) -> Result<(), Stop> {
        let begin = Instant::now();
        let outcome = self.solver.factorize(self.system.matrix(), self.system.unknowns());
        let seconds = begin.elapsed().as_secs_f64();
        self.report.seconds_linear += seconds;
        self.report.seconds_factorization += seconds;
        outcome.map_err(Stop::Linear)
    }

    /// Computes the correction with the factorisation at hand; its sign is that of the residual.
    fn solve(&mut self) -> Result<(), Stop> {
        let begin = Instant::now();
        let outcome = self.solver.solve(self.system.residual(), &mut self.correction, self.settings.forcing);
        self.report.seconds_linear += begin.elapsed().as_secs_f64();
        self.report.solves += 1;
        self.report.linear_iterations += outcome.map_err(Stop::Linear)?.iterations;
        Ok(())
    }

    /// `θ`: size of the correction over that of the one before, if there was one.
    fn contraction(&self) -> Option<f64> {
        let previous = self.column_norm(&self.previous);
        (self.report.iterations > 0).then(|| ratio(self.column_norm(&self.correction), previous))
    }

    /// Error after the correction over the size of the correction.
    fn error_factor(&self, theta: Option<f64>, step: f64) -> f64 {
        match theta {
            _ if step < 1.0 => f64::INFINITY,
            _ if self.system.is_linear() => 0.0,
            None => 1.0,
            Some(t) if t < 1.0 => t / (1.0 - t),
            Some(_) => f64::INFINITY,
        }
    }

    /// Subtracts the correction from `x`, halved as often as the line search wants; returns the fraction taken.
    fn step(&mut self, x: &mut [f64]) -> f64 {
        let before = if self.settings.max_halvings > 0 { self.row_norm() } else { f64::INFINITY };
        let mut step = 1.0;
        subtract(x, step, &self.correction);
        for _ in 0..self.settings.max_halvings {
            let decreases = self.assemble(x, false).is_ok() && self.row_norm() <= (1.0 - 1e-4 * step) * before;
            if decreases || before == 0.0 {
                break;
            }
            step *= 0.5;
            subtract(x, -step, &self.correction);
        }
        step
    }

    /// `‖R r‖` over the unconstrained dofs (constrained rows of the residual are zero).
    fn row_norm(&self) -> f64 {
        let scale = self.solver.equilibration().row();
        self.system.residual().iter().zip(scale).map(|(r, s)| (r * s).powi(2)).sum::<f64>().sqrt()
    }

    /// `‖C⁻¹ v‖` over the unconstrained dofs.
    fn column_norm(&self, v: &[f64]) -> f64 {
        let scale = self.solver.equilibration().column();
        let free = v.iter().zip(scale).zip(self.system.constrained()).filter(|(_, constrained)| !**constrained);
        free.map(|((v, s), _)| (v / s).powi(2)).sum::<f64>().sqrt()
    }

    /// Size of the state, to which errors are relative.
    fn size(&self, x: &[f64]) -> f64 {
        self.column_norm(x).max(self.column_norm(&self.start))
    }
}

fn subtract(x: &mut [f64], factor: f64, correction: &[f64]) {
    for (x, dx) in x.iter_mut().zip(correction) {
        *x -= factor * dx;
    }
}

/// A quotient of norms that is zero if the first one is.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
