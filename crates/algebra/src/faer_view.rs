//! Our sparse arrays as faer matrices, without copying.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

/// Borrows the arrays of a square column-compressed matrix with sorted rows as a faer matrix.
pub(crate) fn faer_view<'a>(
    column_ptr: &'a [u32],
    rows: &'a [u32],
    values: &'a [f64],
) -> SparseColMatRef<'a, u32, f64> {
    let n = column_ptr.len() - 1;
    SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, column_ptr, None, rows), values)
}
