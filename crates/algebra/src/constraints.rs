//! Unknowns with a prescribed value, and unknowns tied to others.

use std::collections::{BTreeMap, BTreeSet};

use crate::DofId;

/// Prescribed values of dofs, and dofs tied to others.
///
/// A constrained dof keeps its row and column in the system: the row becomes the identity with a zero residual and
/// the column is dropped, because a state that satisfies the constraints from the start has zero corrections there.
///
/// A tied dof is a linear combination of other dofs, its masters. Its residual and tangent entries are distributed to the
/// masters with the same factors ([`crate::Tied`]), so that the system is that of the free dofs alone. The corrections of
/// tied dofs follow from those of their masters.
///
/// ```
/// use algebra::{Constraints, DofId};
///
/// let mut constraints = Constraints::new();
/// let [a, b, c] = [0, 1, 2].map(DofId::new);
/// constraints.set(c, 1.0);
/// constraints.set(c, 5.0); // the last assignment wins
/// let mut x = [0.0; 3];
/// constraints.apply(&mut x);
/// assert_eq!(x, [0.0, 0.0, 5.0]);
///
/// constraints.tie(b, &[(a, 1.0), (c, 2.0)]);
/// constraints.apply(&mut x);
/// assert_eq!(x, [0.0, 10.0, 5.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    values: BTreeMap<DofId, f64>,
    ties: BTreeMap<DofId, Vec<(DofId, f64)>>,
    /// Masters of tied dofs, including those of former ties.
    masters: BTreeSet<DofId>,
}

impl Constraints {
    /// Creates a set without constraints.
    pub fn new() -> Self {
        Self::default()
    }

    /// Prescribes the value of a dof; a later assignment of the same dof replaces an earlier one.
    pub fn set(&mut self, dof: DofId, value: f64) {
        self.ties.remove(&dof);
        self.values.insert(dof, value);
    }

    /// Ties a dof to its masters: it is the sum of their values times the factors. Masters may have a prescribed value,
    /// but must not be tied themselves. A later assignment of the same dof replaces an earlier one.
    ///
    /// # Panics
    /// One of the masters is itself tied, or this dof is a master of other dofs.
    pub fn tie(&mut self, dof: DofId, to: &[(DofId, f64)]) {
        assert!(!self.masters.contains(&dof), "dof {} is a master of other dofs", dof.index());
        assert!(to.iter().all(|(other, _)| *other != dof && !self.ties.contains_key(other)), "a chain of ties");
        self.values.remove(&dof);
        self.masters.extend(to.iter().map(|(other, _)| *other));
        self.ties.insert(dof, to.to_vec());
    }

    /// Returns the masters of a dof and their factors, if it is tied.
    pub fn tie_of(&self, dof: DofId) -> Option<&[(DofId, f64)]> {
        self.ties.get(&dof).map(Vec::as_slice)
    }

    /// Returns all tied dofs with their masters and factors, in the order of the dofs.
    pub fn ties(&self) -> impl DoubleEndedIterator<Item = (DofId, &[(DofId, f64)])> + '_ {
        self.ties.iter().map(|(&dof, to)| (dof, to.as_slice()))
    }

    /// Computes the tied entries of `x`, a state or a correction, from their masters.
    ///
    /// # Panics
    /// A dof lies outside of `x`.
    pub fn apply_ties(&self, x: &mut [f64]) {
        for (dof, to) in self.ties() {
            x[dof.index()] = to.iter().map(|(other, factor)| factor * x[other.index()]).sum();
        }
    }

    /// Returns the prescribed value of a dof, if it has one.
    pub fn get(&self, dof: DofId) -> Option<f64> {
        self.values.get(&dof).copied()
    }

    /// Returns the number of dofs that are prescribed or tied.
    pub fn len(&self) -> usize {
        self.values.len() + self.ties.len()
    }

    /// Returns whether no dof is constrained.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns all prescribed dofs with their values, in the order of the dofs.
    pub fn iter(&self) -> impl Iterator<Item = (DofId, f64)> + '_ {
        self.values.iter().map(|(&dof, &value)| (dof, value))
    }

    /// Writes the prescribed values into `x`, then the values of tied dofs.
    ///
    /// # Panics
    /// A constrained dof lies outside of `x`.
    pub fn apply(&self, x: &mut [f64]) {
        for (dof, value) in self.iter() {
            assert!(dof.index() < x.len(), "constrained dof {} of {} unknowns", dof.index(), x.len());
            x[dof.index()] = value;
        }
        self.apply_ties(x);
    }
}

impl FromIterator<(DofId, f64)> for Constraints {
    fn from_iter<T: IntoIterator<Item = (DofId, f64)>>(iter: T) -> Self {
        Self { values: iter.into_iter().collect(), ..Self::default() }
    }
}
