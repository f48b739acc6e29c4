//! Newton's method with exact tangents and factorisations that are kept while they contract.

use std::time::Instant;

use crate::contributions::for_each_residual;
use crate::linear::{LinearError, LinearSolver};
use crate::{
    BlockLayout, BlockSystem, Constraints, ContributionTiming, Contributions, DofId, Forcing, Tied, Workspace,
    regime_of,
};

/// Number of successive growing corrections with exact tangents after which the iteration has diverged.
const MAX_GROWTHS: usize = 5;

/// Number of corrections that are accepted in full although no fraction of them reduces the residual. Where vapour or
/// contact begins and ends, a full correction may raise the residual before the next ones reduce it, and the search may
/// reach a point at which no fraction does.
///
/// Source: the watchdog technique of Chamberlain, Powell, Lemarechal, Pedersen 1982, doi:10.1007/BFb0120945.
const MAX_RISES: usize = 5;

/// Size of a correction relative to the tolerance below which a change of the regime does not count. The correction
/// after such a change is at most this one times the ratio of the stiffnesses in the two regimes.
const AT_LIMIT: f64 = 1e-4;

/// Largest accepted ratio `θ` of a correction with an old factorisation to the previous correction. For a larger ratio
/// the estimated error, `θ/(1-θ)` times the correction, exceeds the correction, and the correction is discarded. A
/// larger [`NewtonSettings::contraction`] replaces this value, up to 1.
///
/// Source: Deuflhard 2011, Newton methods for nonlinear problems, doi:10.1007/978-3-642-23899-4, Section 2.1.
const LARGEST_OLD_CONTRACTION: f64 = 0.5;

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
        self.contributions.iter().fold(0, |hash, terms| hash.rotate_left(1) ^ regime_of(terms.as_ref(), x))
    }

    /// Returns the residual at `x` of the equations of prescribed and tied dofs and of the masters of tied ones: the
    /// reactions of the constraints. Other entries are zero. Only items with such dofs are evaluated.
    ///
    /// # Panics
    /// A contribution or constraint names a dof outside of the layout.
    pub fn reactions(&self, x: &[f64]) -> Vec<f64> {
        let mut is_selected = vec![false; self.layout.len()];
        self.constraints.iter().for_each(|(dof, _)| is_selected[dof.index()] = true);
        for (dof, to) in self.constraints.ties() {
            is_selected[dof.index()] = true;
            to.iter().for_each(|(master, _)| is_selected[master.index()] = true);
        }
        let mut reactions = vec![0.0; self.layout.len()];
        let selects = |dofs: &[DofId]| dofs.iter().any(|dof| is_selected[dof.index()]);
        for terms in &self.contributions {
            for_each_residual(terms.as_ref(), 0..terms.len(), x, selects, |_, dofs, residual| {
                for (dof, value) in dofs.iter().zip(residual).filter(|(dof, _)| is_selected[dof.index()]) {
                    reactions[dof.index()] += value;
                }
            });
        }
        reactions
    }
}

