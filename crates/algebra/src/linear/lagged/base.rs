//! The matrix that was factorised last, also as lists of numbers.

use sprs::CsMatI;

use crate::DofKey;
use crate::linear::checked_factors::CheckedFactors;
use crate::linear::{Equilibration, LinearError, LinearSystem};

/// The matrix that was factorised last.
pub(super) struct Base {
    pub(super) scales: Equilibration,
    pub(super) matrix: CsMatI<f64, u32>,
    pub(super) factors: CheckedFactors,
    /// Nodes of the unknowns of the matrix.
    pub(super) nodes: Vec<u32>,
    /// Keys of the unknowns of the matrix with their positions, sorted.
    pub(super) keys: Vec<(DofKey, u32)>,
}

impl Base {
    /// Factorises a matrix; with free pivoting if `must_pivot` or static pivots fail. `factors` are those of an earlier
    /// matrix, whose memory is used again.
    pub(super) fn new(
        system: &LinearSystem<'_>,
        mut factors: CheckedFactors,
        must_pivot: bool,
    ) -> Result<Self, LinearError> {
        let nodes = system.layout.nodes();
        if must_pivot {
            factors.factorize_with_pivoting(system.matrix, &nodes)?;
        } else {
            factors.factorize(system.matrix, &nodes)?;
        }
        let mut keys: Vec<(DofKey, u32)> = system.layout.keys().into_iter().zip(0..).collect();
        keys.sort_unstable();
        Ok(Self { scales: system.scales.clone(), matrix: system.matrix.clone(), factors, nodes, keys })
    }

    /// Returns the matrix with its scales, nodes and keys. Integers are numbers without a fraction; the 64 bits of the
    /// key of a node are two of them.
    pub(super) fn to_lists(&self) -> Vec<Vec<f64>> {
        let integers = |list: &[u32]| list.iter().map(|k| f64::from(*k)).collect();
        let mut keys = vec![[0.0; 4]; self.keys.len()];
        for (key, unknown) in &self.keys {
            keys[*unknown as usize] = key.to_numbers();
        }
        vec![
            vec![f64::from(u8::from(self.factors.is_pivoting()))],
            self.scales.row().to_vec(),
            self.scales.column().to_vec(),
            integers(self.matrix.indptr().raw_storage()),
            integers(self.matrix.indices()),
            self.matrix.data().to_vec(),
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
        let mut factors = CheckedFactors::default();
        if is_pivoting == 0.0 {
            factors.factorize(&matrix, &nodes)?;
        } else {
            factors.factorize_with_pivoting(&matrix, &nodes)?;
        }
        Ok(Self { scales: Equilibration::of_scales(row, column), matrix, factors, nodes, keys: sorted })
    }
}

/// Returns numbers without a fraction as integers.
fn integers(list: &[f64]) -> Result<Vec<u32>, LinearError> {
    let integer = |x: &f64| if f64::from(*x as u32) == *x { Ok(*x as u32) } else { Err(LinearError::Memory) };
    list.iter().map(integer).collect()
}
