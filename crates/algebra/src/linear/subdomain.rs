//! Rows and columns of a matrix that are solved for together.

use std::collections::BTreeMap;

use sprs::CsMatI;

use super::checked_factors::CheckedFactors;
use super::cholesky::CholeskyFactors;
use super::factors::Factors;
use super::incomplete::{Fill, IncompleteFactors};
use super::{LinearError, LinearSystem};

/// Solver of a diagonal block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockSolver {
    /// Sparse LU.
    Lu,
    /// Sparse LU in single precision if this reduces residuals, else [`BlockSolver::Lu`].
    SingleLu,
    /// Sparse Cholesky where the block is symmetric and positive definite before it is scaled, else sparse LU.
    Cholesky,
    /// Incomplete LU, node by node.
    Incomplete(Fill),
}

/// A set of unknowns with factors of their rows and columns: one step of a multiplicative Schwarz method.
///
/// Source: Smith, Bjørstad and Gropp 1996, Domain decomposition, chapter 1.
#[derive(Default)]
pub(super) struct Subdomain {
    members: Vec<u32>,
    factors: BlockFactors,
    correction: Vec<f64>,
}

/// Factors of a diagonal block.
enum BlockFactors {
    Lu(Box<Factors>),
    SingleLu(Box<CheckedFactors>),
    Cholesky(Box<CholeskyFactors>),
    Incomplete(Box<IncompleteFactors>),
}

impl Default for BlockFactors {
    fn default() -> Self {
        Self::Lu(Box::default())
    }
}

/// Position of unknowns that are not members.
const NONE: u32 = u32::MAX;

impl Subdomain {
    /// Factorises the rows and columns of `members`, ascending, of an equilibrated matrix. The members from position
    /// `n_primal` on are multipliers.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub(super) fn factorize(
        &mut self,
        system: &LinearSystem<'_>,
        members: Vec<u32>,
        n_primal: usize,
        solver: BlockSolver,
    ) -> Result<(), LinearError> {
        self.members = members;
        if self.members.is_empty() {
            return Ok(());
        }
        let block = restricted(system.matrix, &self.members);
        let nodes = renumbered(&system.layout.nodes(), &self.members);
        // Memory of factors is used again by factors of the same kind.
        let old = std::mem::take(&mut self.factors);
        if let BlockSolver::Incomplete(fill) = solver {
            let mut factors = if let BlockFactors::Incomplete(factors) = old { factors } else { Box::default() };
            factors.factorize(&block, &nodes, n_primal, fill)?;
            self.factors = BlockFactors::Incomplete(factors);
            return Ok(());
        }
        if solver == BlockSolver::Cholesky {
            let (row, column) = (system.scales.row(), system.scales.column());
            let ratios = self.members.iter().map(|i| row[*i as usize] / column[*i as usize]);
            if let Some(factors) = CholeskyFactors::new(&block, ratios.collect())? {
                self.factors = BlockFactors::Cholesky(Box::new(factors));
                return Ok(());
            }
        }
        if solver == BlockSolver::SingleLu {
            let mut factors = if let BlockFactors::SingleLu(factors) = old { factors } else { Box::default() };
            factors.factorize(&block, &nodes)?;
            self.factors = BlockFactors::SingleLu(factors);
            return Ok(());
        }
        let mut factors = if let BlockFactors::Lu(factors) = old { factors } else { Box::default() };
        factors.factorize(&block, &nodes)?;
        factors.probe(block.rows(), &mut self.correction)?;
        self.factors = BlockFactors::Lu(factors);
        Ok(())
    }

    /// Returns the unknowns of the subdomain, ascending.
    pub(super) fn members(&self) -> &[u32] {
        &self.members
    }

    /// Removes all members.
    pub(super) fn clear(&mut self) {
        self.members.clear();
    }

    /// Solves with the factors for the residual of the members, and adds the correction to `z`.
    pub(super) fn correct(&mut self, residual: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        self.correction.clear();
        self.correction.extend(self.members.iter().map(|i| residual[*i as usize]));
        self.solve_and_add(z)
    }

    /// Solves for the residual `r − A z` and adds the correction to `z`. `rows` are the rows of `A` of the members
    /// ([`rows_of`]).
    pub(super) fn correct_remainder(
        &mut self,
        rows: &CsMatI<f64, u32>,
        r: &[f64],
        z: &mut [f64],
    ) -> Result<(), LinearError> {
        self.correction.clear();
        self.correction.extend(self.members.iter().map(|i| -r[*i as usize]));
        sprs::prod::mul_acc_mat_vec_csr(rows.view(), &*z, self.correction.as_mut_slice());
        self.correction.iter_mut().for_each(|r| *r = -*r);
        self.solve_and_add(z)
    }

    fn solve_and_add(&mut self, z: &mut [f64]) -> Result<(), LinearError> {
        if self.members.is_empty() {
            return Ok(());
        }
        match &mut self.factors {
            BlockFactors::Lu(factors) => factors.substitute(&mut self.correction)?,
            BlockFactors::SingleLu(factors) => factors.substitute(&mut self.correction)?,
            BlockFactors::Cholesky(factors) => factors.substitute(&mut self.correction),
            BlockFactors::Incomplete(factors) => factors.substitute(&mut self.correction),
        }
        for (i, dz) in self.members.iter().zip(&self.correction) {
            z[*i as usize] += dz;
        }
        Ok(())
    }

    /// Subtracts the product of the matrix and the last correction from the residual.
    pub(super) fn update(&self, matrix: &CsMatI<f64, u32>, residual: &mut [f64]) {
        for (j, dz) in self.members.iter().zip(&self.correction) {
            let Some(column) = matrix.outer_view(*j as usize) else { continue };
            for (i, value) in column.iter() {
                residual[i] -= value * dz;
            }
        }
    }
}

