//! Evaluation of items and their addition, in parallel and yet with the same bits for any number of threads.

mod affine;
mod power;
mod regime;
mod stripes;

pub(crate) use affine::AffineSum;
pub use power::power;
pub use regime::{RegimeHash, regime_of};
pub(crate) use stripes::Stripes;

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;

use crate::scatter::stripes::Stripe;
use crate::{Contributions, LocalSystem, Pattern};

/// Items of the largest contribution in one round. A round adds the same fraction of the items of every contribution.
/// Cells, faces and pieces are numbered alike, so that the items of a round write to the same part of the matrix, which
/// stays in the cache.
const ITEMS_PER_ROUND: usize = 4096;

/// A contribution with its place in the pattern.
pub(crate) struct Work<'a> {
    /// Index of the contribution.
    pub(crate) index: usize,
    pub(crate) contribution: &'a dyn Contributions,
    pub(crate) pattern: &'a Pattern,
    /// Indices of the items of the contribution in the pattern.
    pub(crate) items: Range<usize>,
}

/// Recycled memory of each stripe: the local system, and the seconds that each contribution took.
#[derive(Debug, Default)]
pub(crate) struct Scatter {
    of_stripe: Vec<(LocalSystem, Vec<f64>)>,
}

impl Scatter {
    /// Adds all items of the contributions to the values in the stripes, which are set to zero first if `from_zero`.
    /// Calls `report` with the index of each contribution and the time of its slowest stripe, s.
    pub(crate) fn add(
        &mut self,
        works: &[Work<'_>],
        x: &[f64],
        stripes: &Stripes,
        mut dealt: Vec<Stripe<'_>>,
        from_zero: bool,
        mut report: impl FnMut(usize, f64),
    ) {
        self.of_stripe.resize_with(stripes.len(), Default::default);
        let n_rounds = works.iter().map(|work| work.items.len()).max().unwrap_or(0).div_ceil(ITEMS_PER_ROUND);
        let run = |(k, (stripe, (local, seconds))): (usize, (&mut Stripe<'_>, &mut (LocalSystem, Vec<f64>)))| {
            if from_zero {
                stripe.clear();
            }
            let with_tangent = stripe.has_tangent();
            seconds.clear();
            seconds.resize(works.len(), 0.0);
            for round in 0..n_rounds {
                for (work, seconds) in works.iter().zip(seconds.iter_mut()) {
                    let begin = Instant::now();
                    let (first, n_items) = (work.items.start, work.items.len());
                    let items = first + n_items * round / n_rounds..first + n_items * (round + 1) / n_rounds;
                    for item in items.filter(|item| stripes.touches(*item, k)) {
                        let dofs = work.pattern.dofs(item);
                        if with_tangent {
                            local.reset(dofs.len());
                        } else {
                            local.reset_residual(dofs.len());
                        }
                        work.contribution.add(item - first, x, local);
                        stripe.add(dofs, work.pattern.positions(item), local.residual(), local.tangent());
                    }
                    *seconds += begin.elapsed().as_secs_f64();
                }
            }
        };
        if dealt.len() == 1 {
            dealt.iter_mut().zip(&mut self.of_stripe).enumerate().for_each(run);
        } else {
            dealt.par_iter_mut().zip(&mut self.of_stripe).enumerate().for_each(run);
        }
        for (k, work) in works.iter().enumerate() {
            report(work.index, self.of_stripe.iter().map(|(_, seconds)| seconds[k]).fold(0.0, f64::max));
        }
    }
}
