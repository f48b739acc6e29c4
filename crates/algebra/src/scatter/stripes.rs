//! Division of the unknowns into stripes, one for each thread, so that no two threads write the same entry.

use std::ops::Range;

use crate::{BlockLayout, DofId, Pattern};

/// Smallest number of unknowns per thread.
const SMALLEST_STRIPE: usize = 512;

/// Stripes with the same share of every field, one for each thread, and the stripes that each item touches.
///
/// A column belongs to the stripe of its dof, with its entries of residual and matrix. Items that touch several stripes
/// are evaluated in each of them, so that no two threads write to the same place and every entry is summed in the order
/// of the items, however many threads there are. Neighbours in a mesh have neighbouring numbers in every field, so few
/// items touch several stripes.
#[derive(Debug, Default)]
pub(crate) struct Stripes {
    n: usize,
    /// Ranges of dofs with their stripes, in ascending order.
    ranges: Vec<(usize, Range<usize>)>,
    /// First and last stripe that each item touches; empty if there is one stripe.
    of_item: Vec<[u8; 2]>,
}

impl Stripes {
    /// Returns the number of stripes for a number of unknowns and the threads of the current pool.
    pub(crate) fn number(n_unknowns: usize) -> usize {
        rayon::current_num_threads().min(n_unknowns / SMALLEST_STRIPE).clamp(1, u8::MAX as usize)
    }

    /// Divides the unknowns of a pattern, in the memory of an old division.
    pub(crate) fn recycle(mut self, n: usize, layout: &BlockLayout, pattern: &Pattern) -> Self {
        self.n = n;
        self.ranges.clear();
        self.of_item.clear();
        if n == 1 {
            self.ranges.push((0, 0..layout.len()));
            return self;
        }
        let mut of_dof = vec![0_u8; layout.len()];
        for field in layout.fields() {
            let range = layout.range(field);
            // The few unknowns of a body as a whole, which many items touch, stay together.
            let few = range.len() < SMALLEST_STRIPE / 8;
            let bound = |stripe: usize| match stripe {
                0 => range.start,
                _ if few => range.end,
                _ => range.start + range.len() * stripe / n,
            };
            for stripe in 0..n {
                self.ranges.push((stripe, bound(stripe)..bound(stripe + 1)));
                of_dof[bound(stripe)..bound(stripe + 1)].fill(stripe as u8);
            }
        }
        self.of_item.extend((0..pattern.n_items()).map(|item| {
            let stripes = pattern.dofs(item).iter().map(|dof| of_dof[dof.index()]);
            stripes.fold([u8::MAX, 0], |[first, last], stripe| [first.min(stripe), last.max(stripe)])
        }));
        self
    }

    /// Returns the number of stripes.
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// Returns whether an item may touch a stripe.
    #[inline]
    pub(crate) fn touches(&self, item: usize, stripe: usize) -> bool {
        self.of_item.get(item).is_none_or(|&[first, last]| (first as usize..=last as usize).contains(&stripe))
    }

    /// Divides residual and matrix among the stripes.
    pub(crate) fn deal<'a>(
        &self,
        pattern: &Pattern,
        mut residual: &'a mut [f64],
        mut tangent: Option<&'a mut [f64]>,
    ) -> Vec<Stripe<'a>> {
        let column_ptr = pattern.column_ptr();
        let mut stripes: Vec<Stripe<'a>> =
            (0..self.n).map(|_| Stripe { is_whole: self.n == 1, blocks: Vec::new() }).collect();
        for (stripe, range) in &self.ranges {
            let entries = column_ptr[range.start] as usize..column_ptr[range.end] as usize;
            let (of_block, rest) = residual.split_at_mut(range.len());
            residual = rest;
            let columns = tangent.take().map(|values| {
                let (of_block, rest) = values.split_at_mut(entries.len());
                tangent = Some(rest);
                of_block
            });
            let block = StripeBlock { first: range.start, residual: of_block, first_entry: entries.start, columns };
            stripes[*stripe].blocks.push(block);
        }
        stripes
    }
}

/// Columns that one thread writes.
pub(crate) struct Stripe<'a> {
    /// Whether this is the only stripe. Its single block then contains all columns, and no search is needed.
    is_whole: bool,
    blocks: Vec<StripeBlock<'a>>,
}

/// Consecutive columns.
struct StripeBlock<'a> {
    first: usize,
    residual: &'a mut [f64],
    first_entry: usize,
    /// Matrix entries; `None` if only the residual is evaluated.
    columns: Option<&'a mut [f64]>,
}

impl Stripe<'_> {
    /// Sets all entries to zero. Each thread clears its own stripe, since memory traffic is a large part of an
    /// assembly.
    pub(crate) fn clear(&mut self) {
        for block in &mut self.blocks {
            block.residual.fill(0.0);
            block.columns.iter_mut().for_each(|columns| columns.fill(0.0));
        }
    }

    /// Returns whether matrix entries are added, not only the residual.
    pub(crate) fn has_tangent(&self) -> bool {
        self.blocks.iter().any(|block| block.columns.is_some())
    }

    /// Adds those columns of an item that belong to this stripe; `positions` and `tangent` are stored column by column.
    #[inline]
    pub(crate) fn add(&mut self, dofs: &[DofId], positions: &[u32], residual: &[f64], tangent: &[f64]) {
        if let Some(block) = self.blocks.first_mut().filter(|_| self.is_whole) {
            for (dof, value) in dofs.iter().zip(residual) {
                block.residual[dof.index()] += value;
            }
            if let Some(columns) = &mut block.columns {
                for (&position, value) in positions.iter().zip(tangent) {
                    columns[position as usize] += value;
                }
            }
            return;
        }
        let n = dofs.len();
        for (k, (dof, value)) in dofs.iter().zip(residual).enumerate() {
            let dof = dof.index();
            let of = |block: &&mut StripeBlock<'_>| dof.wrapping_sub(block.first) < block.residual.len();
            let Some(block) = self.blocks.iter_mut().find(of) else { continue };
            block.residual[dof - block.first] += value;
            if let Some(columns) = &mut block.columns {
                for (&position, value) in positions[k * n..][..n].iter().zip(&tangent[k * n..][..n]) {
                    columns[position as usize - block.first_entry] += value;
                }
            }
        }
    }
}
