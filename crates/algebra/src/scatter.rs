//! Evaluation of items in parallel and their addition in order, so that bits do not depend on the thread count.

use rayon::prelude::*;

use crate::pattern::ItemMap;
use crate::{Contributions, LocalSystem};

/// Items that one thread evaluates at a time.
const ITEMS_PER_CHUNK: usize = 64;
/// Chunks per thread that are evaluated before they are added.
const CHUNKS_PER_THREAD: usize = 4;

/// Where the local systems are added.
pub(crate) struct Target<'a> {
    /// Global residual.
    pub(crate) residual: &'a mut [f64],
    /// Values of the matrix, unless only the residual is wanted.
    pub(crate) tangent: Option<&'a mut [f64]>,
}

impl Target<'_> {
    fn add(&mut self, local: &LocalSystem, map: &ItemMap<'_>, item: usize) {
        for (&dof, value) in map.dofs(item).iter().zip(local.residual()) {
            self.residual[dof as usize] += value;
        }
        if let Some(tangent) = &mut self.tangent {
            for (&position, value) in map.positions(item).iter().zip(local.tangent()) {
                tangent[position as usize] += value;
            }
        }
    }
}

/// Recycled local systems.
#[derive(Debug, Default)]
pub(crate) struct Scatter {
    evaluated: Vec<LocalSystem>,
    next: Vec<LocalSystem>,
}

impl Scatter {
    /// Adds all items of a contribution to the target.
    ///
    /// The items are added in their order, whatever the number of threads: with several threads a wave of items is
    /// evaluated in parallel while the wave before it is added.
    pub(crate) fn add(
        &mut self,
        contribution: &dyn Contributions,
        map: &ItemMap<'_>,
        x: &[f64],
        mut target: Target<'_>,
    ) {
        let n_items = map.len();
        let wants_tangent = target.tangent.is_some();
        let evaluate = |item: usize, local: &mut LocalSystem| {
            local.reset(map.dofs(item).len());
            local.set_wants_tangent(wants_tangent);
            contribution.add(item, x, local);
        };
        let n_threads = rayon::current_num_threads();
        if n_threads == 1 || n_items <= 2 * ITEMS_PER_CHUNK {
            self.evaluated.resize_with(self.evaluated.len().max(1), LocalSystem::new);
            for item in 0..n_items {
                evaluate(item, &mut self.evaluated[0]);
                target.add(&self.evaluated[0], map, item);
            }
            return;
        }
        let wave = ITEMS_PER_CHUNK * CHUNKS_PER_THREAD * n_threads;
        self.evaluated.resize_with(self.evaluated.len().max(wave), LocalSystem::new);
        self.next.resize_with(self.next.len().max(wave), LocalSystem::new);
        let evaluate_wave = |first: usize, locals: &mut [LocalSystem]| {
            let n = wave.min(n_items.saturating_sub(first));
            locals[..n].par_chunks_mut(ITEMS_PER_CHUNK).enumerate().for_each(|(chunk, locals)| {
                for (k, local) in locals.iter_mut().enumerate() {
                    evaluate(first + chunk * ITEMS_PER_CHUNK + k, local);
                }
            });
        };
        evaluate_wave(0, &mut self.evaluated);
        for first in (0..n_items).step_by(wave) {
            let Self { evaluated, next } = self;
            let add_wave = || {
                for (item, local) in (first..n_items.min(first + wave)).zip(evaluated.iter()) {
                    target.add(local, map, item);
                }
            };
            rayon::join(add_wave, || evaluate_wave(first + wave, next));
            std::mem::swap(&mut self.evaluated, &mut self.next);
        }
    }
}