/// Returns the marked unknowns and all unknowns in whose rows their columns have entries, ascending.
pub(super) fn with_neighbours(matrix: &CsMatI<f64, u32>, is_marked: &[bool]) -> Vec<u32> {
    let mut is_member = is_marked.to_vec();
    for (column, is_marked) in matrix.outer_iterator().zip(is_marked) {
        if *is_marked {
            column.indices().iter().for_each(|i| is_member[*i as usize] = true);
        }
    }
    (0..is_member.len() as u32).filter(|i| is_member[*i as usize]).collect()
}

/// Returns the submatrix of the rows and columns of the members.
fn restricted(matrix: &CsMatI<f64, u32>, members: &[u32]) -> CsMatI<f64, u32> {
    let mut position = vec![NONE; matrix.rows()];
    for (k, i) in members.iter().enumerate() {
        position[*i as usize] = k as u32;
    }
    let (mut column_ptr, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in members {
        let Some(column) = matrix.outer_view(*j as usize) else { continue };
        for (i, value) in column.iter().filter(|(i, _)| position[*i] != NONE) {
            rows.push(position[i]);
            values.push(*value);
        }
        column_ptr.push(rows.len() as u32);
    }
    CsMatI::new_csc((members.len(), members.len()), column_ptr, rows, values)
}

/// Returns the rows of the members, with all columns, compressed by rows.
pub(super) fn rows_of(matrix: &CsMatI<f64, u32>, members: &[u32]) -> CsMatI<f64, u32> {
    let mut position = vec![NONE; matrix.rows()];
    for (k, i) in members.iter().enumerate() {
        position[*i as usize] = k as u32;
    }
    let mut row_ptr = vec![0; members.len() + 1];
    for k in matrix.indices().iter().map(|i| position[*i as usize]).filter(|k| *k != NONE) {
        row_ptr[k as usize + 1] += 1;
    }
    for k in 0..members.len() {
        row_ptr[k + 1] += row_ptr[k];
    }
    let n_entries = row_ptr[members.len()] as usize;
    let (mut next, mut columns, mut values) = (row_ptr.clone(), vec![0; n_entries], vec![0.0; n_entries]);
    for (j, column) in (0..).zip(matrix.outer_iterator()) {
        for (i, value) in column.iter().filter(|(i, _)| position[*i] != NONE) {
            let next = &mut next[position[i] as usize];
            columns[*next as usize] = j;
            values[*next as usize] = *value;
            *next += 1;
        }
    }
    CsMatI::new((members.len(), matrix.cols()), row_ptr, columns, values)
}

/// Returns the nodes of the members, numbered without gaps in the order of their first member.
fn renumbered(nodes: &[u32], members: &[u32]) -> Vec<u32> {
    let mut names = BTreeMap::new();
    let number = |i: &u32| {
        let next = names.len() as u32;
        *names.entry(nodes[*i as usize]).or_insert(next)
    };
    members.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_members_have_all_columns_in_order() {
        // [ 1 0 2 ]
        // [ 0 3 0 ]
        // [ 4 5 6 ]
        let matrix =
            CsMatI::new_csc((3, 3), vec![0, 2, 4, 6], vec![0, 2, 1, 2, 0, 2], vec![1.0, 4.0, 3.0, 5.0, 2.0, 6.0]);
        let rows = rows_of(&matrix, &[0, 2]);
        let entries: Vec<_> = rows.iter().map(|(value, (k, j))| (k, j, *value)).collect();
        assert_eq!(entries, [(0, 0, 1.0), (0, 2, 2.0), (1, 0, 4.0), (1, 1, 5.0), (1, 2, 6.0)]);
        assert_eq!(rows_of(&matrix, &[]).nnz(), 0);
    }
}
