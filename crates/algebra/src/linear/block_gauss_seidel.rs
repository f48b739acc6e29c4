//! FGMRES with a block Gauss-Seidel preconditioner.

use sprs::CsMatI;

use super::gmres::{Gmres, GmresSettings};
use super::incomplete::Fill;
use super::subdomain::{BlockSolver, Subdomain, with_neighbours};
use super::{LinearError, LinearReport, LinearSolver, LinearSystem};
use crate::BlockLayout;

/// Solvers of the blocks, and stopping criteria.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockGaussSeidelSettings {
    /// Solvers of the blocks in their order. The last solver is used for all further blocks.
    pub solvers: Vec<BlockSolver>,
    /// Smallest absolute entry of the equilibrated matrix that makes a coupling of two blocks stiff. Unknowns with
    /// stiff couplings and their neighbours are solved for together.
    pub stiff: f64,
    /// Iterations before a restart.
    pub restart: usize,
    /// Largest number of iterations of a solve.
    pub max_iterations: usize,
}

impl Default for BlockGaussSeidelSettings {
    /// Returns settings with ILUT for the first block, which is the fluid, and Cholesky for the bodies.
    fn default() -> Self {
        let fluid = BlockSolver::Incomplete(Fill::THRESHOLD);
        Self { solvers: vec![fluid, BlockSolver::Cholesky], stiff: 0.1, restart: 80, max_iterations: 400 }
    }
}

/// Restarted FGMRES, preconditioned by a block Gauss-Seidel sweep and a patch over the stiff couplings between blocks.
///
/// A block is a field, or several that share nodes: velocity and pressure of a fluid are one block. A sweep solves for
/// one block after the other, each with the residual that the blocks before it have left. Penalties couple blocks so
/// stiffly that a sweep alone does not converge. Therefore the sweep ends with the *patch*, an overlapping block with
/// its own LU. It contains all unknowns with stiff couplings to another block, and their neighbours.
///
/// Source of the sweep over fluid and solids: Formaggia, Gatti and Zonca 2019, MOX-Report 44/2019, section 4.
pub struct BlockGaussSeidel {
    settings: BlockGaussSeidelSettings,
    is_factorized: bool,
    blocks: Vec<Subdomain>,
    patch: Subdomain,
    n_factorizations: usize,
    gmres: Gmres,
    rhs: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

impl BlockGaussSeidel {
    /// Creates a solver without a matrix.
    pub fn new(settings: BlockGaussSeidelSettings) -> Self {
        Self {
            settings,
            is_factorized: false,
            blocks: Vec::new(),
            patch: Subdomain::default(),
            n_factorizations: 0,
            gmres: Gmres::default(),
            rhs: Vec::new(),
            solution: Vec::new(),
            residual: Vec::new(),
        }
    }

    /// Returns the number of unknowns in each block of the last matrix.
    pub fn block_sizes(&self) -> Vec<usize> {
        self.blocks.iter().map(|block| block.members().len()).collect()
    }

    /// Returns the number of unknowns in the patch over stiff couplings.
    pub fn patch_size(&self) -> usize {
        self.patch.members().len()
    }
}

/// The unknowns of a block.
struct Block {
    /// Unknowns, ascending.
    members: Vec<u32>,
    /// Number of members that are not multipliers: the unknowns of the first field.
    n_primal: usize,
}

/// Returns the blocks: fields on the same nodes are one.
fn blocks(layout: &BlockLayout) -> Vec<Block> {
    let mut blocks: Vec<(usize, Block)> = Vec::new();
    for field in layout.fields().filter(|field| !layout.range(*field).is_empty()) {
        let range = layout.range(field);
        let members = range.start as u32..range.end as u32;
        match blocks.iter_mut().find(|(node_set, _)| *node_set == layout.node_set(field)) {
            Some((_, block)) => block.members.extend(members),
            None => {
                let block = Block { members: members.collect(), n_primal: range.len() };
                blocks.push((layout.node_set(field), block));
            }
        }
    }
    blocks.into_iter().map(|(_, block)| block).collect()
}

/// Returns the unknowns with stiff couplings to another block, and their neighbours (see [`with_neighbours`]).
fn stiffly_coupled(matrix: &CsMatI<f64, u32>, block_of: &[usize], stiff: f64) -> Vec<u32> {
    let mut is_stiff = vec![false; block_of.len()];
    for (value, (i, j)) in matrix.iter() {
        let (i, j) = (i as usize, j as usize);
        if block_of[i] != block_of[j] && value.abs() >= stiff {
            is_stiff[i] = true;
            is_stiff[j] = true;
        }
    }
    with_neighbours(matrix, &is_stiff)
}

impl LinearSolver for BlockGaussSeidel {
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError> {
        self.is_factorized = false;
        self.n_factorizations += 1;
        let blocks = blocks(system.layout);
        let mut block_of = vec![0; system.len()];
        for (k, block) in blocks.iter().enumerate() {
            block.members.iter().for_each(|i| block_of[*i as usize] = k);
        }
        let stiff = stiffly_coupled(system.matrix, &block_of, self.settings.stiff);
        self.blocks.resize_with(blocks.len(), Subdomain::default);
        for (k, (subdomain, block)) in self.blocks.iter_mut().zip(blocks).enumerate() {
            let solver = self.settings.solvers.get(k).or(self.settings.solvers.last());
            let solver = solver.copied().unwrap_or(BlockSolver::Lu);
            subdomain.factorize(system, block.members, block.n_primal, solver)?;
        }
        let n_stiff = stiff.len();
        let patched = self.patch.factorize(system, stiff, n_stiff, BlockSolver::Lu);
        // A part of a saddle point may be singular where the whole is not; then the sweep runs without the patch.
        if patched.is_err() {
            self.patch.clear();
        }
        self.is_factorized = true;
        Ok(())
    }

    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<LinearReport, LinearError> {
        if !self.is_factorized {
            return Err(LinearError::NotFactorized);
        }
        system.scale_rhs(rhs, x, &mut self.rhs)?;
        let BlockGaussSeidelSettings { restart, max_iterations, .. } = self.settings;
        let (blocks, patch, residual) = (&mut self.blocks, &mut self.patch, &mut self.residual);
        let mut sweep = |r: &[f64], z: &mut [f64]| {
            residual.clear();
            residual.extend_from_slice(r);
            let mut steps = blocks.iter_mut().chain([&mut *patch]).filter(|step| !step.members().is_empty()).peekable();
            while let Some(step) = steps.next() {
                step.correct(residual, z)?;
                if steps.peek().is_some() {
                    step.update(system.matrix, residual);
                }
            }
            Ok(())
        };
        let settings = GmresSettings { tolerance, restart, max_iterations };
        let report = self.gmres.solve(system.matrix, &mut sweep, &self.rhs, &mut self.solution, &settings)?;
        system.unscale(&self.solution, x);
        Ok(report)
    }

    fn n_factorizations(&self) -> usize {
        self.n_factorizations
    }
}
