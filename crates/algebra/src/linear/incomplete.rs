//! Incomplete LU factors.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use sprs::CsMatI;

use super::LinearError;
use super::factors::signs;
use super::gmres::norm;
use super::nodes::NodeGraph;

/// Multiples of the shift of the diagonal entries of multipliers (see [`IncompleteFactors`]), tried in this order until
/// the factors are stable.
const SHIFTS: [f64; 4] = [0.0, 10.0, 40.0, 160.0];
/// Largest error `‖M⁻¹ A e - e‖ / ‖e‖` of stable factors `M` of `A`, with a vector `e` of entries ±1. Stable factors
/// have errors below one, and growth in unstable ones is exponential: the exact bound is not important.
const LARGEST_ERROR: f64 = 10.0;

/// Rule for the entries that incomplete factors keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    /// ILU(0): entries where the matrix has some.
    Pattern,
    /// ILUT: entries that are large.
    Threshold {
        /// Entries below this share of the norm of their row of the matrix are dropped.
        drop: f64,
        /// Largest ratio of the entries kept in each half of a row to the entries of the matrix in this half.
        growth: f64,
    },
}

impl Fill {
    /// ILUT with about twice the entries of the matrix, the fastest on the fluid's block.
    pub const THRESHOLD: Self = Self::Threshold { drop: 1e-2, growth: 2.0 };
}

/// Incomplete LU factors of a matrix of small dense blocks, one row and column of blocks per node.
///
/// Unknowns of a node (components of velocity, and pressure) are eliminated together, with partial pivoting among them.
/// Saddle points inside a node are therefore admissible. Blocks are dropped or kept as a whole, by their Frobenius
/// norm. If every unknown is its own node, the factors are those of the textbook ILU(0) and ILUT. Nodes are eliminated
/// in reverse Cuthill-McKee order.
///
/// The factors of a saddle point may be unstable: the Schur complement of the multiplier (of the pressure) is
/// `C - B A⁻¹ G`, of which incomplete factors contain little more than `C`, and the stabilisation `C` of smooth
/// pressures is nearly zero. Therefore the factors are tried on a vector of entries ±1. If they fail, the diagonal
/// entries of multipliers are raised by a multiple of `-diag(B diag(A)⁻¹ G)`, which for viscous flow is as large as the
/// mass matrix of the pressure over the viscosity, the Schur complement that is missing. The first multiple that makes
/// the factors stable is taken.
///
/// Sources: Saad 2003, Iterative methods for sparse linear systems, algorithms 10.3 and 10.6,
/// doi:10.1137/1.9780898718003; Chow and Saad 1997, Experimental study of ILU preconditioners for indefinite matrices,
/// doi:10.1016/S0377-0427(97)00171-4, for the trial and for shifts.
#[derive(Debug, Default)]
pub(super) struct IncompleteFactors {
    /// Unknowns in the order of elimination.
    unknowns: Vec<u32>,
    /// Row of blocks to its first place in `unknowns`; one longer than the number of rows.
    first: Vec<usize>,
    /// Factor L, with unit diagonal.
    lower: BlockRows,
    /// Factor U above its diagonal blocks.
    upper: BlockRows,
    /// Inverses of the diagonal blocks of U.
    pivots: BlockRows,
    /// Shifts of the diagonal, in the order of elimination.
    shift: Vec<f64>,
    work: Vec<f64>,
    scratch: Vec<f64>,
}

/// Rows of dense blocks, each stored by columns.
#[derive(Debug)]
struct BlockRows {
    /// Row to its first block; one longer than the number of rows.
    row_ptr: Vec<usize>,
    columns: Vec<u32>,
    /// Row to its first value; one longer than the number of rows.
    value_ptr: Vec<usize>,
    values: Vec<f64>,
}

impl Default for BlockRows {
    fn default() -> Self {
        Self { row_ptr: vec![0], columns: Vec::new(), value_ptr: vec![0], values: Vec::new() }
    }
}

impl BlockRows {
    fn clear(&mut self) {
        self.row_ptr.truncate(1);
        self.columns.clear();
        self.value_ptr.truncate(1);
        self.values.clear();
    }

