//! The only seam between physics and algebra.

use crate::{DofId, LocalSystem};

/// A set of items (cells, faces, interface pieces, contact facets) that each add a small dense system.
///
/// Sparsity pattern, parallel assembly, finite-difference check and benchmarks are written once, for this trait.
pub trait Contributions: Sync {
    /// Number of items.
    fn len(&self) -> usize;

    /// Whether there is nothing to add.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends the dofs of an item to `out`. They are distinct, and the same at every call.
    fn dofs(&self, item: usize, out: &mut Vec<DofId>);

    /// Adds residual and tangent of an item at the state `x` (the global vector) to `out`, which arrives as a
    /// zero system with one row per dof of the item.
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem);

    /// Whether the tangent does not depend on `x`; such contributions are assembled once per nonlinear solve.
    fn is_linear(&self) -> bool {
        false
    }

    /// Name for timings and reports.
    fn name(&self) -> &'static str;
}
