//! Time steps, Newton's method and linear solver of a scenario.

use std::sync::Arc;

use algebra::time::{GeneralisedAlpha, ImplicitEuler, QuasiStatic, TimeScheme};
use algebra::{
    BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, Fill, LaggedSettings, LaggedSolver, NewtonSettings,
    Workspace,
};

use super::error::{ErrorKind, ScenarioError};
use super::key::Quantity;
use super::table::{At, choices, keys};

keys! {
    /// Time steps.
    pub struct Time {
        /// Length of a step.
        step: At<f64> [unit(Quantity::TIME), positive],
        /// End of the run, a multiple of the step.
        end: f64 [unit(Quantity::TIME), positive],
        /// Time scheme of fluid and bodies.
        scheme: At<TimeSchemeChoice> = "generalised-alpha",
        /// Number of times that a step is halved, if Newton's method fails, multipliers of contact do not settle, a contact
        /// may have been missed, a body passes through its obstacle or a cell is inverted, before the run stops.
        most_halvings: usize [between(0.0, 20.0)] = 4,
        /// Substeps that become shorter as the bodies of a contact approach; none if left out.
        approach: Option<Approach>,
    }
}

keys! {
    /// Substeps where bodies are close to each other.
    pub struct Approach {
        /// Largest motion of the bodies of a contact in a substep, relative to the gap between them; nodes that do not
        /// move have none.
        fraction: f64 [between(0.001, 1.0)] = 0.06,
        /// Smallest length to which gaps shorten a substep; not below 1e-12 of the time, which round-off would lose. A substep
        /// that fails is halved beyond it.
        smallest: At<f64> [unit(Quantity::TIME), positive],
    }
}

choices! {
    /// Time scheme of fluid and bodies.
    pub enum TimeSchemeChoice ["kind"] {
        /// First order, the scheme of the paper. Dissipates all motion; elastic bodies that turn gain or lose area.
        ImplicitEuler = "implicit-euler",
        /// Second order.
        GeneralisedAlpha = "generalised-alpha" {
            /// Factor by which a step reduces the fastest vibrations.
            rho_inf: f64 [between(0.0, 1.0)] = 0.0,
        },
        /// No inertia: every step ends in equilibrium, with steady flow.
        QuasiStatic = "quasi-static",
    }
}

/// Largest difference of the end time from a multiple of the step, relative to the end time.
const ROUND_OFF: f64 = 1e-9;

/// Largest number of steps. More steps are probably a wrong exponent in step or end.
const MAX_STEPS: f64 = 1e9;

impl Time {
    /// Returns the number of steps.
    pub fn n_steps(&self) -> usize {
        (self.end / *self.step).round() as usize
    }

    /// Returns the time scheme.
    pub(super) fn scheme(&self) -> Result<Arc<dyn TimeScheme>, ScenarioError> {
        Ok(match *self.scheme {
            TimeSchemeChoice::ImplicitEuler => Arc::new(ImplicitEuler),
            TimeSchemeChoice::QuasiStatic => Arc::new(QuasiStatic),
            TimeSchemeChoice::GeneralisedAlpha { rho_inf } => {
                let outside = || self.scheme.at.invalid("rho_inf must be from 0 to 1".to_owned());
                Arc::new(GeneralisedAlpha::new(rho_inf).ok_or_else(outside)?)
            }
        })
    }

    /// Checks that the step divides the end time.
    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        let (step, end) = (*self.step, self.end);
        let n = (end / step).round();
        if n > MAX_STEPS {
            return Err(self.step.at.invalid(format!(
                "the step {step:e} needs more than {MAX_STEPS:e} steps to the end {end:e}; check the exponents of both"
            )));
        }
        if let Some(approach) = self.approach.as_ref().filter(|approach| *approach.smallest >= step) {
            let message = "the smallest part is not shorter than the step, so that no step is divided; make it shorter";
            return Err(approach.smallest.at.invalid(message));
        }
        if n >= 1.0 && (n * step - end).abs() <= ROUND_OFF * end {
            return Ok(());
        }
        let step_below = end / (end / step).ceil();
        let end_below = step * (end / step).floor().max(1.0);
        Err(self.step.at.invalid(format!(
            "the step {step} does not divide the end time {end}; use step = {step_below} or end = {end_below}"
        )))
    }
}

keys! {
    /// Solution of the equations of a step.
    pub struct Solver {
        /// Newton's method.
        newton: Newton = {},
        /// Linear solver. If left out: `{ kind = "gmres", preconditioner = "lagged-lu" }`; for a fluid in space with
        /// more than 50 000 unknowns `{ kind = "gmres", preconditioner = "block-gauss-seidel" }`.
        linear: Option<LinearSolverChoice>,
    }
}

/// Number of unknowns of a fluid in 3D above which a factorisation of the whole matrix is too large.
///
/// Both factors of the matrix of a mesh in 3D have about `20 n^(4/3)` entries: with 50 000 unknowns 0.15 GB in
/// single precision, and with 500 000 unknowns 3 GB.
const LARGE_IN_SPACE: usize = 50_000;

