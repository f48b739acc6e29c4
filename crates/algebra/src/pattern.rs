//! Sparsity pattern of a list of contributions, and the position of each of their entries.

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
    dofs: Vec<DofId>,
    positions: Vec<u32>,
    scratch: PatternMemory,
}

/// Memory that is only used while a pattern is built.
#[derive(Clone, Debug, Default)]
struct PatternMemory {
    /// Column to its first entry in `incidence`.
    first_incidence: Vec<usize>,
    /// Items around each column, in their order.
    incidence: Vec<Incidence>,
    /// Scratch memory, one number per row.
    mark: Vec<u32>,
    /// Rows in the order in which they were found, then the positions of the mirror images of the entries.
    unsorted: Vec<u32>,
    /// The previous `first_item`, `first_dof` and `dofs`.
    before: (Vec<usize>, Vec<usize>, Vec<DofId>),
}

/// One column of one item.
#[derive(Clone, Copy, Debug, Default)]
struct Incidence {
    /// First entry of the item in `dofs`; it also identifies the item.
    first_dof: u32,
    /// Number of dofs of the item.
    len: u32,
    /// First entry of the column in `positions`.
    first_position: u32,
}

impl Incidence {
    fn dofs(self) -> Range<usize> {
        self.first_dof as usize..(self.first_dof + self.len) as usize
    }

    fn positions(self) -> Range<usize> {
        self.first_position as usize..(self.first_position + self.len) as usize
    }
}

impl Pattern {
    /// Creates the pattern of `n` unknowns coupled by `contributions`.
    ///
    /// # Panics
    /// A contribution names a dof outside of the `n` unknowns, or there are more entries than `u32` can number.
    pub fn new(n: usize, contributions: &[&dyn Contributions]) -> Self {
        let mut pattern = Self::default();
        pattern.rebuild(n, contributions);
        pattern
    }

    /// Recomputes the pattern for other contributions, keeping the allocations; returns whether it changed. If the dofs
    /// of all items are unchanged, nothing else is computed.
    pub(crate) fn rebuild(&mut self, n: usize, contributions: &[&dyn Contributions]) -> bool {
        assert!(n < u32::MAX as usize, "{n} unknowns do not fit");
        if !self.collect_dofs(n, contributions) {
            return false;
        }
        self.sort_by_column(n);
        self.collect_rows(n);
        self.sort_rows(n);
        self.map_items();
        true
    }

    /// Collects the dofs of all items; returns whether they differ from the previous ones.
    fn collect_dofs(&mut self, n: usize, contributions: &[&dyn Contributions]) -> bool {
        let before = &mut self.scratch.before;
        std::mem::swap(&mut before.0, &mut self.first_item);
        std::mem::swap(&mut before.1, &mut self.first_dof);
        std::mem::swap(&mut before.2, &mut self.dofs);
        let Self { first_item, first_dof, dofs, .. } = self;
        first_item.clear();
        first_item.push(0);
        first_dof.clear();
        first_dof.push(0);
        dofs.clear();
        for contribution in contributions {
            for item in 0..contribution.len() {
                contribution.dofs(item, dofs);
                let first = first_dof.last().copied().unwrap_or(0);
                for dof in &dofs[first..] {
                    assert!(dof.index() < n, "{} item {item}: dof {} of {n}", contribution.name(), dof.index());
                }
                first_dof.push(dofs.len());
            }
            first_item.push(first_dof.len() - 1);
        }
        let before = &self.scratch.before;
        if n == self.n_unknowns() && before.0 == self.first_item && before.1 == self.first_dof && before.2 == self.dofs
        {
            return false;
        }
        self.first_position.clear();
        self.first_position.push(0);
        let mut n_positions = 0;
        for range in self.first_dof.windows(2) {
            n_positions += (range[1] - range[0]).pow(2);
            self.first_position.push(n_positions);
        }
        assert!(n_positions <= u32::MAX as usize, "too many entries");
        true
    }

    fn sort_by_column(&mut self, n: usize) {
        let PatternMemory { first_incidence, incidence, .. } = &mut self.scratch;
        // Counting sort: `first_incidence[c + 1]` moves from the start to the end of column c while it is filled.
        first_incidence.clear();
        first_incidence.resize(n + 2, 0);
        for dof in &self.dofs {
            first_incidence[dof.index() + 2] += 1;
        }
        for column in 2..n + 2 {
            first_incidence[column] += first_incidence[column - 1];
        }
        incidence.clear();
        incidence.resize(self.dofs.len(), Incidence::default());
        for (range, first_position) in self.first_dof.windows(2).zip(&self.first_position) {
            let len = range[1] - range[0];
            for (local, dof) in self.dofs[range[0]..range[1]].iter().enumerate() {
                let next = &mut first_incidence[dof.index() + 1];
                let first_position = (first_position + local * len) as u32;
                incidence[*next] = Incidence { first_dof: range[0] as u32, len: len as u32, first_position };
                *next += 1;
            }
        }
    }