    fn push(&mut self, column: u32, values: &[f64]) {
        self.columns.push(column);
        self.values.extend_from_slice(values);
    }

    fn end_row(&mut self) {
        self.row_ptr.push(self.columns.len());
        self.value_ptr.push(self.values.len());
    }

    fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.row_ptr[row]..self.row_ptr[row + 1]]
    }

    fn values(&self, row: usize) -> &[f64] {
        &self.values[self.value_ptr[row]..self.value_ptr[row + 1]]
    }
}

/// A row of blocks that is being eliminated.
#[derive(Default)]
struct WorkRow {
    columns: Vec<u32>,
    /// First value of each block, in the order of `columns`.
    offsets: Vec<usize>,
    values: Vec<f64>,
    /// Column to its place in `columns`; `NONE` where there is no block.
    place: Vec<u32>,
}

/// Place of columns without a block.
const NONE: u32 = u32::MAX;

impl WorkRow {
    fn clear(&mut self) {
        self.columns.drain(..).for_each(|column| self.place[column as usize] = NONE);
        self.offsets.clear();
        self.values.clear();
    }

    /// Returns the range of the values of a block. Appends a zero block of `size` values if the row has none.
    fn block(&mut self, column: u32, size: usize) -> std::ops::Range<usize> {
        let place = &mut self.place[column as usize];
        if *place == NONE {
            *place = self.columns.len() as u32;
            self.columns.push(column);
            self.offsets.push(self.values.len());
            self.values.resize(self.values.len() + size, 0.0);
        }
        let begin = self.offsets[self.place[column as usize] as usize];
        begin..begin + size
    }
}

impl IncompleteFactors {
    /// Computes the factors of a matrix whose unknowns from `n_primal` on are multipliers.
    ///
    /// # Errors
    /// [`LinearError::Unstable`]: the factors are unstable for all shifts of the multipliers.
    pub(super) fn factorize(
        &mut self,
        matrix: &CsMatI<f64, u32>,
        nodes: &[u32],
        n_primal: usize,
        fill: Fill,
    ) -> Result<(), LinearError> {
        let column_ptr = matrix.indptr();
        let graph = NodeGraph::new(column_ptr.raw_storage(), matrix.indices(), nodes).both_ways();
        let order = graph.reverse_cuthill_mckee();
        self.unknowns.clear();
        self.first.clear();
        self.first.push(0);
        for node in &order {
            self.unknowns.extend_from_slice(graph.unknowns(*node));
            self.first.push(self.unknowns.len());
        }
        let rows = by_rows(matrix, &self.unknowns, &self.first);
        let schur = schur_diagonal(matrix, n_primal);
        let has_multipliers = n_primal < matrix.rows();
        let mut error = f64::INFINITY;
        for weight in SHIFTS.iter().take(if has_multipliers { SHIFTS.len() } else { 1 }) {
            self.shift.clear();
            self.shift.extend(self.unknowns.iter().map(|unknown| weight * schur[*unknown as usize]));
            error = if self.eliminate_all(&rows, fill).is_some() { self.error(matrix) } else { f64::INFINITY };
            if error <= LARGEST_ERROR {
                return Ok(());
            }
        }
        Err(LinearError::Unstable { error })
    }

    /// Computes all rows of the factors; `None` if a pivot is missing.
    fn eliminate_all(&mut self, rows: &BlockRows, fill: Fill) -> Option<()> {
        for part in [&mut self.lower, &mut self.upper, &mut self.pivots] {
            part.clear();
        }
        let n_rows = self.first.len() - 1;
        let mut work = WorkRow { place: vec![NONE; n_rows], ..WorkRow::default() };
        (0..n_rows).try_for_each(|row| self.eliminate(row, rows, fill, &mut work))
    }