impl Solver {
    /// Returns the linear solver for a fluid with a number of unknowns, or for bodies alone, with the reason for it.
    pub(super) fn linear(&self, dimension: usize, n_unknowns: usize) -> (LinearSolverChoice, &'static str) {
        let gmres = |preconditioner| LinearSolverChoice::Gmres { preconditioner, restart: None, blocks: None };
        match &self.linear {
            Some(linear) => (linear.clone(), "given in the scenario"),
            None if dimension > 2 && n_unknowns > LARGE_IN_SPACE => (
                gmres(Preconditioner::BlockGaussSeidel),
                "a fluid in 3D with more than 50000 unknowns makes large factors",
            ),
            None => (gmres(Preconditioner::LaggedLu), "matrices change little from step to step"),
        }
    }
}

keys! {
    /// Newton's method.
    pub struct Newton {
        /// Relative tolerance.
        tolerance: f64 [between(1e-16, 0.1)] = 1e-8,
        /// Largest number of corrections per solve.
        max_iterations: usize [between(1.0, f64::INFINITY)] = 30,
    }
}

impl Newton {
    /// Returns the settings of Newton's method.
    pub(super) fn settings(&self) -> NewtonSettings {
        let Self { tolerance, max_iterations } = *self;
        NewtonSettings { max_iterations, ..NewtonSettings::new(tolerance) }
    }
}

choices! {
    /// Linear solver.
    pub enum LinearSolverChoice ["kind"] {
        /// Sparse LU factorisation of every matrix.
        Direct = "direct",
        /// Restarted flexible GMRES.
        Gmres = "gmres" {
            /// Preconditioner.
            preconditioner: Preconditioner,
            /// Iterations before a restart, with `block-gauss-seidel`; 80 if left out.
            restart: Option<At<usize>> [between(1.0, f64::INFINITY)],
            /// Solvers of the blocks, with `block-gauss-seidel`; `ilut` and `cholesky` if left out.
            blocks: Option<At<Blocks>>,
        },
    }
}

choices! {
    /// Preconditioner.
    #[derive(Copy, Eq)]
    pub enum Preconditioner {
        /// Factors of an earlier matrix, updated near the interface; fast where the flow changes slowly.
        LaggedLu = "lagged-lu",
        /// One solve for the fluid, one for each body and one for the stiff couplings between them; little memory, for
        /// large systems.
        BlockGaussSeidel = "block-gauss-seidel",
    }
}

keys! {
    /// Solvers of the blocks of a block Gauss-Seidel preconditioner.
    pub struct Blocks {
        /// Solver for velocity and pressure of the fluid.
        fluid: FluidBlock,
        /// Solver for every body.
        bodies: BodyBlock,
    }
}

choices! {
    /// Solver of the block of the fluid.
    #[derive(Copy, Eq)]
    pub enum FluidBlock {
        /// Sparse LU.
        Lu = "lu",
        /// Incomplete LU without fill.
        Ilu = "ilu",
        /// Incomplete LU with a threshold.
        Ilut = "ilut",
    }
}

choices! {
    /// Solver of the block of a body.
    #[derive(Copy, Eq)]
    pub enum BodyBlock {
        /// Sparse LU.
        Lu = "lu",
        /// Sparse Cholesky; LU if the block is not symmetric and positive definite.
        Cholesky = "cholesky",
        /// Incomplete LU without fill.
        Ilu = "ilu",
        /// Incomplete LU with a threshold.
        Ilut = "ilut",
    }
}

impl LinearSolverChoice {
    /// Checks that all settings belong to the preconditioner.
    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        let Self::Gmres { preconditioner: Preconditioner::LaggedLu, restart, blocks } = self else { return Ok(()) };
        let given = restart.as_ref().map(|restart| &restart.at).or(blocks.as_ref().map(|blocks| &blocks.at));
        let with = "preconditioner = \"lagged-lu\"";
        given.map_or(Ok(()), |at| Err(at.error(ErrorKind::NoEffect(with))))
    }

    /// Returns the name: kind and preconditioner.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Gmres { preconditioner: Preconditioner::LaggedLu, .. } => "gmres, lagged-lu",
            Self::Gmres { preconditioner: Preconditioner::BlockGaussSeidel, .. } => "gmres, block-gauss-seidel",
        }
    }

    /// Returns a workspace with this linear solver.
    pub fn workspace(&self) -> Workspace {
        let Self::Gmres { preconditioner, restart, blocks } = self else { return Workspace::new() };
        if *preconditioner == Preconditioner::LaggedLu {
            return Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
        }
        let mut settings = BlockGaussSeidelSettings::default();
        if let Some(restart) = restart {
            settings.restart = **restart;
        }
        if let Some(blocks) = blocks {
            let fluid = match blocks.fluid {
                FluidBlock::Lu => BlockSolver::Lu,
                FluidBlock::Ilu => BlockSolver::Incomplete(Fill::Pattern),
                FluidBlock::Ilut => BlockSolver::Incomplete(Fill::THRESHOLD),
            };
            let bodies = match blocks.bodies {
                BodyBlock::Lu => BlockSolver::Lu,
                BodyBlock::Cholesky => BlockSolver::Cholesky,
                BodyBlock::Ilu => BlockSolver::Incomplete(Fill::Pattern),
                BodyBlock::Ilut => BlockSolver::Incomplete(Fill::THRESHOLD),
            };
            settings.solvers = vec![fluid, bodies];
        }
        Workspace::with_solver(Box::new(BlockGaussSeidel::new(settings)))
    }
}
