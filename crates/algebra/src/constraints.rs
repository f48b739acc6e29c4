//! Unknowns with a prescribed value.

use std::collections::BTreeMap;

use crate::DofId;

/// Prescribed values of dofs.
///
/// A constrained dof keeps its row and column in the system: the row becomes the identity with a zero residual and
/// the column is dropped, because a state that satisfies the constraints from the start has zero corrections there.
///
/// ```
/// use algebra::{Constraints, DofId};
///
/// let mut constraints = Constraints::new();
/// constraints.set(DofId(2), 1.0);
/// constraints.set(DofId(2), 5.0); // the last assignment wins
/// let mut x = [0.0; 3];
/// constraints.apply(&mut x);
/// assert_eq!(x, [0.0, 0.0, 5.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    values: BTreeMap<DofId, f64>,
}

impl Constraints {
    /// No constraint.
    pub fn new() -> Self {
        Self::default()
    }

    /// Prescribes the value of a dof; a later assignment of the same dof replaces an earlier one.
    pub fn set(&mut self, dof: DofId, value: f64) {
        self.values.insert(dof, value);
    }

    /// The prescribed value of a dof, if it is constrained.
    pub fn get(&self, dof: DofId) -> Option<f64> {
        self.values.get(&dof).copied()
    }

    /// Number of constrained dofs.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether no dof is constrained.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All constrained dofs with their values, in the order of the dofs.
    pub fn iter(&self) -> impl Iterator<Item = (DofId, f64)> + '_ {
        self.values.iter().map(|(&dof, &value)| (dof, value))
    }

    /// Writes the prescribed values into `x`.
    ///
    /// # Panics
    /// A constrained dof lies outside of `x`.
    pub fn apply(&self, x: &mut [f64]) {
        for (dof, value) in self.iter() {
            assert!(dof.index() < x.len(), "constrained dof {} of {} unknowns", dof.index(), x.len());
            x[dof.index()] = value;
        }
    }
}

impl FromIterator<(DofId, f64)> for Constraints {
    fn from_iter<T: IntoIterator<Item = (DofId, f64)>>(iter: T) -> Self {
        Self { values: iter.into_iter().collect() }
    }
}
