//! The linear part of a system at a state.

use rayon::prelude::*;

use crate::Pattern;

/// Number of blocks of columns with separate sums. The round-off of the result depends on this number, which therefore
/// must not depend on the number of threads.
const BLOCKS: usize = 4;

/// `y = r + K x`, summed in blocks of columns so that bits do not depend on the number of threads.
#[derive(Debug, Default)]
pub(crate) struct AffineSum {
    /// One vector per block.
    partial: Vec<f64>,
}

impl AffineSum {
    /// Evaluates `y` and, if `copy` is given, copies the entries of `K` into it.
    pub(crate) fn evaluate(
        &mut self,
        pattern: &Pattern,
        entries: &[f64],
        mut copy: Option<&mut [f64]>,
        r: &[f64],
        x: &[f64],
        y: &mut [f64],
    ) {
        let (n, column_ptr, rows) = (pattern.n_unknowns(), pattern.column_ptr(), pattern.rows());
        if n == 0 {
            return;
        }
        self.partial.resize(BLOCKS * n, 0.0);
        let mut blocks = Vec::with_capacity(BLOCKS);
        let mut begin = 0;
        for (block, partial) in self.partial.chunks_exact_mut(n).enumerate() {
            let share = pattern.n_entries() * (block + 1) / BLOCKS;
            let end =
                if block + 1 == BLOCKS { n } else { column_ptr.partition_point(|&k| (k as usize) < share).min(n) };
            let range = column_ptr[begin] as usize..column_ptr[end] as usize;
            let of_block = copy.take().map(|values| {
                let (of_block, rest) = values.split_at_mut(range.len());
                copy = Some(rest);
                of_block
            });
            blocks.push((begin..end, partial, of_block));
            begin = end;
        }
        let multiply = |(columns, partial, copy): (std::ops::Range<usize>, &mut [f64], Option<&mut [f64]>)| {
            partial.fill(0.0);
            let range = column_ptr[columns.start] as usize..column_ptr[columns.end] as usize;
            if let Some(copy) = copy {
                copy.copy_from_slice(&entries[range]);
            }
            for column in columns {
                let range = column_ptr[column] as usize..column_ptr[column + 1] as usize;
                for (&row, value) in rows[range.clone()].iter().zip(&entries[range]) {
                    partial[row as usize] += value * x[column];
                }
            }
        };
        if rayon::current_num_threads() == 1 {
            blocks.into_iter().for_each(multiply);
        } else {
            blocks.into_par_iter().for_each(multiply);
        }
        y.copy_from_slice(r);
        for partial in self.partial.chunks_exact(n) {
            y.iter_mut().zip(partial).for_each(|(y, p)| *y += p);
        }
    }
}
