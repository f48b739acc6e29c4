//! Sparsity pattern of a list of contributions, and where each of their entries goes.

use std::ops::Range;

use crate::{Contributions, DofId};

/// Column-compressed pattern with sorted rows and a full diagonal, and the map that scatters items into it.
///
/// For each item the map holds the positions of its n × n tangent entries in the value array, column by column, so
/// that assembly never searches.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    column_ptr: Vec<u32>,
    rows: Vec<u32>,
    /// Contribution to its first item; items of all contributions are numbered consecutively.
    first_item: Vec<usize>,
    /// Item to its first entry in `dofs`.
    first_dof: Vec<usize>,
    /// Item to its first entry in `positions`.
    first_position: Vec<usize>,
    dofs: Vec<u32>,
    positions: Vec<u32>,
    scratch: Scratch,
}

/// Memory that is only used while a pattern is built.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// Column to its first entry in `incidence`.
    first_incidence: Vec<usize>,
    /// Item and local column, sorted by global column.
    incidence: Vec<(u32, u32)>,
    mark: Vec<u32>,
    position: Vec<u32>,
}

impl Pattern {
    /// The pattern of `n` unknowns coupled by `contributions`.
    ///
    /// # Panics
    /// A contribution names a dof outside of the `n` unknowns, or there are more entries than `u32` can number.
    pub fn new(n: usize, contributions: &[&dyn Contributions]) -> Self {
        Self::default().recycle(n, contributions)
    }

    /// As [`Pattern::new`], in the memory of an old pattern.
    pub fn recycle(mut self, n: usize, contributions: &[&dyn Contributions]) -> Self {
        assert!(n < u32::MAX as usize, "{n} unknowns do not fit");
        self.collect_dofs(n, contributions);
        self.sort_by_column(n);
        self.number_entries(n);
        self
    }

    fn collect_dofs(&mut self, n: usize, contributions: &[&dyn Contributions]) {
        self.first_item.clear();
        self.first_item.push(0);
        self.first_dof.clear();
        self.first_dof.push(0);
        self.first_position.clear();
        self.first_position.push(0);
        self.dofs.clear();
        let mut of_item: Vec<DofId> = Vec::new();
        let mut n_positions = 0;
        for contribution in contributions {
            for item in 0..contribution.len() {
                of_item.clear();
                contribution.dofs(item, &mut of_item);
                for dof in &of_item {
                    assert!(dof.index() < n, "{} item {item}: dof {} of {n}", contribution.name(), dof.index());
                    self.dofs.push(dof.0);
                }
                n_positions += of_item.len() * of_item.len();
                self.first_dof.push(self.dofs.len());
                self.first_position.push(n_positions);
            }
            self.first_item.push(self.first_dof.len() - 1);
        }
        assert!(self.first_dof.len() <= u32::MAX as usize, "too many items");
    }

    fn sort_by_column(&mut self, n: usize) {
        let Scratch { first_incidence, incidence, .. } = &mut self.scratch;
        // Counting sort: `first_incidence[c + 1]` runs from the begin to the end of column c while it is filled.
        first_incidence.clear();
        first_incidence.resize(n + 2, 0);
        for &dof in &self.dofs {
            first_incidence[dof as usize + 2] += 1;
        }
        for column in 2..n + 2 {
            first_incidence[column] += first_incidence[column - 1];
        }
        incidence.clear();
        incidence.resize(self.dofs.len(), (0, 0));
        for (item, range) in self.first_dof.windows(2).enumerate() {
            for (local, &dof) in self.dofs[range[0]..range[1]].iter().enumerate() {
                let next = &mut first_incidence[dof as usize + 1];
                incidence[*next] = (item as u32, local as u32);
                *next += 1;
            }
        }
    }

    fn number_entries(&mut self, n: usize) {
        let Scratch { first_incidence, incidence, mark, position } = &mut self.scratch;
        let n_positions = self.first_position.last().copied().unwrap_or(0);
        self.positions.resize(n_positions, 0);
        self.rows.clear();
        self.column_ptr.clear();
        self.column_ptr.push(0);
        mark.clear();
        mark.resize(n, u32::MAX);
        position.resize(n, 0);
        for column in 0..n {
            let items = &incidence[first_incidence[column]..first_incidence[column + 1]];
            let begin = self.rows.len();
            mark[column] = column as u32;
            self.rows.push(column as u32);
            for &(item, _) in items {
                for &row in &self.dofs[self.first_dof[item as usize]..self.first_dof[item as usize + 1]] {
                    if mark[row as usize] != column as u32 {
                        mark[row as usize] = column as u32;
                        self.rows.push(row);
                    }
                }
            }
            self.rows[begin..].sort_unstable();
            for (k, &row) in self.rows[begin..].iter().enumerate() {
                position[row as usize] = (begin + k) as u32;
            }
            for &(item, local) in items {
                let dofs = &self.dofs[self.first_dof[item as usize]..self.first_dof[item as usize + 1]];
                let first = self.first_position[item as usize] + local as usize * dofs.len();
                for (entry, &row) in self.positions[first..first + dofs.len()].iter_mut().zip(dofs) {
                    *entry = position[row as usize];
                }
            }
            assert!(self.rows.len() < u32::MAX as usize, "too many entries");
            self.column_ptr.push(self.rows.len() as u32);
        }
    }

    /// Number of unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.column_ptr.len().saturating_sub(1)
    }

    /// Number of stored entries.
    pub fn n_entries(&self) -> usize {
        self.rows.len()
    }

    /// Column to its first entry; one longer than the number of columns.
    pub fn column_ptr(&self) -> &[u32] {
        &self.column_ptr
    }

    /// Rows of all entries, ascending within each column.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Where items of contribution number `contribution` (in the order of construction) go.
    pub fn map(&self, contribution: usize) -> ItemMap<'_> {
        ItemMap { pattern: self, items: self.first_item[contribution]..self.first_item[contribution + 1] }
    }
}

/// Rows and matrix positions of the items of one contribution.
#[derive(Clone, Debug)]
pub struct ItemMap<'a> {
    pattern: &'a Pattern,
    items: Range<usize>,
}

impl<'a> ItemMap<'a> {
    /// Number of items.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there are no items.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Global dofs of an item.
    #[inline]
    pub fn dofs(&self, item: usize) -> &'a [u32] {
        let k = self.items.start + item;
        &self.pattern.dofs[self.pattern.first_dof[k]..self.pattern.first_dof[k + 1]]
    }

    /// Positions of the tangent entries of an item in the value array, column by column.
    #[inline]
    pub fn positions(&self, item: usize) -> &'a [u32] {
        let k = self.items.start + item;
        &self.pattern.positions[self.pattern.first_position[k]..self.pattern.first_position[k + 1]]
    }
}
