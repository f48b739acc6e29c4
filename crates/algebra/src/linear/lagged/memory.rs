//! The base of a solver with old factors as lists of numbers.

use sprs::CsMatI;

use super::{Base, LaggedSolver};
use crate::DofKey;
use crate::linear::{Equilibration, LinearError};

impl LaggedSolver {
    /// Returns the factorised matrix with its scales, nodes and keys; empty if the next matrix will be factorised.
    /// Integers are numbers without a fraction; the 64 bits of the key of a node are two of them.
    pub(super) fn to_lists(&self) -> Vec<Vec<f64>> {
        let base = self.base.as_ref().filter(|_| !self.must_factorize);
        let Some((base, matrix)) = base.and_then(|base| Some((base, base.matrix.as_ref()?))) else {
            return Vec::new();
        };
        let integers = |list: &[u32]| list.iter().map(|k| f64::from(*k)).collect();
        let mut keys = vec![[0.0; 4]; base.keys.len()];
        for (key, unknown) in &base.keys {
            keys[*unknown as usize] = key.to_numbers();
        }
        vec![
            vec![f64::from(u8::from(base.factors.is_pivoting()))],
            base.scales.row().to_vec(),
            base.scales.column().to_vec(),
            integers(matrix.indptr().raw_storage()),
            integers(matrix.indices()),
            matrix.data().to_vec(),
            integers(&base.nodes),
            keys.concat(),
        ]
    }

    /// Factorises the stored matrix in the same way as the solver that stored it.
    ///
    /// # Errors
    /// [`LinearError::Memory`]: lists of another kind of solver. Errors of the factors.
    pub(super) fn take_lists(&mut self, lists: &[Vec<f64>]) -> Result<(), LinearError> {
        (self.base, self.is_factorized, self.must_factorize) = (None, false, false);
        let [flags, row, column, column_ptr, rows, values, nodes, keys] = lists else {
            return if lists.is_empty() { Ok(()) } else { Err(LinearError::Memory) };
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
        let mut base = Base { scales: Equilibration::of_scales(row, column), nodes, keys: sorted, ..Base::default() };
        if is_pivoting == 0.0 {
            base.factors.factorize(&matrix, &base.nodes)?;
        } else {
            base.factors.factorize_with_pivoting(&matrix, &base.nodes)?;
        }
        base.matrix = Some(matrix);
        self.base = Some(base);
        Ok(())
    }
}

/// Returns numbers without a fraction as integers.
fn integers(list: &[f64]) -> Result<Vec<u32>, LinearError> {
    let integer = |x: &f64| if f64::from(*x as u32) == *x { Ok(*x as u32) } else { Err(LinearError::Memory) };
    list.iter().map(integer).collect()
}
