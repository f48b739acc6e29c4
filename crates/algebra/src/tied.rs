//! Contributions with tied dofs.

use crate::local_system::TiedRows;
use crate::{Constraints, Contributions, DofId, LocalSystem};

/// A contribution with tied dofs, expressed in their masters.
///
/// With the state `x = P y` of an item, where `y` has each of its free dofs once, residual and tangent become `Pᵀ r`
/// and `Pᵀ K P`: the principle of virtual work on the states that the ties admit.
pub struct Tied<'a> {
    plain: &'a dyn Contributions,
    constraints: &'a Constraints,
}

impl<'a> Tied<'a> {
    /// Returns a contribution in terms of free dofs; `None` if none of its dofs is tied.
    pub fn new(plain: &'a dyn Contributions, constraints: &'a Constraints) -> Option<Self> {
        let (first, last) = (constraints.ties().next()?.0, constraints.ties().next_back()?.0);
        let mut dofs = Vec::new();
        let is_tied = |item: usize| {
            dofs.clear();
            plain.dofs(item, &mut dofs);
            dofs.iter().any(|dof| (first..=last).contains(dof) && constraints.tie_of(*dof).is_some())
        };
        (0..plain.len()).any(is_tied).then_some(Self { plain, constraints })
    }

    /// Lists the free dofs, each once: the dofs of the item that are not tied, in their order, then the masters of the
    /// tied ones.
    fn free(&self, dofs: &[DofId], free: &mut Vec<DofId>) {
        let first = free.len();
        free.extend(dofs.iter().filter(|dof| self.constraints.tie_of(**dof).is_none()));
        for (other, _) in dofs.iter().filter_map(|dof| self.constraints.tie_of(*dof)).flatten() {
            if !free[first..].contains(other) {
                free.push(*other);
            }
        }
    }
}

impl TiedRows {
    /// Finds the rows of `P`.
    fn relate(&mut self, constraints: &Constraints) {
        let Self { dofs, free, first_entry, entries, .. } = self;
        first_entry.clear();
        entries.clear();
        let place = |dof: &DofId| free.iter().position(|other| other == dof);
        for dof in dofs.iter() {
            first_entry.push(entries.len());
            match constraints.tie_of(*dof) {
                None => entries.extend(place(dof).map(|at| (at, 1.0))),
                Some(to) => entries.extend(to.iter().filter_map(|(other, factor)| Some((place(other)?, *factor)))),
            }
        }
        first_entry.push(entries.len());
    }

    fn row(&self, dof: usize) -> &[(usize, f64)] {
        &self.entries[self.first_entry[dof]..self.first_entry[dof + 1]]
    }

    /// Adds `Pᵀ r` and, if the tangent is read, `Pᵀ K P`.
    fn add_to(&self, out: &mut LocalSystem) {
        for (row, residual) in self.system.residual().iter().enumerate() {
            self.row(row).iter().for_each(|(to, factor)| out.add(*to, factor * residual));
        }
        if !out.has_tangent() {
            return;
        }
        for column in 0..self.dofs.len() {
            for (to_column, column_factor) in self.row(column) {
                for row in 0..self.dofs.len() {
                    let value = column_factor * self.system.tangent_at(row, column);
                    self.row(row).iter().for_each(|(to, factor)| out.add_tangent(*to, *to_column, factor * value));
                }
            }
        }
    }
}

impl Contributions for Tied<'_> {
    fn len(&self) -> usize {
        self.plain.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let mut dofs = Vec::new();
        self.plain.dofs(item, &mut dofs);
        self.free(&dofs, out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let mut scratch = out.scratch.take().unwrap_or_default();
        scratch.dofs.clear();
        self.plain.dofs(item, &mut scratch.dofs);
        scratch.free.clear();
        self.free(&scratch.dofs, &mut scratch.free);
        scratch.relate(self.constraints);
        if out.has_tangent() {
            scratch.system.reset(scratch.dofs.len());
        } else {
            scratch.system.reset_residual(scratch.dofs.len());
        }
        self.plain.add(item, x, &mut scratch.system);
        scratch.add_to(out);
        out.scratch = Some(scratch);
    }

    fn is_linear(&self) -> bool {
        self.plain.is_linear()
    }

    fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
        self.plain.regime(item, x)
    }

    fn name(&self) -> &'static str {
        self.plain.name()
    }
}