    /// Returns `‖M⁻¹ A e - e‖ / ‖e‖` for the factors M of A and a vector e of entries ±1.
    fn error(&mut self, matrix: &CsMatI<f64, u32>) -> f64 {
        let e: Vec<f64> = signs().take(matrix.rows()).collect();
        let mut image = vec![0.0; e.len()];
        sprs::prod::mul_acc_mat_vec_csc(matrix.view(), e.as_slice(), image.as_mut_slice());
        self.substitute(&mut image);
        let square: f64 = image.iter().zip(&e).map(|(a, b)| (a - b).powi(2)).sum();
        let error = (square / e.len() as f64).sqrt();
        // NaN if values have overflowed.
        if error.is_nan() { f64::INFINITY } else { error }
    }

    fn size(&self, row: usize) -> usize {
        self.first[row + 1] - self.first[row]
    }

    /// Computes a row of the factors from the rows before it; `None` if a pivot is missing.
    fn eliminate(&mut self, row: usize, matrix: &BlockRows, fill: Fill, work: &mut WorkRow) -> Option<()> {
        let size = self.size(row);
        work.clear();
        let mut values = matrix.values(row);
        for &column in matrix.columns(row) {
            let (block, rest) = values.split_at(size * self.size(column as usize));
            let at = work.block(column, block.len());
            work.values[at].copy_from_slice(block);
            values = rest;
        }
        let diagonal = work.block(row as u32, size * size).start;
        for (k, shift) in self.shift[self.first[row]..self.first[row + 1]].iter().enumerate() {
            work.values[diagonal + k * (size + 1)] += shift;
        }
        let smallest = match fill {
            Fill::Pattern => 0.0,
            Fill::Threshold { drop, .. } => drop * norm(matrix.values(row)),
        };
        let mut pending: BinaryHeap<Reverse<u32>> =
            work.columns.iter().filter(|column| (**column as usize) < row).map(|column| Reverse(*column)).collect();
        let mut lower = Vec::new();
        let mut factor = Vec::new();
        while let Some(Reverse(column)) = pending.pop() {
            let k = column as usize;
            let inner = self.size(k);
            let at = work.block(column, size * inner);
            factor.clear();
            factor.resize(size * inner, 0.0);
            subtract_product(&mut factor, &work.values[at.clone()], self.pivots.values(k), [size, inner, inner]);
            factor.iter_mut().for_each(|v| *v = -*v);
            if norm(&factor) < smallest {
                continue;
            }
            work.values[at].copy_from_slice(&factor);
            lower.push(column);
            let mut values = self.upper.values(k);
            for &other in self.upper.columns(k) {
                let width = self.size(other as usize);
                let (block, rest) = values.split_at(inner * width);
                values = rest;
                let is_new = work.place[other as usize] == NONE;
                if is_new && fill == Fill::Pattern {
                    continue;
                }
                let at = work.block(other, size * width);
                subtract_product(&mut work.values[at], &factor, block, [size, inner, width]);
                if is_new && (other as usize) < row {
                    pending.push(Reverse(other));
                }
            }
        }
        let upper = work.columns.iter().copied().filter(|column| *column as usize > row).collect();
        let n_lower = matrix.columns(row).iter().filter(|column| (**column as usize) < row).count();
        let n_upper = matrix.columns(row).iter().filter(|column| **column as usize > row).count();
        for (part, columns, n_known) in [(&mut self.lower, lower, n_lower), (&mut self.upper, upper, n_upper)] {
            for column in kept(columns, n_known, fill, smallest, work, &self.first, size) {
                let at = work.block(column, size * (self.first[column as usize + 1] - self.first[column as usize]));
                part.push(column, &work.values[at]);
            }
            part.end_row();
        }
        let at = work.block(row as u32, size * size);
        let inverse = inverse(&mut work.values[at], size)?;
        self.pivots.push(row as u32, &inverse);
        self.pivots.end_row();
        Some(())
    }

