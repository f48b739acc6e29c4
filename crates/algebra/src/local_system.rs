//! Residual and tangent of one item (cell, face, piece).

use crate::tied::Scratch;

/// A small dense system: what one item adds to the global residual and tangent.
///
/// Rows and columns are local, in the order of the item's dofs. The tangent is stored column by column.
#[derive(Clone, Debug, Default)]
pub struct LocalSystem {
    n: usize,
    residual: Vec<f64>,
    tangent: Vec<f64>,
    residual_only: bool,
    /// Memory for an item of other unknowns from which this one is made.
    pub(crate) scratch: Option<Box<Scratch>>,
}

impl LocalSystem {
    /// An empty system; [`LocalSystem::reset`] gives it a size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes this a zero system with `n` unknowns that wants its tangent, keeping its memory.
    pub fn reset(&mut self, n: usize) {
        self.n = n;
        self.residual_only = false;
        self.residual.clear();
        self.residual.resize(n, 0.0);
        self.tangent.clear();
        self.tangent.resize(n * n, 0.0);
    }

    /// Makes this a system with `n` unknowns of which only the residual will be read: that is zero, the tangent is not.
    pub fn reset_residual(&mut self, n: usize) {
        self.n = n;
        self.residual_only = true;
        self.residual.clear();
        self.residual.resize(n, 0.0);
        self.tangent.resize(n * n, 0.0);
    }

    /// Whether the tangent will be read. A kernel may skip the work for it when it will not; it need not.
    #[inline]
    pub fn wants_tangent(&self) -> bool {
        !self.residual_only
    }

    /// Number of unknowns.
    #[inline]
    pub fn len(&self) -> usize {
        self.n
    }

    /// Whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Adds to one entry of the residual.
    #[inline]
    pub fn add(&mut self, row: usize, value: f64) {
        self.residual[row] += value;
    }

    /// Adds to one entry of the tangent.
    #[inline]
    pub fn add_tangent(&mut self, row: usize, column: usize, value: f64) {
        self.tangent[column * self.n + row] += value;
    }

    /// Adds a vector to the residual, from `row` on.
    #[inline]
    pub fn add_vector(&mut self, row: usize, values: &[f64]) {
        for (r, v) in self.residual[row..row + values.len()].iter_mut().zip(values) {
            *r += v;
        }
    }

    /// Adds a block with `n_rows` rows, given column by column, at (`row`, `column`) of the tangent.
    #[inline]
    pub fn add_block(&mut self, row: usize, column: usize, n_rows: usize, block: &[f64]) {
        for (k, source) in block.chunks_exact(n_rows).enumerate() {
            let start = (column + k) * self.n + row;
            for (t, v) in self.tangent[start..start + n_rows].iter_mut().zip(source) {
                *t += v;
            }
        }
    }

    /// A column of the tangent, to add to; it has one entry per unknown.
    #[inline]
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.tangent[column * self.n..][..self.n]
    }

    /// The residual.
    #[inline]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// The tangent, column by column.
    #[inline]
    pub fn tangent(&self) -> &[f64] {
        &self.tangent
    }

    /// One entry of the tangent.
    #[inline]
    pub fn tangent_at(&self, row: usize, column: usize) -> f64 {
        self.tangent[column * self.n + row]
    }
}
