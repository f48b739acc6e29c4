//! Hash of a non-smooth state.

use rayon::prelude::*;

use crate::Contributions;

/// Smallest number of items that another thread takes.
const ITEMS: usize = 32;

/// Hash of a non-smooth state, such as the set of points in contact: the value of [`Contributions::regime`].
///
/// The state is a sequence of numbers, which `extend` appends. Equal sequences have equal hashes. The algorithm is
/// FNV-1a of Fowler, Noll and Vo, with numbers of 64 bits instead of bytes.
#[derive(Clone, Copy, Debug)]
pub struct RegimeHash(u64);

impl RegimeHash {
    /// Returns the hash of the numbers so far.
    pub fn value(self) -> u64 {
        self.0
    }
}

impl Default for RegimeHash {
    /// Returns the hash of the empty sequence.
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Extend<u64> for RegimeHash {
    fn extend<I: IntoIterator<Item = u64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|number| self.0 = (self.0 ^ number).wrapping_mul(0x0100_0000_01b3));
    }
}

/// Returns the sum of the hashes of all items, which does not depend on their order; zero without a non-smooth state.
/// See [`Contributions::regime`].
pub fn regime_of(contributions: &(impl Contributions + ?Sized), x: &[f64]) -> u64 {
    if contributions.is_empty() || contributions.regime(0, x).is_none() {
        return 0;
    }
    let of_item = |item| contributions.regime(item, x).unwrap_or(0);
    (0..contributions.len()).into_par_iter().with_min_len(ITEMS).map(of_item).reduce(|| 0, u64::wrapping_add)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_values_matter() {
        let hash = |numbers: &[u64]| {
            let mut hash = RegimeHash::default();
            hash.extend(numbers.iter().copied());
            hash.value()
        };
        // The published test vector of "a", whose only byte is 0x61.
        assert_eq!(hash(&[0x61]), 0xaf63_dc4c_8601_ec8c);
        assert_ne!(hash(&[1, 2]), hash(&[2, 1]));
        assert_ne!(hash(&[0]), hash(&[]));
    }
}
