//! The matrix that was factorised last, also as lists of numbers.

use sprs::CsMatI;

use crate::DofKey;
use crate::linear::checked_factors::CheckedFactors;
use crate::linear::{Equilibration, LinearError, LinearSystem};

/// The matrix that was factorised last.
#[derive(Default)]
pub(super) struct Base {
    pub(super) scales: Equilibration,
    /// `None` before the first factorisation.
    pub(super) matrix: Option<CsMatI<f64, u32>>,
    pub(super) factors: CheckedFactors,
    /// Nodes of the unknowns of the matrix.
    pub(super) nodes: Vec<u32>,
    /// Keys of the unknowns of the matrix with their positions, sorted.
    pub(super) keys: Vec<(DofKey, u32)>,
}

impl Base {
    /// Factorises a matrix; with free pivoting if `must_pivot` or static pivots fail.
    pub(super) fn factorize(&mut self, system: &LinearSystem<'_>, must_pivot: bool) -> Result<(), LinearError> {
        self.nodes = system.layout.nodes();
        if must_pivot {
            self.factors.factorize_with_pivoting(system.matrix, &self.nodes)?;
        } else {
            self.factors.factorize(system.matrix, &self.nodes)?;
        }
        self.scales.clone_from(system.scales);
        self.matrix = Some(system.matrix.clone());
        self.keys.clear();
        self.keys.extend(system.layout.keys().into_iter().zip(0..));
        self.keys.sort_unstable();
        Ok(())
    }

    /// Returns the matrix with its scales, nodes and keys; empty before the first factorisation. Integers are numbers
    /// without a fraction; the 64 bits of the key of a node are two of them.
    pub(super) fn to_lists(&self) -> Vec<Vec<f64>> {
        let Some(matrix) = &self.matrix else { return Vec::new() };
        let integers = |list: &[u32]| list.iter().map(|k| f64::from(*k)).collect();
        let mut keys = vec![[0.0; 4]; self.keys.len()];
        for (key, unknown) in &self.keys {
            keys[*unknown as usize] = key.to_numbers();
        }
        vec![
            vec![f64::from(u8::from(self.factors.is_pivoting()))],
            self.scales.row().to_vec(),
            self.scales.column().to_vec(),
            integers(matrix.indptr().raw_storage()),
            integers(matrix.indices()),
            matrix.data().to_vec(),
            integers(&self.nodes),
            keys.concat(),
        ]
    }

    /// Factorises a matrix that was stored by [`Base::to_lists`], in the same way as then.
    ///
    /// # Errors
    /// [`LinearError::Memory`]: lists of another kind of solver. Errors of the factors.
    pub(super) fn from_lists(lists: &[Vec<f64>]) -> Result<Self, LinearError> {
        let [flags, row, column, column_ptr, rows, values, nodes, keys] = lists else {
            return Err(LinearError::Memory);
        };
        let n = row.len();
        let (keys, rest) = keys.as_chunks::<4>();
        let nodes = integers(nodes)?;
        let fits = n > 0 && column.len() == n && nodes.len() == n && keys.len() == n && rest.is_empty();
        let (column_ptr, rows) = (integers(column_ptr)?, integers(rows)?);
        let is_sound = fits && nodes.iter().all(|k| (*k as usize) < n) && column_ptr.first() == Some(&0);
        let (&[is_pivoting], true) = (&flags[..], is_sound) else { return Err(LinearError::Memory) };
        let matrix = CsMatI::try_new_csc((n, n), column_ptr, rows, values.clone()).map_err(|_| LinearError::Memory)?;
        let mut sorted = Vec::with_capacity(n);
        for (unknown, key) in (0..).zip(keys) {
            sorted.push((DofKey::from_numbers(key).ok_or(LinearError::Memory)?, unknown));
        }
        sorted.sort_unstable();
        let mut base = Self { scales: Equilibration::of_scales(row, column), nodes, keys: sorted, ..Self::default() };
        if is_pivoting == 0.0 {
            base.factors.factorize(&matrix, &base.nodes)?;
        } else {
            base.factors.factorize_with_pivoting(&matrix, &base.nodes)?;
        }
        base.matrix = Some(matrix);
        Ok(base)
    }
}

/// Returns numbers without a fraction as integers.
fn integers(list: &[f64]) -> Result<Vec<u32>, LinearError> {
    let integer = |x: &f64| if f64::from(*x as u32) == *x { Ok(*x as u32) } else { Err(LinearError::Memory) };
    list.iter().map(integer).collect()
}