    /// Solves with the factors, in place.
    pub(super) fn substitute(&mut self, x: &mut [f64]) {
        let Self { unknowns, first, lower, upper, pivots, work, scratch, .. } = self;
        work.clear();
        work.extend(unknowns.iter().map(|unknown| x[*unknown as usize]));
        let n_rows = first.len() - 1;
        for row in 0..n_rows {
            let (known, own) = work.split_at_mut(first[row]);
            let own = &mut own[..first[row + 1] - first[row]];
            subtract_row(own, lower, row, |column| &known[first[column]..first[column + 1]]);
        }
        for row in (0..n_rows).rev() {
            let (own, known) = work.split_at_mut(first[row + 1]);
            let own = &mut own[first[row]..];
            let begin = first[row + 1];
            subtract_row(own, upper, row, |column| &known[first[column] - begin..first[column + 1] - begin]);
            // Multiplies by the inverse of the diagonal block: computes `0 - U_ii⁻¹ r`, then changes the sign.
            scratch.clear();
            scratch.resize(own.len(), 0.0);
            subtract_product(scratch, pivots.values(row), own, [own.len(), own.len(), 1]);
            own.iter_mut().zip(&*scratch).for_each(|(x, y)| *x = -y);
        }
        for (unknown, value) in unknowns.iter().zip(work) {
            x[*unknown as usize] = *value;
        }
    }
}

/// Subtracts a row of blocks times the values at its columns.
fn subtract_row<'a>(own: &mut [f64], part: &BlockRows, row: usize, at: impl Fn(usize) -> &'a [f64]) {
    let mut values = part.values(row);
    for column in part.columns(row) {
        let x = at(*column as usize);
        let (block, rest) = values.split_at(own.len() * x.len());
        subtract_product(own, block, x, [own.len(), x.len(), 1]);
        values = rest;
    }
}

/// Selects the blocks of one half of a row that stay, ascending.
fn kept(
    mut columns: Vec<u32>,
    n_known: usize,
    fill: Fill,
    smallest: f64,
    work: &WorkRow,
    first: &[usize],
    size: usize,
) -> Vec<u32> {
    if let Fill::Threshold { growth, .. } = fill {
        let norm_of = |column: &u32| {
            let begin = work.offsets[work.place[*column as usize] as usize];
            norm(&work.values[begin..begin + size * (first[*column as usize + 1] - first[*column as usize])])
        };
        let mut sized: Vec<(f64, u32)> =
            columns.iter().map(|column| (norm_of(column), *column)).filter(|(norm, _)| *norm >= smallest).collect();
        sized.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        sized.truncate((growth * n_known as f64).ceil() as usize);
        columns = sized.into_iter().map(|(_, column)| column).collect();
    }
    columns.sort_unstable();
    columns
}

/// Returns the matrix in rows of blocks, its unknowns in the order of elimination.
fn by_rows(matrix: &CsMatI<f64, u32>, unknowns: &[u32], first: &[usize]) -> BlockRows {
    let n_rows = first.len() - 1;
    let mut row_of = vec![0_u32; unknowns.len()];
    let mut place_of = vec![0_usize; unknowns.len()];
    for row in 0..n_rows {
        for (place, unknown) in unknowns[first[row]..first[row + 1]].iter().enumerate() {
            row_of[*unknown as usize] = row as u32;
            place_of[*unknown as usize] = place;
        }
    }
    // Entries of a column of blocks: place of the column in its block, row, value.
    let (column_ptr, rows, values) = (matrix.indptr(), matrix.indices(), matrix.data());
    let column_ptr = column_ptr.raw_storage();
    let entries = |column: usize| {
        unknowns[first[column]..first[column + 1]].iter().enumerate().flat_map(move |(place, unknown)| {
            let range = column_ptr[*unknown as usize] as usize..column_ptr[*unknown as usize + 1] as usize;
            range.map(move |k| (place, rows[k] as usize, values[k]))
        })
    };
    // Two passes over the columns: the first finds the blocks of each row, the second fills in their values.
    let mut blocks = BlockRows { row_ptr: vec![0; n_rows + 1], value_ptr: vec![0; n_rows + 1], ..BlockRows::default() };
    let mut mark = vec![NONE; n_rows];
    for column in 0..n_rows {
        for (_, unknown, _) in entries(column) {
            let row = row_of[unknown] as usize;
            if mark[row] != column as u32 {
                mark[row] = column as u32;
                blocks.row_ptr[row + 1] += 1;
                blocks.value_ptr[row + 1] += (first[row + 1] - first[row]) * (first[column + 1] - first[column]);
            }
        }
    }
    for row in 0..n_rows {
        blocks.row_ptr[row + 1] += blocks.row_ptr[row];
        blocks.value_ptr[row + 1] += blocks.value_ptr[row];
    }
    blocks.columns = vec![0; blocks.row_ptr[n_rows]];
    blocks.values = vec![0.0; blocks.value_ptr[n_rows]];
    let (mut next, mut next_value) = (blocks.row_ptr.clone(), blocks.value_ptr.clone());
    let mut begin = vec![0; n_rows];
    mark.fill(NONE);
    for column in 0..n_rows {
        for (place, unknown, value) in entries(column) {
            let row = row_of[unknown] as usize;
            let size = first[row + 1] - first[row];
            if mark[row] != column as u32 {
                mark[row] = column as u32;
                blocks.columns[next[row]] = column as u32;
                next[row] += 1;
                begin[row] = next_value[row];
                next_value[row] += size * (first[column + 1] - first[column]);
            }
            blocks.values[begin[row] + place * size + place_of[unknown]] = value;
        }
    }
    blocks
}

