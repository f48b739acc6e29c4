//! FGMRES with a block Gauss-Seidel preconditioner.

use sprs::CsMatI;

use super::gmres::{Gmres, GmresSettings};
use super::incomplete::Fill;
use super::scaled::Scaled;
use super::subdomain::{BlockSolver, Subdomain, with_neighbours};
use super::{Equilibration, LinearError, LinearReport, LinearSolver, MatrixView, Unknowns, check_sides};
use crate::BlockLayout;

/// How blocks are solved for, and when to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockGaussSeidelSettings {
    /// Solvers of the blocks in their order; the last one serves all that follow.
    pub solvers: Vec<BlockSolver>,
    /// Entry of the equilibrated matrix from which on a coupling of two blocks is stiff. Unknowns with stiff couplings are
    /// solved for together, with their neighbours.
    pub stiff: f64,
    /// Iterations before a restart.
    pub restart: usize,
    /// Most iterations of a solve.
    pub max_iterations: usize,
}

impl Default for BlockGaussSeidelSettings {
    /// ILUT for the first block, which is the fluid, and Cholesky for the bodies.
    fn default() -> Self {
        let fluid = BlockSolver::Incomplete(Fill::THRESHOLD);
        Self { solvers: vec![fluid, BlockSolver::Cholesky], stiff: 0.1, restart: 80, max_iterations: 400 }
    }
}

/// Restarted FGMRES, preconditioned by a block Gauss-Seidel sweep and a patch over the stiff couplings between blocks.
///
/// A block is a field, or several that share nodes: velocity and pressure of a fluid are one block. A sweep solves for one
/// block after the other, each with the residual that the blocks before it have left. Penalties couple blocks so stiffly that
/// a sweep alone does not converge; therefore it ends with one more, overlapping block: all unknowns with
/// stiff couplings to another block, and their neighbours, with an LU of their own. Which they are is read off the
/// equilibrated matrix.
///
/// Source of the sweep over fluid and solids: Formaggia, Gatti and Zonca 2019, MOX-Report 44/2019, section 4.
pub struct BlockGaussSeidel {
    settings: BlockGaussSeidelSettings,
    present: Scaled,
    blocks: Vec<Subdomain>,
    patch: Subdomain,
    n_factorizations: usize,
    gmres: Gmres,
    rhs: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

impl BlockGaussSeidel {
    /// A solver without a matrix.
    pub fn new(settings: BlockGaussSeidelSettings) -> Self {
        Self {
            settings,
            present: Scaled::default(),
            blocks: Vec::new(),
            patch: Subdomain::default(),
            n_factorizations: 0,
            gmres: Gmres::default(),
            rhs: Vec::new(),
            solution: Vec::new(),
            residual: Vec::new(),
        }
    }

    /// Number of unknowns in each block of the last matrix.
    pub fn block_sizes(&self) -> Vec<usize> {
        self.blocks.iter().map(|block| block.members().len()).collect()
    }

    /// Number of unknowns in the patch over stiff couplings.
    pub fn patch_size(&self) -> usize {
        self.patch.members().len()
    }

