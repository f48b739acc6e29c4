//! Unknowns with a prescribed value, and unknowns tied to others.

use std::collections::{BTreeMap, BTreeSet};

use crate::DofId;

/// Factors of an equation that are at most this fraction of its largest factor are round-off, and are dropped.
const ROUND_OFF: f64 = 1e-7;

/// Prescribed values of dofs, and dofs tied to others.
///
/// A constrained dof keeps its row and column in the system: the row becomes the identity with a zero residual and
/// the column is dropped, because its correction is zero if the state satisfies the constraints from the start.
///
/// A tied dof is a linear combination of other dofs, its masters. Its residual and tangent entries are distributed to
/// the masters with the same factors ([`crate::Tied`]), so that the unknowns of the system are the free dofs. The
/// corrections of tied dofs follow from the corrections of their masters.
///
/// ```
/// use algebra::{Constraints, DofId};
///
/// let mut constraints = Constraints::new();
/// let [a, b, c] = [0, 1, 2].map(DofId::new);
/// constraints.set(c, 1.0);
/// constraints.set(c, 5.0); // the last value is used
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
    /// Values of tied dofs where their masters are zero. Values that are missing are zero.
    offsets: BTreeMap<DofId, f64>,
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
        self.offsets.remove(&dof);
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
        self.offsets.remove(&dof);
        self.masters.extend(to.iter().map(|(other, _)| *other));
        self.ties.insert(dof, to.to_vec());
    }

    /// Imposes the equation `Σ factor · x = value`. The free dof with the largest factor is tied to the others, or
    /// prescribed if there is no other.
    ///
    /// Prescribed dofs keep their values, and former equations stay in force. An equation that is linearly dependent on
    /// them is left out, even if it contradicts them.
    ///
    /// ```
    /// use algebra::{Constraints, DofId};
    ///
    /// let mut constraints = Constraints::new();
    /// let [a, b] = [0, 1].map(DofId::new);
    /// constraints.impose(&[(a, 1.0), (b, -2.0)], 3.0);
    /// let mut x = [4.0, 0.0];
    /// constraints.apply(&mut x);
    /// assert_eq!(x, [4.0, 0.5]);
    /// ```
    pub fn impose(&mut self, equation: &[(DofId, f64)], mut value: f64) {
        let largest = equation.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max);
        let mut free: BTreeMap<DofId, f64> = BTreeMap::new();
        for &(dof, factor) in equation {
            value -= factor * self.offsets.get(&dof).unwrap_or(&0.0);
            for &(other, f) in self.tie_of(dof).unwrap_or(&[(dof, 1.0)]) {
                match self.get(other) {
                    Some(x) => value -= factor * f * x,
                    None => *free.entry(other).or_default() += factor * f,
                }
            }
        }
        free.retain(|_, factor| factor.abs() > ROUND_OFF * largest);
        let Some((&dof, &factor)) = free.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { return };
        free.remove(&dof);
        let (to, offset): (Vec<_>, f64) =
            (free.iter().map(|(other, f)| (*other, -f / factor)).collect(), value / factor);
        if to.is_empty() {
            self.set(dof, offset);
            return;
        }
        if self.masters.remove(&dof) {
            self.replace_master(dof, &to, offset);
        }
        self.tie(dof, &to);
        if offset != 0.0 {
            self.offsets.insert(dof, offset);
        }
    }

    /// Replaces a tied master by its own masters in other ties.
    fn replace_master(&mut self, dof: DofId, to: &[(DofId, f64)], offset: f64) {
        for (tied, masters) in &mut self.ties {
            let Some(at) = masters.iter().position(|(other, _)| *other == dof) else { continue };
            let (_, factor) = masters.remove(at);
            for (other, f) in to {
                match masters.iter_mut().find(|(master, _)| master == other) {
                    Some((_, of_master)) => *of_master += factor * f,
                    None => masters.push((*other, factor * f)),
                }
            }
            if offset != 0.0 {
                *self.offsets.entry(*tied).or_default() += factor * offset;
            }
        }
    }

    /// Returns the non-zero constants of the ties, in the order of the dofs.
    pub fn offsets(&self) -> impl Iterator<Item = (DofId, f64)> + '_ {
        self.offsets.iter().map(|(&dof, &offset)| (dof, offset))
    }

    /// Returns the masters of a dof and their factors, if it is tied.
    pub fn tie_of(&self, dof: DofId) -> Option<&[(DofId, f64)]> {
        self.ties.get(&dof).map(Vec::as_slice)
    }

    /// Returns all tied dofs with their masters and factors, in the order of the dofs.
    pub fn ties(&self) -> impl DoubleEndedIterator<Item = (DofId, &[(DofId, f64)])> + '_ {
        self.ties.iter().map(|(&dof, to)| (dof, to.as_slice()))
    }

    /// Computes the tied entries of a correction `x` from their masters.
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
        self.offsets().for_each(|(dof, offset)| x[dof.index()] += offset);
    }
}

impl FromIterator<(DofId, f64)> for Constraints {
    fn from_iter<T: IntoIterator<Item = (DofId, f64)>>(iter: T) -> Self {
        Self { values: iter.into_iter().collect(), ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_of_planes_are_combined() {
        let dofs = [0, 1, 2].map(DofId::new);
        let imposed = |equations: &[([f64; 3], f64)], constraints: &mut Constraints| {
            for (factors, value) in equations {
                let equation: Vec<_> = dofs.into_iter().zip(*factors).collect();
                constraints.impose(&equation, *value);
            }
        };
        let residual = |(factors, value): &([f64; 3], f64), x: &[f64; 3]| {
            (factors.iter().zip(x).map(|(f, x)| f * x).sum::<f64>() - value).abs()
        };
        let planes = [([0.6, 0.8, 0.0], 0.5), ([0.1, 0.3, 0.9], -0.2), ([0.7, 0.1, -0.4], 0.9)];
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let planes = order.map(|k| planes[k]);
            for n in 1..=3 {
                let mut constraints = Constraints::new();
                imposed(&planes[..n], &mut constraints);
                // The same planes again, with other factors, determine nothing.
                imposed(
                    &planes[..n].iter().map(|(f, v)| (f.map(|f| -3.0 * f), -3.0 * v)).collect::<Vec<_>>(),
                    &mut constraints,
                );
                assert_eq!(constraints.len(), n);
                let mut x = [0.3, -0.7, 1.1];
                constraints.apply(&mut x);
                assert!(planes[..n].iter().all(|plane| residual(plane, &x) < 1e-14), "{x:?}");
                // Corrections satisfy the equations without their values.
                let mut dx = [0.3, -0.7, 1.1];
                constraints.iter().for_each(|(dof, _)| dx[dof.index()] = 0.0);
                constraints.apply_ties(&mut dx);
                assert!(planes[..n].iter().all(|(f, _)| n == 3 || residual(&(*f, 0.0), &dx) < 1e-14), "{dx:?}");
            }
        }
    }

    #[test]
    fn prescribed_values_come_before_equations() {
        let [a, b] = [0, 1].map(DofId::new);
        let mut constraints = Constraints::new();
        constraints.set(a, 2.0);
        constraints.impose(&[(a, 0.8), (b, 0.6)], 1.0);
        assert!(constraints.get(b).is_some_and(|b| (b + 1.0).abs() < 1e-15));
        constraints.impose(&[(a, 1.0)], 7.0);
        assert_eq!(constraints.get(a), Some(2.0));
    }
}