/// Stopping criteria, and criteria for a new factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Largest accepted error and residual, relative to the state, in scaled norms (see [`newton`]).
    pub tolerance: f64,
    /// Largest number of corrections.
    pub max_iterations: usize,
    /// The factorisation is kept while a correction with it is at most this fraction of the previous one. Zero: exact
    /// Newton with one factorisation per correction.
    pub contraction: f64,
    /// Accuracy of an iterative solve for a correction.
    pub forcing: Forcing,
    /// Largest number of halvings of a correction until the scaled residual decreases, once corrections with exact
    /// tangents have grown. Zero: no line search.
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
    /// Number of corrections that were applied to the state, whole or shortened.
    pub iterations: usize,
    /// Number of factorisations of the tangent.
    pub factorizations: usize,
    /// Number of these factorisations that needed pivoting over the whole matrix ([`LinearSolver::n_fallbacks`]).
    pub fallbacks: usize,
    /// Sum of the iterations of the linear solver, or of the refinement steps of a direct solver.
    pub linear_iterations: usize,
    /// `‖R r‖ / s` of each iterate with the norms and the size `s` of [`newton`], starting with the starting guess. The
    /// `s` of the starting guess is at least the norm of the first correction.
    pub residual_history: Vec<f64>,
    /// `‖C⁻¹ dx‖ / s` of each correction before it is shortened, with the norms and the size `s` of [`newton`].
    pub correction_history: Vec<f64>,
    /// Sum of the residuals of the solution times the solution, over the dofs without constraints.
    pub residual_power: f64,
    /// Wall-clock time of pattern, assembly and regimes, s.
    pub seconds_assembly: f64,
    /// Share of the pattern in `seconds_assembly`.
    pub seconds_pattern: f64,
    /// Number of evaluations of the system, with or without its matrix.
    pub assemblies: usize,
    /// Wall-clock time of the linear solver, s.
    pub seconds_linear: f64,
    /// Share of the factorisations in `seconds_linear`.
    pub seconds_factorization: f64,
    /// Number of linear solves.
    pub solves: usize,
    /// Number of stored entries of the matrix.
    pub nnz: usize,
    /// Times of the regimes and per contribution.
    pub timings: Vec<ContributionTiming>,
}

impl NewtonReport {
    /// Adds the counts and times of another solve, but not its histories.
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
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum NewtonError {
    /// Five successive corrections with exact tangents grew, or the line search found no decrease of the residual.
    /// Improve the starting guess or take a smaller step.
    #[error("Newton diverged after {} iterations: corrections or residuals grew", .report.iterations)]
    Diverged { report: Box<NewtonReport> },
    /// The limit of iterations was reached.
    #[error("Newton did not converge in {} iterations (relative residual {:e}{})", .report.iterations,
        last_residual(.report), if *.regime_changed { ", points in contact or vapour still change" } else { "" })]
    NotConverged {
        /// Whether the last correction changed the regime.
        regime_changed: bool,
        report: Box<NewtonReport>,
    },
    /// The linear system could not be solved.
    #[error("the linear solve failed after {} Newton iterations", .report.iterations)]
    Linear { source: LinearError, report: Box<NewtonReport> },
    /// The residual is infinite or not a number.
    #[error("the residual is not finite after {} Newton iterations", .report.iterations)]
    NotFinite { report: Box<NewtonReport> },
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

/// Returns the last entry of the history of residuals; NaN if it is empty.
fn last_residual(report: &NewtonReport) -> f64 {
    report.residual_history.last().copied().unwrap_or(f64::NAN)
}

/// Solves a nonlinear problem from the starting guess `x`, into which the constraints are written first.
///
/// The tangent is factorised at the start. It is factorised again if the regime has changed, if the line search
/// shortened the last correction, or if the ratio `θ` of a correction with an old factorisation to the previous
/// correction exceeds `contraction`. If `θ` also exceeds 1/2, the correction is discarded and computed again with the
/// new factorisation. In all other iterations only the residual is evaluated (modified Newton).
///
/// **Convergence.** With the row and column scales R, C of the equilibrated tangent and Euclidean norms over the
/// unconstrained dofs, let `s = max(‖C⁻¹ x‖, ‖C⁻¹ x_start‖, ‖C⁻¹ x_ε‖ / tolerance)` with the rounding `x_ε` of
/// [`BlockLayout::rounding`], and `θ = ‖C⁻¹ dx‖ / ‖C⁻¹ dx_previous‖`. The state is accepted if, after a full correction
/// dx,
///
/// - the estimated error `max(θ, η)/(1−θ) ‖C⁻¹ dx‖` is at most `tolerance · s`, where η is the relative residual that
///   the linear solver reached. For the first correction, which has no θ, the estimate is `‖C⁻¹ dx‖`. If every
///   contribution is linear, it is `η ‖C⁻¹ dx‖`,
/// - the new residual satisfies `‖R r‖ ≤ tolerance · s`,
/// - the correction did not change the regime, or is at most 1e-4 times this tolerance. Tractions of contact and fluxes
///   with vapour are continuous at the limits of their regimes. Where points are at these limits, round-off changes the
///   regime in every iteration.
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
        timings: vec![ContributionTiming { name: "regime", ..ContributionTiming::default() }],
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
        last_solve: None,
        system: &mut work.system,
        solver: work.solver.as_mut(),
        report,
    };
    let outcome = if x.is_empty() { Ok(()) } else { solve.run(x) };
    let Solve { start, mut report, .. } = solve;
    report.timings.extend_from_slice(work.system.timings());
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
    /// Tolerance that the linear solver was given.
    forcing: f64,
    /// Norm of the scaled residual before the correction.
    before: f64,
    /// Norm of the scaled residual after the correction, in the scales of `before`.
    after: f64,
    /// Relative residual of the linear system that was reached.
    reached: f64,
}

