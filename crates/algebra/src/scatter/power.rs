//! Powers: residuals tested with the state.

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::Contributions;
use crate::contributions::for_each_residual;

/// Returns the residual at the state `x` tested with `x`: for velocities a power.
pub fn power(contributions: &(impl Contributions + ?Sized), x: &[f64]) -> f64 {
    powers(contributions, x, |_| 0)[0]
}

/// Returns [`power`] for two classes of items. `class` returns the class of an item.
///
/// # Panics
/// A class is neither 0 nor 1.
pub fn powers(
    contributions: &(impl Contributions + ?Sized),
    x: &[f64],
    class: impl Fn(usize) -> usize + Sync,
) -> [f64; 2] {
    // Sums of this many items, in their order, do not depend on the number of threads.
    const ITEMS: usize = 2048;
    let of_chunk = |chunk: usize| {
        let (mut sums, items) = ([0.0; 2], chunk * ITEMS..contributions.len().min((chunk + 1) * ITEMS));
        for_each_residual(
            contributions,
            items,
            x,
            |_| true,
            |item, dofs, residual| {
                sums[class(item)] += dofs.iter().zip(residual).map(|(dof, value)| x[dof.index()] * value).sum::<f64>();
            },
        );
        sums
    };
    let sums: Vec<_> = (0..contributions.len().div_ceil(ITEMS)).into_par_iter().map(of_chunk).collect();
    sums.into_iter().fold([0.0; 2], |total, sums| std::array::from_fn(|k| total[k] + sums[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DofId, LocalSystem};

    /// Items on the dofs `k` and `k + 1` with the residual `(k x_k, 1)`.
    struct Chain(usize);

    impl Contributions for Chain {
        fn len(&self) -> usize {
            self.0
        }

        fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
            out.extend([DofId::new(item), DofId::new(item + 1)]);
        }

        fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
            out.add(0, item as f64 * x[item]);
            out.add(1, 1.0);
        }

        fn name(&self) -> &'static str {
            "chain"
        }
    }

    #[test]
    fn powers_are_sums_over_all_items_by_class() {
        const N: usize = 5000;
        let x: Vec<f64> = (0..=N).map(|k| if k % 2 == 0 { 1.0 } else { 2.0 }).collect();
        let exact = |class: usize| {
            let of_class = (0..N).filter(|item| item % 2 == class);
            of_class.map(|k| k as f64 * x[k] * x[k] + x[k + 1]).sum::<f64>()
        };
        // All sums are whole numbers, which are exact.
        assert_eq!(powers(&Chain(N), &x, |item| item % 2), [exact(0), exact(1)]);
        assert_eq!(power(&Chain(N), &x), exact(0) + exact(1));
    }

    #[test]
    fn bits_of_powers_do_not_depend_on_the_number_of_threads() {
        const N: usize = 100_000;
        let x: Vec<f64> = (0..=N).map(|k| (k as f64).sin()).collect();
        let of_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| powers(&Chain(N), &x, |item| item % 2)).map(f64::to_bits)
        };
        for threads in [2, 3, 8] {
            assert_eq!(of_threads(1), of_threads(threads));
        }
    }
}
