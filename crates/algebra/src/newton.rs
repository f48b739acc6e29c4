//! Newton's method with exact tangents and factorisations that are kept while they contract.

use std::time::Instant;

use crate::linear::{LinearError, LinearSolver};
use crate::{BlockLayout, BlockSystem, Constraints, ContributionTiming, Contributions, Forcing, Tied, Workspace};

/// Successive growing corrections, each from an exact tangent, after which an iteration counts as diverged.
const MAX_GROWTHS: usize = 5;

/// Largest ratio `θ` of a correction with an old factorisation to the one before. Beyond it the estimated error,
/// `θ/(1-θ)` of the correction, exceeds the correction, which is discarded.
///
/// Source: Deuflhard 2011, Newton methods for nonlinear problems, doi:10.1007/978-3-642-23899-4, Section 2.1.
const USELESS: f64 = 0.5;

/// A system of equations `Σ residuals of the contributions = 0`.
pub struct Equations<'p> {
    /// The fields of the unknowns.
    pub layout: &'p BlockLayout,
    /// The contributions to residual and tangent.
    pub contributions: Vec<Box<dyn Contributions + 'p>>,
    /// Prescribed unknowns, and unknowns tied to others.
    pub constraints: &'p Constraints,
}

impl Equations<'_> {
    /// Returns a hash of the non-smooth state at `x`; see [`Contributions::regime`].
    pub fn regime(&self, x: &[f64]) -> u64 {
        self.contributions.iter().fold(0, |hash, contribution| hash.rotate_left(1) ^ contribution.regime(x))
    }
}

/// Stopping criteria, and criteria for a new factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Largest accepted error and residual, relative to the state, in scaled norms (see [`newton`]).
    pub tolerance: f64,
    /// Most corrections.
    pub max_iterations: usize,
    /// The factorisation is kept while a correction with it is at most this fraction of the one before. Zero: exact
    /// Newton with one factorisation per correction.
    pub contraction: f64,
    /// Accuracy of an iterative solve for a correction.
    pub forcing: Forcing,
    /// Most halvings of a correction until the scaled residual decreases, once corrections with exact tangents have grown.
    /// Zero: no line search.
    pub max_halvings: usize,
}

impl NewtonSettings {
    /// Creates settings that keep a factorisation up to a contraction of 0.25, with at most 30 corrections, adaptive
    /// forcing (1e-3 first, at most 0.1), and at most 8 halvings of a correction.
    pub fn new(tolerance: f64) -> Self {
        let forcing = Forcing { first: 1e-3, largest: 0.1 };
        Self { tolerance, max_iterations: 30, contraction: 0.25, forcing, max_halvings: 8 }
    }
}

/// Statistics of a nonlinear solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NewtonReport {
    /// Corrections that were added to the state.
    pub iterations: usize,
    /// Factorisations of the tangent.
    pub factorizations: usize,
    /// Factorisations that needed free pivoting, as static pivots failed.
    pub fallbacks: usize,
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
    /// Number of evaluations of the system, with or without its matrix.
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

impl NewtonReport {
    /// Adds the counts and times of a failed solve, but not its histories.
    pub fn add_work(&mut self, other: &Self) {
        self.iterations += other.iterations;
        self.factorizations += other.factorizations;
        self.fallbacks += other.fallbacks;
        self.linear_iterations += other.linear_iterations;
        self.seconds_assembly += other.seconds_assembly;
        self.seconds_pattern += other.seconds_pattern;
        self.assemblies += other.assemblies;
        self.seconds_linear += other.seconds_linear;
        self.seconds_factorization += other.seconds_factorization;
        self.solves += other.solves;
        for theirs in &other.timings {
            match self.timings.iter_mut().find(|mine| mine.name == theirs.name) {
                Some(mine) => {
                    mine.calls += theirs.calls;
                    mine.seconds += theirs.seconds;
                }
                None => self.timings.push(theirs.clone()),
            }
        }
    }
}

/// Cause of the end of a nonlinear solve; every variant holds the report up to that point with the full histories.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NewtonError {
    /// Corrections from exact tangents kept growing. Try a better starting guess, a smaller step or a line search.
    #[error("Newton diverged after {} iterations", .report.iterations)]
    Diverged {
        /// Statistics of the solve.
        report: Box<NewtonReport>,
    },
    /// The iteration limit was reached, with `regime_changed` while the regime was still changing.
    #[error("Newton did not converge in {} iterations (last residual {:e})", .report.iterations, last(.report))]
    NotConverged {
        /// Whether the last correction changed the regime.
        regime_changed: bool,
        /// Statistics of the solve.
        report: Box<NewtonReport>,
    },
    /// The linear system could not be solved.
    #[error("linear solve of Newton iteration {} failed", .report.iterations)]
    Linear {
        /// Cause.
        source: LinearError,
        /// Statistics of the solve.
        report: Box<NewtonReport>,
    },
    /// The residual is infinite or not a number.
    #[error("the residual is not finite after {} Newton iterations", .report.iterations)]
    NotFinite {
        /// Statistics of the solve.
        report: Box<NewtonReport>,
    },
}