    fn factorize_blocks(&mut self, unknowns: Unknowns<'_>) -> Result<(), LinearError> {
        let Scaled { scales, matrix: Some(matrix) } = &self.present else { return Err(LinearError::NotFactorized) };
        self.n_factorizations += 1;
        let blocks = blocks(unknowns.layout, unknowns.nodes);
        let mut block_of = vec![0; matrix.rows()];
        for (k, block) in blocks.iter().enumerate() {
            block.members.iter().for_each(|i| block_of[*i as usize] = k);
        }
        let stiff = stiffly_coupled(matrix, &block_of, self.settings.stiff);
        self.blocks.resize_with(blocks.len(), Subdomain::default);
        for (k, (subdomain, block)) in self.blocks.iter_mut().zip(blocks).enumerate() {
            let solver = self.settings.solvers.get(k).or(self.settings.solvers.last());
            let solver = solver.copied().unwrap_or(BlockSolver::Lu);
            subdomain.factorize(matrix, block.members, block.n_primal, unknowns.nodes, scales, solver)?;
        }
        let n_stiff = stiff.len();
        let patched = self.patch.factorize(matrix, stiff, n_stiff, unknowns.nodes, scales, BlockSolver::Lu);
        // A part of a saddle point may be singular where the whole is not: then the blocks have to do.
        if patched.is_err() {
            self.patch.clear();
        }
        Ok(())
    }
}

/// The unknowns of a block.
struct Block {
    /// Ascending.
    members: Vec<u32>,
    /// How many of them are not multipliers: those of its first field.
    n_primal: usize,
}

/// The blocks: fields that share nodes are one. All unknowns are one block if the layout does not belong to them.
fn blocks(layout: &BlockLayout, nodes: &[u32]) -> Vec<Block> {
    if layout.len() != nodes.len() {
        return vec![Block { members: (0..nodes.len() as u32).collect(), n_primal: nodes.len() }];
    }
    let mut field_of_node = vec![None; nodes.len()];
    let mut first_field: Vec<usize> = (0..layout.n_fields()).collect();
    for (field, id) in layout.fields().enumerate() {
        for node in &nodes[layout.range(id)] {
            let other: usize = *field_of_node[*node as usize].get_or_insert(field);
            let (a, b) = (first_field[other], first_field[field]);
            first_field.iter_mut().filter(|first| **first == a.max(b)).for_each(|first| *first = a.min(b));
        }
    }
    let ranges: Vec<_> = layout.fields().map(|id| layout.range(id)).collect();
    let members_of = |block: usize| {
        let fields = first_field.iter().zip(&ranges).filter(move |(first, _)| **first == block);
        fields.flat_map(|(_, range)| range.start as u32..range.end as u32).collect()
    };
    let first_fields = (0..ranges.len()).filter(|field| first_field[*field] == *field && !ranges[*field].is_empty());
    first_fields.map(|field| Block { members: members_of(field), n_primal: ranges[field].len() }).collect()
}

/// Unknowns with stiff couplings to another block, and all that these act on.
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
    fn factorize(&mut self, matrix: MatrixView<'_>, unknowns: Unknowns<'_>) -> Result<(), LinearError> {
        assert_eq!(matrix.rows(), unknowns.nodes.len(), "nodes of the unknowns");
        self.present.set(matrix)?;
        self.factorize_blocks(unknowns).inspect_err(|_| self.present.matrix = None)
    }

    fn solve(&mut self, rhs: &[f64], x: &mut [f64], tolerance: f64) -> Result<LinearReport, LinearError> {
        let Some(matrix) = &self.present.matrix else { return Err(LinearError::NotFactorized) };
        check_sides(matrix.rows(), rhs, x)?;
        self.present.scale_rhs(rhs, &mut self.rhs);
        let BlockGaussSeidelSettings { restart, max_iterations, .. } = self.settings;
        let (blocks, patch, residual) = (&mut self.blocks, &mut self.patch, &mut self.residual);
        let mut sweep = |r: &[f64], z: &mut [f64]| {
            residual.clear();
            residual.extend_from_slice(r);
            let mut steps = blocks.iter_mut().chain([&mut *patch]).filter(|step| !step.members().is_empty()).peekable();
            while let Some(step) = steps.next() {
                step.correct(residual, z)?;
                if steps.peek().is_some() {
                    step.update(matrix, residual);
                }
            }
            Ok(())
        };
        let settings = GmresSettings { tolerance, restart, max_iterations };
        let report = self.gmres.solve_matrix(matrix, &mut sweep, &self.rhs, &mut self.solution, &settings)?;
        self.present.unscale(&self.solution, x);
        Ok(LinearReport { iterations: report.iterations, backward_error: report.residual })
    }

    fn equilibration(&self) -> &Equilibration {
        &self.present.scales
    }

    fn n_factorizations(&self) -> usize {
        self.n_factorizations
    }
}
