//! Hash of a non-smooth state.

use rayon::prelude::*;

use crate::Contributions;

/// Smallest number of items that another thread takes.
const ITEMS: usize = 4;

/// Hash of the non-smooth state of an item, such as the set of its points in contact: the value of
/// [`Contributions::regime`].
///
/// The state is a sequence of numbers, which `extend` appends. Equal sequences have equal hashes. The algorithm is
/// FNV-1a of Fowler, Noll and Vo, with numbers of 64 bits instead of bytes. Its value is mixed by the last step of
/// SplitMix64 (Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195), so that hashes of items can be added: without it,
/// changes of two items may cancel.
#[derive(Clone, Copy, Debug)]
pub struct RegimeHash(u64);

impl RegimeHash {
    /// Returns the hash of the numbers so far.
    pub fn value(self) -> u64 {
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
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
    use crate::{DofId, LocalSystem};

    #[test]
    fn order_and_values_matter() {
        let hash = |numbers: &[u64]| {
            let mut hash = RegimeHash::default();
            hash.extend(numbers.iter().copied());
            hash.value()
        };
        // The published test vector of "a", whose only byte is 0x61.
        let mut of_a = RegimeHash::default();
        of_a.extend([0x61]);
        assert_eq!(of_a.0, 0xaf63_dc4c_8601_ec8c);
        assert_ne!(hash(&[1, 2]), hash(&[2, 1]));
        assert_ne!(hash(&[0]), hash(&[]));
    }

    /// Items on one dof each, whose regimes are the signs of their dofs.
    struct Signs(usize);

    impl Contributions for Signs {
        fn len(&self) -> usize {
            self.0
        }

        fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
            out.push(DofId::new(item));
        }

        fn add(&self, _item: usize, _x: &[f64], _out: &mut LocalSystem) {}

        fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
            let mut hash = RegimeHash::default();
            hash.extend([item as u64, u64::from(x[item] > 0.0)]);
            Some(hash.value())
        }

        fn name(&self) -> &'static str {
            "signs"
        }
    }

    #[test]
    fn changes_of_items_do_not_cancel_on_any_number_of_threads() {
        let n = 64;
        let with_one = |k: usize| (0..n).map(|i| if i == k { 1.0 } else { -1.0 }).collect::<Vec<_>>();
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| (0..n).map(|k| regime_of(&Signs(n), &with_one(k))).collect::<Vec<_>>())
        };
        let regimes = of(1);
        assert!((0..n).all(|k| !regimes[..k].contains(&regimes[k])), "{regimes:?}");
        assert_eq!(regimes, of(3));
        assert_eq!(regime_of(&Signs(0), &[]), 0);
    }
}