impl NewtonError {
    /// Returns the statistics of the solve up to the error.
    pub fn report(&self) -> &NewtonReport {
        match self {
            Self::Diverged { report }
            | Self::NotConverged { report, .. }
            | Self::Linear { report, .. }
            | Self::NotFinite { report } => report,
        }
    }

    /// Returns the statistics of the solve up to the error, to which the work of earlier solves may be added.
    pub fn report_mut(&mut self) -> &mut NewtonReport {
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
/// factorisation is more than `contraction` times the one before; if it is more than half of the one before (more than
/// `contraction` times, if that is above a half), it is discarded and computed again. Otherwise only the residual is
/// evaluated (modified Newton).
///
/// **Convergence.** With the row and column scales R, C of the equilibrated tangent and Euclidean norms over the
/// unconstrained dofs, let `s = max(‖C⁻¹ x‖, ‖C⁻¹ x_start‖, ‖C⁻¹ x_ε‖ / tolerance)` with the rounding `x_ε` of
/// [`BlockLayout::rounding`], and `θ = ‖C⁻¹ dx‖ / ‖C⁻¹ dx_previous‖`. The state is accepted if, after a full correction dx,
///
/// - the estimated error `max(θ, η)/(1−θ) ‖C⁻¹ dx‖`, with the relative residual η that the linear solver reached, is at most
///   `tolerance · s` (for the first correction, which has no θ, the correction itself; with η alone if every contribution is
///   linear),
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
    equations: &Equations<'_>,
    x: &mut [f64],
    work: &mut Workspace,
    settings: &NewtonSettings,
) -> Result<NewtonReport, NewtonError> {
    let Equations { layout, contributions: plain, constraints } = equations;
    assert_eq!(x.len(), layout.len(), "length of the starting guess");
    constraints.apply(x);
    let begin = Instant::now();
    let tied: Vec<Option<Tied<'_>>> = plain.iter().map(|c| Tied::new(c.as_ref(), constraints)).collect();
    let contributions: Vec<&dyn Contributions> =
        plain.iter().zip(&tied).map(|(plain, tied)| tied.as_ref().map_or(plain.as_ref(), |tied| tied as _)).collect();
    work.system = std::mem::take(&mut work.system).recycle(layout, &contributions, constraints);
    let (n_factorizations, n_fallbacks) = (work.solver.n_factorizations(), work.solver.n_fallbacks());
    let report = NewtonReport {
        seconds_assembly: begin.elapsed().as_secs_f64(),
        seconds_pattern: work.system.seconds_pattern(),
        nnz: work.system.pattern().n_entries(),
        ..NewtonReport::default()
    };
    let mut solve = Solve {
        equations,
        contributions,
        settings,
        start: x.to_vec(),
        rounding: layout.rounding(),
        previous: vec![0.0; x.len()],
        correction: vec![0.0; x.len()],
        last: None,
        system: &mut work.system,
        solver: work.solver.as_mut(),
        report,
    };
    let outcome = if x.is_empty() { Ok(()) } else { solve.run(x) };
    let Solve { start, mut report, .. } = solve;
    report.timings = work.system.timings().to_vec();
    report.factorizations = work.solver.n_factorizations() - n_factorizations;
    report.fallbacks = work.solver.n_fallbacks() - n_fallbacks;
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

/// Data of the linear solve for a correction.
#[derive(Clone, Copy)]
struct LinearSolve {
    forcing: f64,
    /// Scaled residual before the correction.
    before: f64,
    /// Scaled residual after it, in the same scales.
    after: f64,
    /// Relative residual of the linear system that was reached.
    reached: f64,
}

/// State of a nonlinear solve.
struct Solve<'a> {
    equations: &'a Equations<'a>,
    contributions: Vec<&'a dyn Contributions>,
    settings: &'a NewtonSettings,
    start: Vec<f64>,
    rounding: Vec<f64>,
    previous: Vec<f64>,
    correction: Vec<f64>,
    last: Option<LinearSolve>,
    system: &'a mut BlockSystem,
    solver: &'a mut dyn LinearSolver,
    report: NewtonReport,
}

impl Solve<'_> {
    fn run(&mut self, x: &mut [f64]) -> Result<(), Stop> {
        let tolerance = self.settings.tolerance;
        let mut regime = self.equations.regime(x);
        let mut renew = true;
        let (mut n_growths, mut is_searching) = (0, false);
        self.assemble(x, true)?;
        loop {
            // Correction at x, where the system is assembled: with its tangent if that is to be renewed.
            if renew {
                self.factorize()?;
            }
            let last = self.last;
            self.solve(x)?;
            let mut theta = self.contraction();
            if !renew && theta.is_some_and(|t| t > self.settings.contraction.clamp(USELESS, 1.0)) {
                renew = true;
                self.last = last;
                self.assemble(x, true)?;
                self.factorize()?;
                self.solve(x)?;
                theta = self.contraction();
            }
            n_growths = if renew && theta.is_some_and(|t| t >= 1.0) { n_growths + 1 } else { 0 };
            let correction = self.system.column_norm(&self.correction);
            if self.report.residual_history.is_empty() {
                self.report.residual_history.push(ratio(self.system.row_norm(), self.size(x).max(correction)));
            }
            is_searching |= n_growths > 0;
            let step = if is_searching && renew { self.search(x)? } else { self.step(x, 1.0) };
            self.report.iterations += 1;
            let correction = ratio(correction, self.size(x));
            self.report.correction_history.push(correction);
            let error = self.error_factor(theta, step) * correction;
            let is_exact = self.settings.contraction <= 0.0;
            renew = is_exact || step < 1.0 || (!renew && theta.is_some_and(|t| t > self.settings.contraction));
            std::mem::swap(&mut self.previous, &mut self.correction);

            // The new state: its regime and residual decide whether it is accepted.
            let old_regime = std::mem::replace(&mut regime, self.equations.regime(x));
            let regime_changed = regime != old_regime;
            renew |= regime_changed;
            let may_stop = error <= tolerance && !regime_changed;
            self.assemble(x, renew && !may_stop)?;
            let residual = self.system.row_norm();
            if let Some(last) = &mut self.last {
                last.after = residual;
            }
            let residual = ratio(residual, self.size(x));
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

    /// Evaluates the residual at `x`, and the matrix if requested.
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
        let outcome = self.system.equilibrate().and_then(|()| self.solver.factorize(&self.system.linear_system()?));
        let seconds = begin.elapsed().as_secs_f64();
        self.report.seconds_linear += seconds;
        self.report.seconds_factorization += seconds;
        outcome.map_err(Stop::Linear)
    }

    /// Computes the correction at `x` with the current factorisation; its sign is that of the residual.
    fn solve(&mut self, x: &[f64]) -> Result<(), Stop> {
        let before = self.system.row_norm();
        let enough = ratio(self.settings.tolerance * self.size(x), before);
        let last = self.last.map(|last| (last.forcing, ratio(last.after, last.before)));
        let forcing = self.settings.forcing.next(last, enough);
        let begin = Instant::now();
        let solve = |system| self.solver.solve(&system, self.system.residual(), &mut self.correction, forcing);
        let outcome = self.system.linear_system().and_then(solve);
        self.report.seconds_linear += begin.elapsed().as_secs_f64();
        self.report.solves += 1;
        let linear = outcome.map_err(Stop::Linear)?;
        self.equations.constraints.apply_ties(&mut self.correction);
        self.report.linear_iterations += linear.iterations;
        self.last = Some(LinearSolve { forcing, before, after: before, reached: linear.backward_error });
        Ok(())
    }

    /// Returns `θ`: size of the correction over that of the one before, if there was one.
    fn contraction(&self) -> Option<f64> {
        let previous = self.system.column_norm(&self.previous);
        (self.report.iterations > 0).then(|| ratio(self.system.column_norm(&self.correction), previous))
    }

    /// Estimates the error after a correction relative to its size, from the contraction rate and the linear residual.
    fn error_factor(&self, theta: Option<f64>, step: f64) -> f64 {
        let left = self.last.map_or(0.0, |last| last.reached);
        match theta {
            _ if step < 1.0 => f64::INFINITY,
            _ if self.system.is_linear() => left,
            None => 1.0,
            Some(t) if t < 1.0 => t.max(left) / (1.0 - t),
            Some(_) => f64::INFINITY,
        }
    }

    /// Subtracts a fraction of the correction from `x`; returns the fraction.
    fn step(&self, x: &mut [f64], fraction: f64) -> f64 {
        for (x, dx) in x.iter_mut().zip(&self.correction) {
            *x -= fraction * dx;
        }
        fraction
    }

    /// Subtracts the correction from `x`, halved until the scaled residual decreases (Armijo's rule); returns the fraction. If
    /// no halving that the settings allow makes it decrease, the iteration has diverged.
    ///
    /// A full step that begins or ends contact may increase the residual before the next one reduces it; halving it
    /// would cost iterations only. Therefore the search starts with a correction that grows although its tangent is
    /// exact, and continues for all corrections with exact tangents.
    fn search(&mut self, x: &mut [f64]) -> Result<f64, Stop> {
        const LEAST_DECREASE: f64 = 1e-4;
        let before = self.system.row_norm();
        let mut fraction = self.step(x, 1.0);
        if self.settings.max_halvings == 0 || before == 0.0 {
            return Ok(fraction);
        }
        for halvings in 0..=self.settings.max_halvings {
            if self.assemble(x, false).is_ok() && self.system.row_norm() <= (1.0 - LEAST_DECREASE * fraction) * before {
                return Ok(fraction);
            }
            if halvings < self.settings.max_halvings {
                fraction *= 0.5;
                self.step(x, -fraction);
            }
        }
        Err(Stop::Diverged)
    }

    /// Returns the size of the state, to which errors are relative.
    fn size(&self, x: &[f64]) -> f64 {
        let rounding = self.system.column_norm(&self.rounding) / self.settings.tolerance;
        self.system.column_norm(x).max(self.system.column_norm(&self.start)).max(rounding)
    }
}

/// Returns the quotient of two norms; zero if the numerator is zero.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