/// State of a nonlinear solve.
struct Solve<'a> {
    equations: &'a Equations<'a>,
    contributions: Vec<&'a dyn Contributions>,
    settings: &'a NewtonSettings,
    /// State at the start, with the constraints applied.
    start: Vec<f64>,
    /// Round-off of each dof ([`BlockLayout::rounding`]).
    rounding: Vec<f64>,
    /// Correction of the previous iteration.
    previous: Vec<f64>,
    correction: Vec<f64>,
    /// Linear solve for the last correction.
    last_solve: Option<LinearSolve>,
    system: &'a mut BlockSystem,
    solver: &'a mut dyn LinearSolver,
    report: NewtonReport,
}

impl Solve<'_> {
    fn run(&mut self, x: &mut [f64]) -> Result<(), Stop> {
        let tolerance = self.settings.tolerance;
        let mut regime = self.regime(x);
        let mut renew = true;
        let (mut n_growths, mut n_rises, mut is_searching) = (0, 0, false);
        self.assemble(x, true)?;
        loop {
            // The system is assembled at x, with the matrix if `renew`.
            if renew {
                self.factorize()?;
            }
            let last_solve = self.last_solve;
            self.solve(x)?;
            let mut theta = self.contraction();
            if !renew && theta.is_some_and(|t| t > self.settings.contraction.clamp(LARGEST_OLD_CONTRACTION, 1.0)) {
                renew = true;
                // The forcing must not depend on the discarded solve.
                self.last_solve = last_solve;
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
            let step = if is_searching && renew {
                let found = self.search(x);
                n_rises += usize::from(found.is_none());
                if n_rises > MAX_RISES {
                    return Err(Stop::Diverged);
                }
                found.unwrap_or(1.0)
            } else {
                self.subtract_correction(x, 1.0)
            };
            self.report.iterations += 1;
            let correction = ratio(correction, self.size(x));
            self.report.correction_history.push(correction);
            let error = self.error_factor(theta, step) * correction;
            let is_exact = self.settings.contraction <= 0.0;
            renew = is_exact || step < 1.0 || (!renew && theta.is_some_and(|t| t > self.settings.contraction));
            std::mem::swap(&mut self.previous, &mut self.correction);

            // The new state: its regime and residual decide whether it is accepted.
            let old_regime = std::mem::replace(&mut regime, self.regime(x));
            let regime_changed = regime != old_regime;
            renew |= regime_changed;
            let has_settled = !regime_changed || correction <= AT_LIMIT * tolerance;
            let may_stop = error <= tolerance && has_settled;
            self.assemble(x, renew && !may_stop)?;
            let residual = self.system.row_norm();
            if let Some(last) = &mut self.last_solve {
                last.after = residual;
            }
            let residual = ratio(residual, self.size(x));
            self.report.residual_history.push(residual);
            if may_stop && residual <= tolerance {
                self.report.residual_power = self.system.residual().iter().zip(&*x).map(|(r, x)| r * x).sum();
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

    /// Returns the hash of the non-smooth state at `x`.
    fn regime(&mut self, x: &[f64]) -> u64 {
        let begin = Instant::now();
        let regime = self.equations.regime(x);
        let seconds = begin.elapsed().as_secs_f64();
        self.report.seconds_assembly += seconds;
        self.report.timings[0].calls += 1;
        self.report.timings[0].seconds += seconds;
        regime
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

    /// Computes the correction `dx` at `x` with the current factorisation: `A dx = r`, to be subtracted from `x`.
    fn solve(&mut self, x: &[f64]) -> Result<(), Stop> {
        let before = self.system.row_norm();
        let enough = ratio(self.settings.tolerance * self.size(x), before);
        let last = self.last_solve.map(|last| (last.forcing, ratio(last.after, last.before)));
        let forcing = self.settings.forcing.next(last, enough);
        let begin = Instant::now();
        let solve = |system| self.solver.solve(&system, self.system.residual(), &mut self.correction, forcing);
        let outcome = self.system.linear_system().and_then(solve);
        self.report.seconds_linear += begin.elapsed().as_secs_f64();
        self.report.solves += 1;
        let linear = outcome.map_err(Stop::Linear)?;
        self.equations.constraints.apply_ties(&mut self.correction);
        self.report.linear_iterations += linear.iterations;
        self.last_solve = Some(LinearSolve { forcing, before, after: before, reached: linear.backward_error });
        Ok(())
    }

    /// Returns `θ`, the norm of the correction over the norm of the previous one; `None` for the first correction.
    fn contraction(&self) -> Option<f64> {
        let previous = self.system.column_norm(&self.previous);
        (self.report.iterations > 0).then(|| ratio(self.system.column_norm(&self.correction), previous))
    }

    /// Estimates the error after a correction, relative to the norm of the correction, from the contraction rate `θ`
    /// and the residual of the linear system.
    fn error_factor(&self, theta: Option<f64>, step: f64) -> f64 {
        let left = self.last_solve.map_or(0.0, |last| last.reached);
        match theta {
            _ if step < 1.0 => f64::INFINITY,
            _ if self.system.is_linear() => left,
            None => 1.0,
            Some(t) if t < 1.0 => t.max(left) / (1.0 - t),
            Some(_) => f64::INFINITY,
        }
    }

    /// Subtracts a fraction of the correction from `x`; returns the fraction.
    fn subtract_correction(&self, x: &mut [f64], fraction: f64) -> f64 {
        for (x, dx) in x.iter_mut().zip(&self.correction) {
            *x -= fraction * dx;
        }
        fraction
    }

    /// Subtracts the correction from `x`, halved until the scaled residual decreases (Armijo's rule); returns the
    /// fraction. If the halvings that the settings allow do not reduce the residual, the correction is subtracted in
    /// full, and the result is `None`.
    ///
    /// A full correction that begins or ends contact may increase the residual before the next correction reduces it.
    /// Halving such a correction would only cost iterations. Therefore the search starts with the first correction that
    /// grows although its tangent is exact, and continues for all corrections with exact tangents.
    fn search(&mut self, x: &mut [f64]) -> Option<f64> {
        const LEAST_DECREASE: f64 = 1e-4;
        let before = self.system.row_norm();
        let mut fraction = self.subtract_correction(x, 1.0);
        if self.settings.max_halvings == 0 || before == 0.0 {
            return Some(fraction);
        }
        for halvings in 0..=self.settings.max_halvings {
            if self.assemble(x, false).is_ok() && self.system.row_norm() <= (1.0 - LEAST_DECREASE * fraction) * before {
                return Some(fraction);
            }
            if halvings < self.settings.max_halvings {
                fraction *= 0.5;
                self.subtract_correction(x, -fraction);
            }
        }
        self.subtract_correction(x, 1.0 - fraction);
        None
    }

    /// Returns the size `s` of the state, to which errors are relative ([`newton`]).
    fn size(&self, x: &[f64]) -> f64 {
        let rounding = self.system.column_norm(&self.rounding) / self.settings.tolerance;
        self.system.column_norm(x).max(self.system.column_norm(&self.start)).max(rounding)
    }
}

/// Returns the quotient of two norms; zero if the numerator is zero.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