/// Returns `-diag(B diag(A)⁻¹ G)` for multipliers, the unknowns from `n_primal` on; zero for the others.
fn schur_diagonal(matrix: &CsMatI<f64, u32>, n_primal: usize) -> Vec<f64> {
    let mut schur = vec![0.0; matrix.rows()];
    for (k, column) in matrix.outer_iterator().take(n_primal).enumerate() {
        let Some(pivot) = matrix.get(k, k).filter(|pivot| **pivot != 0.0) else { continue };
        for (i, b) in column.iter().filter(|(i, _)| *i >= n_primal) {
            schur[i] -= b * matrix.get(k, i).copied().unwrap_or(0.0) / pivot;
        }
    }
    schur
}

/// Computes `c -= a b` for blocks of sizes `m x k` and `k x n`, stored by columns.
#[inline]
fn subtract_product(c: &mut [f64], a: &[f64], b: &[f64], [m, k, n]: [usize; 3]) {
    match (m, k) {
        (2, 2) => subtract_square_product(c, a, b, [0.0; 2]),
        (3, 3) => subtract_square_product(c, a, b, [0.0; 3]),
        (4, 4) => subtract_square_product(c, a, b, [0.0; 4]),
        _ => {
            for j in 0..n {
                for l in 0..k {
                    let factor = b[j * k + l];
                    for i in 0..m {
                        c[j * m + i] -= a[l * m + i] * factor;
                    }
                }
            }
        }
    }
}

/// Computes `c -= a b` for square blocks `a` of the size of the scratch memory `sum`.
#[inline]
fn subtract_square_product<const D: usize>(c: &mut [f64], a: &[f64], b: &[f64], mut sum: [f64; D]) {
    let (a, _) = a.as_chunks::<D>();
    for (c, b) in c.as_chunks_mut::<D>().0.iter_mut().zip(b.as_chunks::<D>().0) {
        sum.copy_from_slice(c);
        for (a, factor) in a.iter().zip(b) {
            for i in 0..D {
                sum[i] -= a[i] * factor;
            }
        }
        c.copy_from_slice(&sum);
    }
}

/// Returns the inverse of a dense block, by Gauss-Jordan elimination with partial pivoting; overwrites the block.
fn inverse(a: &mut [f64], n: usize) -> Option<Vec<f64>> {
    let mut inverse = vec![0.0; n * n];
    (0..n).for_each(|i| inverse[i * n + i] = 1.0);
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[k * n + i].abs().total_cmp(&a[k * n + j].abs()))?;
        let value = a[k * n + pivot];
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        for j in 0..n {
            a.swap(j * n + k, j * n + pivot);
            inverse.swap(j * n + k, j * n + pivot);
        }
        for j in 0..n {
            a[j * n + k] /= value;
            inverse[j * n + k] /= value;
        }
        for i in (0..n).filter(|i| *i != k) {
            let factor = a[k * n + i];
            for j in 0..n {
                a[j * n + i] -= factor * a[j * n + k];
                inverse[j * n + i] -= factor * inverse[j * n + k];
            }
        }
    }
    Some(inverse)
}
