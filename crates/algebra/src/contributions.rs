//! The interface between physics and algebra.

use std::ops::Range;

use crate::{DofId, LocalSystem};

/// A set of items (cells, faces, interface pieces, contact facets) that each add a small dense system.
///
/// Sparsity pattern, parallel assembly, finite-difference check and benchmarks are written once, for this trait. Weak
/// forms implement it through [`crate::Integral`].
pub trait Contributions: Sync {
    /// Returns the number of items.
    fn len(&self) -> usize;

    /// Returns whether there are no items.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends the dofs of an item to `out`. They are distinct, and the same in every call.
    fn dofs(&self, item: usize, out: &mut Vec<DofId>);

    /// Adds residual and tangent of an item at the state `x` (the global vector) to `out`, a zero system with one row
    /// per dof of the item.
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem);

    /// Returns whether the tangent does not depend on `x`. Such contributions are assembled once per nonlinear solve.
    fn is_linear(&self) -> bool {
        false
    }

    /// Returns a hash of the non-smooth state of an item at `x`, such as the set of its points in contact. It contains
    /// the number of the item. Contributions without such a state return `None` for all items.
    ///
    /// When it changes, Newton's method renews the factorisation, and does not accept the iterate.
    fn regime(&self, _item: usize, _x: &[f64]) -> Option<u64> {
        None
    }

    /// Returns the name for timings and reports.
    fn name(&self) -> &'static str;
}

/// Calls `visit` with the number, the dofs and the residual at the state `x` of each item of a range. Items whose dofs
/// `selects` does not select are left out.
pub fn for_each_residual(
    contributions: &(impl Contributions + ?Sized),
    items: Range<usize>,
    x: &[f64],
    selects: impl Fn(&[DofId]) -> bool,
    mut visit: impl FnMut(usize, &[DofId], &[f64]),
) {
    let (mut dofs, mut local) = (Vec::new(), LocalSystem::new());
    for item in items {
        dofs.clear();
        contributions.dofs(item, &mut dofs);
        if selects(&dofs) {
            local.reset_residual(dofs.len());
            contributions.add(item, x, &mut local);
            visit(item, &dofs, local.residual());
        }
    }
}
