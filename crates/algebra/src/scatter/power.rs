//! Powers: residuals tested with the state.

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::contributions::for_each_residual;
use crate::{Contributions, Integral, LocalSystem, Sites};

/// Returns the residual at the state `x` tested with `x`: for velocities a power.
pub fn power(contributions: &(impl Contributions + ?Sized), x: &[f64]) -> f64 {
    let sums = sum_of_items(contributions.len(), 1, |items, sums| {
        for_each_residual(
            contributions,
            items,
            x,
            |_| true,
            |_, dofs, residual| {
                sums[0] += dofs.iter().zip(residual).map(|(dof, value)| x[dof.index()] * value).sum::<f64>();
            },
        );
    });
    sums[0]
}

impl<S: Sites> Integral<'_, S> {
    /// Returns the power of each term.
    pub fn powers(&self, x: &[f64]) -> Vec<f64> {
        sum_of_items(self.sites.len(), self.terms.len(), |items, sums| {
            let (mut dofs, mut of_item, mut local) = (Vec::new(), Vec::new(), LocalSystem::new());
            for item in items {
                dofs.clear();
                self.sites.dofs(item, &mut dofs);
                of_item.clear();
                of_item.extend(dofs.iter().map(|dof| x[dof.index()]));
                self.sites.visit(item, x, |site| {
                    for (term, sum) in self.terms.iter().zip(&mut *sums) {
                        local.reset_residual(of_item.len());
                        term.add(site, &mut local);
                        *sum += of_item.iter().zip(local.residual()).map(|(x, r)| x * r).sum::<f64>();
                    }
                });
            }
        })
    }
}

/// Returns sums over items. `add` adds those of a range of items to its argument. Ranges have a fixed length, so that
/// the sums do not depend on the number of threads.
fn sum_of_items(n_items: usize, n_sums: usize, add: impl Fn(Range<usize>, &mut [f64]) + Sync) -> Vec<f64> {
    const ITEMS: usize = 2048;
    let of_chunk = |chunk: usize| {
        let mut sums = vec![0.0; n_sums];
        add(chunk * ITEMS..n_items.min((chunk + 1) * ITEMS), &mut sums);
        sums
    };
    let chunks: Vec<_> = (0..n_items.div_ceil(ITEMS)).into_par_iter().map(of_chunk).collect();
    let mut total = vec![0.0; n_sums];
    chunks.iter().for_each(|sums| total.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum));
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DofId, Term};

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

    impl Sites for Chain {
        type Site = usize;

        fn len(&self) -> usize {
            self.0
        }

        fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
            Contributions::dofs(self, item, out);
        }

        /// Visits two sites per item.
        fn visit(&self, item: usize, _x: &[f64], mut visit: impl FnMut(&usize)) {
            visit(&item);
            visit(&(2 * item));
        }
    }

    /// A term with the residual `(a, b k)` at site `k`.
    struct Linear(f64, f64);

    impl Term<usize> for Linear {
        fn add(&self, k: &usize, out: &mut LocalSystem) {
            out.add(0, self.0);
            out.add(1, self.1 * *k as f64);
        }
    }

    /// Returns values that make all sums whole numbers, which are exact.
    fn values(n: usize) -> Vec<f64> {
        (0..=n).map(|k| if k % 2 == 0 { 1.0 } else { 2.0 }).collect()
    }

    #[test]
    fn powers_are_sums_over_all_items() {
        const N: usize = 5000;
        let x = values(N);
        let exact: f64 = (0..N).map(|k| k as f64 * x[k] * x[k] + x[k + 1]).sum();
        assert_eq!(power(&Chain(N), &x), exact);
    }

    #[test]
    fn each_term_of_an_integral_has_its_power() {
        const N: usize = 5000;
        let (x, terms) = (values(N), [Linear(1.0, 0.0), Linear(0.0, 4.0), Linear(2.0, 3.0)]);
        let integral = Integral::new("chain", Chain(N), terms.iter().map(|term| term as _).collect());
        let exact = |Linear(a, b): &Linear| (0..N).map(|k| 2.0 * a * x[k] + 3.0 * k as f64 * b * x[k + 1]).sum::<f64>();
        assert_eq!(integral.powers(&x), terms.iter().map(exact).collect::<Vec<_>>());
        assert_eq!(power(&integral, &x), integral.powers(&x).iter().sum::<f64>());
    }

    #[test]
    fn bits_of_powers_do_not_depend_on_the_number_of_threads() {
        const N: usize = 100_000;
        let x: Vec<f64> = (0..=N).map(|k| (k as f64).sin()).collect();
        let of_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| power(&Chain(N), &x)).to_bits()
        };
        for threads in [2, 3, 8] {
            assert_eq!(of_threads(1), of_threads(threads));
        }
    }
}