    /// Finds the rows of each column, in any order, and writes the position of each entry in that order to `positions`.
    fn collect_rows(&mut self, n: usize) {
        let PatternMemory { first_incidence, incidence, mark: place, unsorted, .. } = &mut self.scratch;
        unsorted.clear();
        self.column_ptr.clear();
        self.column_ptr.push(0);
        self.positions.resize(self.first_position.last().copied().unwrap_or(0), 0);
        place.clear();
        place.resize(n, u32::MAX);
        for column in 0..n {
            // Places before `first` belong to other columns.
            let first = unsorted.len() as u32;
            place[column] = first;
            unsorted.push(column as u32);
            for item in &incidence[first_incidence[column]..first_incidence[column + 1]] {
                for (entry, row) in self.positions[item.positions()].iter_mut().zip(&self.dofs[item.dofs()]) {
                    let place = &mut place[row.index()];
                    if *place == u32::MAX || *place < first {
                        *place = unsorted.len() as u32;
                        unsorted.push(row.index() as u32);
                    }
                    *entry = *place;
                }
            }
            assert!(unsorted.len() < u32::MAX as usize, "too many entries");
            self.column_ptr.push(unsorted.len() as u32);
        }
    }

    /// Sorts the rows of each column. The pattern is symmetric: visiting the columns in order appends each column to
    /// its rows in order. Replaces each unsorted entry by the position of its mirror image in the sorted pattern.
    fn sort_rows(&mut self, n: usize) {
        let PatternMemory { mark: next, unsorted: mirror, .. } = &mut self.scratch;
        next.copy_from_slice(&self.column_ptr[..n]);
        self.rows.resize(mirror.len(), 0);
        for column in 0..n {
            for entry in &mut mirror[self.column_ptr[column] as usize..self.column_ptr[column + 1] as usize] {
                let next = &mut next[*entry as usize];
                self.rows[*next as usize] = column as u32;
                *entry = *next;
                *next += 1;
            }
        }
    }

    /// Writes the scatter map: the position of an entry in the sorted pattern is stored at its mirror image, so
    /// mirrored entries of an item are swapped.
    fn map_items(&mut self) {
        let mirror = &self.scratch.unsorted;
        for (range, dofs) in self.first_position.windows(2).zip(self.first_dof.windows(2)) {
            let (positions, len) = (&mut self.positions[range[0]..range[1]], dofs[1] - dofs[0]);
            for column in 0..len {
                for row in 0..=column {
                    let (upper, lower) = (column * len + row, row * len + column);
                    let of_upper = mirror[positions[lower] as usize];
                    positions[lower] = mirror[positions[upper] as usize];
                    positions[upper] = of_upper;
                }
            }
        }
    }

    /// Returns the number of unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.column_ptr.len().saturating_sub(1)
    }

    /// Returns the number of stored entries.
    pub fn n_entries(&self) -> usize {
        self.rows.len()
    }

    /// Returns the position of the first entry of each column, and at the end the number of entries.
    pub fn column_ptr(&self) -> &[u32] {
        &self.column_ptr
    }

    /// Returns the rows of all entries, ascending within each column.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Returns the indices of the items of a contribution among the items of all contributions.
    pub(crate) fn items(&self, contribution: usize) -> Range<usize> {
        self.first_item[contribution]..self.first_item[contribution + 1]
    }

    /// Returns the number of items of all contributions.
    pub(crate) fn n_items(&self) -> usize {
        self.first_dof.len().saturating_sub(1)
    }

    /// Returns the global dofs of an item.
    #[inline]
    pub(crate) fn dofs(&self, item: usize) -> &[DofId] {
        &self.dofs[self.first_dof[item]..self.first_dof[item + 1]]
    }

    /// Returns the positions of the tangent entries of an item in the value array, column by column.
    #[inline]
    pub(crate) fn positions(&self, item: usize) -> &[u32] {
        &self.positions[self.first_position[item]..self.first_position[item + 1]]
    }
}
