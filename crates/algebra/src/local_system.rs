//! Residual and tangent of one item (cell, face, piece).

use crate::DofId;

/// A small dense system: the contribution of one item to the global residual and tangent.
///
/// Rows and columns are local, in the order of the item's dofs. The tangent is stored column by column.
#[derive(Clone, Debug, Default)]
pub struct LocalSystem {
    n: usize,
    residual: Vec<f64>,
    tangent: Vec<f64>,
    residual_only: bool,
    /// Work space of [`crate::Tied`].
    pub(crate) scratch: Option<Box<TiedRows>>,
}

/// Memory for one item in its own dofs, some of which are tied to others.
#[derive(Clone, Debug, Default)]
pub(crate) struct TiedRows {
    pub(crate) system: LocalSystem,
    pub(crate) dofs: Vec<DofId>,
    pub(crate) free: Vec<DofId>,
    /// Dof to its first entry in `entries`.
    pub(crate) first_entry: Vec<usize>,
    /// Rows of `P`: positions in `free`, with factors.
    pub(crate) entries: Vec<(usize, f64)>,
}

impl LocalSystem {
    /// Creates an empty system; [`LocalSystem::reset`] gives it a size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Resets to a zero system of size `n` with tangent; keeps the allocation.
    pub fn reset(&mut self, n: usize) {
        self.n = n;
        self.residual_only = false;
        self.residual.clear();
        self.residual.resize(n, 0.0);
        self.tangent.clear();
        self.tangent.resize(n * n, 0.0);
    }

    /// Resets to a system of size `n` of which only the residual is read. The residual is zero; the tangent is
    /// arbitrary.
    pub fn reset_residual(&mut self, n: usize) {
        self.n = n;
        self.residual_only = true;
        self.residual.clear();
        self.residual.resize(n, 0.0);
        self.tangent.resize(n * n, 0.0);
    }

    /// Returns whether the tangent is read. A term may skip its tangent otherwise.
    #[inline]
    pub fn has_tangent(&self) -> bool {
        !self.residual_only
    }

    /// Returns the number of unknowns.
    #[inline]
    pub fn len(&self) -> usize {
        self.n
    }

    /// Returns whether there are no unknowns.
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

    /// Adds a vector of `N` entries to the residual, from `row` on.
    #[inline]
    pub fn add_vector<const N: usize>(&mut self, row: usize, values: impl Into<[f64; N]>) {
        for (r, v) in self.residual[row..row + N].iter_mut().zip(values.into()) {
            *r += v;
        }
    }

    /// Adds a block of `R` rows and `C` columns, given column by column, at (`row`, `column`) of the tangent.
    #[inline]
    pub fn add_block<const R: usize, const C: usize>(
        &mut self,
        row: usize,
        column: usize,
        block: impl Into<[[f64; R]; C]>,
    ) {
        for (k, source) in block.into().into_iter().enumerate() {
            let start = (column + k) * self.n + row;
            for (t, v) in self.tangent[start..start + R].iter_mut().zip(source) {
                *t += v;
            }
        }
    }

    /// Returns a column of the tangent, for accumulation; it has one entry per unknown.
    #[inline]
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.tangent[column * self.n..][..self.n]
    }

    /// Returns the residual.
    #[inline]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Returns the tangent, column by column.
    #[inline]
    pub fn tangent(&self) -> &[f64] {
        &self.tangent
    }

    /// Returns one entry of the tangent.
    #[inline]
    pub fn tangent_at(&self, row: usize, column: usize) -> f64 {
        self.tangent[column * self.n + row]
    }
}
