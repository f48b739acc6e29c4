//! LU factors on the pattern of `A + Aᵀ`, with pivots inside supernodes only.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::traits::RealField;
use faer::traits::math_utils::{eps, from_f64, one, zero};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};
use sprs::CsMatI;

use super::LinearError;
use super::fronts::Fronts;

/// Smallest accepted pivot, divided by the unit round-off and by the largest entry of its column.
const SMALL_PIVOT: f64 = 10.0;

/// Multifrontal LU factors in single or double precision.
///
/// Rows are exchanged inside a front's pivots only, so that the pattern is known beforehand. Matrices whose zero
/// diagonal entries have couplings inside their nodes (velocities and pressure of a vertex) or inside their supernodes
/// can be factorised. A pivot that is too small is an error: the matrix needs factors with free pivoting.
///
/// The fronts are kept while the pattern stays. The elimination runs in one thread.
#[derive(Default)]
pub(super) struct StaticFactors<T> {
    fronts: Option<Fronts>,
    /// Rows of L below the pivot blocks, front by front, each by columns.
    lower: Vec<T>,
    /// Factors of the pivot blocks, front by front, each by columns.
    blocks: Vec<T>,
    /// Transposed columns of U to the right of the pivot blocks, from the last front to the first, each by columns. A
    /// triangular solve reads all factors in the order in which they are stored.
    upper: Vec<T>,
    /// Rows of the pivot blocks in the order of elimination, counted from the first of their front.
    exchanges: Vec<u32>,
    work: Vec<T>,
    part: Vec<T>,
    pub(super) n_symbolic: usize,
}

impl<T: RealField + Copy + Into<f64>> StaticFactors<T> {
    /// Computes the factors of an equilibrated matrix. A pattern is analysed again only if it differs from that of the
    /// previous matrix.
    ///
    /// # Errors
    /// [`LinearError::Singular`]: a pivot is too small. [`LinearError::OutOfMemory`].
    pub(super) fn factorize(&mut self, matrix: &CsMatI<f64, u32>, nodes: &[u32]) -> Result<(), LinearError> {
        let n_unknowns = matrix.rows();
        let out_of_memory = || LinearError::OutOfMemory { n_unknowns };
        let column_ptr = matrix.indptr();
        let (column_ptr, rows) = (column_ptr.raw_storage(), matrix.indices());
        let fronts = match self.fronts.take().filter(|fronts| fronts.belong_to(column_ptr, rows, nodes)) {
            Some(fronts) => fronts,
            None => {
                self.n_symbolic += 1;
                Fronts::new(column_ptr, rows, nodes).map_err(|_| out_of_memory())?
            }
        };
        for (values, n) in [
            (&mut self.lower, fronts.n_lower()),
            (&mut self.blocks, fronts.n_blocks()),
            (&mut self.upper, fronts.n_lower()),
        ] {
            values.clear();
            values.try_reserve_exact(n).map_err(|_| out_of_memory())?;
            values.resize(n, zero());
        }
        self.exchanges.clear();
        self.exchanges.resize(n_unknowns, 0);
        let mut elimination = Elimination::new(&fronts, matrix).ok_or_else(out_of_memory)?;
        for s in 0..fronts.len() {
            let mut front = Front {
                lower: &mut self.lower[fronts.lower(s)],
                block: &mut self.blocks[fronts.block(s)],
                upper: &mut self.upper[fronts.upper(s)],
            };
            elimination.assemble(s, &mut front);
            elimination.eliminate(s, &mut front, &mut self.exchanges[fronts.pivots(s)])?;
        }
        drop(elimination);
        self.fronts = Some(fronts);
        Ok(())
    }

    /// Solves with the factors, in place.
    ///
    /// # Errors
    /// [`LinearError::NotFactorized`].
    pub(super) fn substitute(&mut self, x: &mut [f64]) -> Result<(), LinearError> {
        self.substitute_by(x, |substitution| Arch::new().dispatch(substitution))
    }

    /// Solves with the factors, in place, with the instructions that `run` chooses.
    fn substitute_by(&mut self, x: &mut [f64], run: impl FnOnce(Substitution<'_, T>)) -> Result<(), LinearError> {
        let Self { fronts: Some(fronts), lower, blocks, upper, exchanges, work, part, .. } = self else {
            return Err(LinearError::NotFactorized);
        };
        work.clear();
        work.extend(fronts.order.iter().map(|unknown| from_f64::<T>(x[*unknown as usize])));
        run(Substitution { fronts, lower, blocks, upper, exchanges, work, part });
        fronts.order.iter().zip(&*work).for_each(|(unknown, value)| x[*unknown as usize] = (*value).into());
        Ok(())
    }
}

/// Both triangular solves with the factors, in place.
struct Substitution<'a, T> {
    fronts: &'a Fronts,
    lower: &'a [T],
    blocks: &'a [T],
    upper: &'a [T],
    exchanges: &'a [u32],
    /// Right-hand side and solution, in the order of elimination.
    work: &'a mut [T],
    part: &'a mut Vec<T>,
}

impl<T: RealField + Copy> NullaryFnOnce for Substitution<'_, T> {
    type Output = ();

    /// Solves, compiled for the instruction set of the caller. The bits do not depend on the instruction set: products
    /// and sums are not fused, and the order of the sums is fixed.
    #[inline(always)]
    fn call(self) {
        let Self { fronts, lower, blocks, upper, exchanges, work, part } = self;
        for s in 0..fronts.len() {
            let (pivots, below) = (fronts.pivots(s), fronts.below(s));
            let block = &blocks[fronts.block(s)];
            part.clear();
            part.extend(exchanges[pivots.clone()].iter().map(|k| work[pivots.start + *k as usize]));
            let known = &mut work[pivots];
            known.copy_from_slice(part);
            for k in 0..known.len() {
                let column = &block[known.len() * k..known.len() * (k + 1)];
                let value = known[k];
                known[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= *l * value);
            }
            part.clear();
            part.resize(below.len(), zero());
            add_product(&lower[fronts.lower(s)], known, part);
            below.iter().zip(&*part).for_each(|(p, value)| work[*p as usize] -= *value);
        }
        for s in (0..fronts.len()).rev() {
            let (pivots, below) = (fronts.pivots(s), fronts.below(s));
            let block = &blocks[fronts.block(s)];
            part.clear();
            part.extend(below.iter().map(|p| work[*p as usize]));
            let known = &mut work[pivots];
            subtract_transposed_product(&upper[fronts.upper(s)], part, known);
            for k in (0..known.len()).rev() {
                let column = &block[known.len() * k..known.len() * (k + 1)];
                let value = known[k] / column[k];
                known[k] = value;
                known[..k].iter_mut().zip(column).for_each(|(x, u)| *x -= *u * value);
            }
        }
    }
}

/// The factors of one front, each by columns.
struct Front<'a, T> {
    /// Rows of L below the pivot block.
    lower: &'a mut [T],
    /// Factors of the pivot block.
    block: &'a mut [T],
    /// Transposed columns of U to its right.
    upper: &'a mut [T],
}

/// The state of a multifrontal elimination.
struct Elimination<'m, T> {
    fronts: &'m Fronts,
    matrix: &'m CsMatI<f64, u32>,
    /// The matrix compressed by rows.
    by_rows: CsMatI<f64, u32>,
    /// Schur complements not yet added to their parents: a stack, each by columns.
    updates: Vec<T>,
    /// Fronts of the updates.
    pending: Vec<usize>,
    /// Position to place among the rows below the present front.
    place: Vec<usize>,
    /// Places of a child's rows in the present front.
    local: Vec<usize>,
    /// Largest entries of the columns of a pivot block.
    sizes: Vec<f64>,
    spare: Vec<T>,
    positions: Vec<u32>,
    memory: MemBuffer,
}

impl<'m, T: RealField + Copy + Into<f64>> Elimination<'m, T> {
    /// Creates the state before the first front; `None` without memory for the updates.
    fn new(fronts: &'m Fronts, matrix: &'m CsMatI<f64, u32>) -> Option<Self> {
        let mut updates = Vec::new();
        updates.try_reserve_exact(fronts.most_updates).ok()?;
        let widest = (0..fronts.len()).map(|s| fronts.pivots(s).len()).max().unwrap_or(0);
        let need = lu_in_place_scratch::<u32, T>(widest, widest, Par::Seq, Default::default());
        Some(Self {
            fronts,
            matrix,
            by_rows: matrix.to_csr(),
            updates,
            pending: Vec::new(),
            place: vec![0; matrix.rows()],
            local: Vec::new(),
            sizes: Vec::new(),
            spare: Vec::new(),
            positions: vec![0; widest],
            memory: MemBuffer::try_new(need).ok()?,
        })
    }

    /// Adds the entries of the matrix and the updates of the children to a front, whose own update goes to the end of
    /// the stack.
    fn assemble(&mut self, s: usize, front: &mut Front<'_, T>) {
        let (fronts, pivots, below) = (self.fronts, self.fronts.pivots(s), self.fronts.below(s));
        let (w, r) = (pivots.len(), below.len());
        for (k, position) in below.iter().enumerate() {
            self.place[*position as usize] = k;
        }
        let Front { lower, block, upper } = front;
        for (k, q) in pivots.clone().enumerate() {
            let unknown = fronts.order[q] as usize;
            for (i, value) in self.matrix.outer_view(unknown).iter().flat_map(|column| column.iter()) {
                let p = fronts.position[i] as usize;
                if p >= pivots.end {
                    lower[self.place[p] + r * k] = from_f64(*value);
                } else if p >= pivots.start {
                    block[p - pivots.start + w * k] = from_f64(*value);
                }
            }
            for (j, value) in self.by_rows.outer_view(unknown).iter().flat_map(|row| row.iter()) {
                let p = fronts.position[j] as usize;
                if p >= pivots.end {
                    upper[self.place[p] + r * k] = from_f64(*value);
                }
            }
        }
        let end = self.updates.len();
        self.updates.resize(end + r * r, zero());
        let (old, own) = self.updates.split_at_mut(end);
        let mut end = end;
        while let Some(child) = self.pending.pop_if(|child| fronts.parent[*child] == s) {
            let rows = fronts.below(child);
            let n = rows.len();
            self.local.clear();
            self.local.extend(rows.iter().map(|p| match *p as usize {
                p if p < pivots.end => p - pivots.start,
                p => w + self.place[p],
            }));
            for (update, &j) in old[end - n * n..end].chunks_exact(n).zip(&self.local) {
                for (value, &i) in update.iter().zip(&self.local) {
                    match (i < w, j < w) {
                        (true, true) => block[i + w * j] += *value,
                        (false, true) => lower[i - w + r * j] += *value,
                        (true, false) => upper[j - w + r * i] += *value,
                        (false, false) => own[i - w + r * (j - w)] += *value,
                    }
                }
            }
            end -= n * n;
        }
        // The update of the front overwrites the updates of its children.
        let begin = old.len();
        self.updates.copy_within(begin.., end);
        self.updates.truncate(end + r * r);
        if r > 0 {
            self.pending.push(s);
        }
    }

    /// Factorises the pivot block of a front, solves for its other rows and columns, and finishes its update.
    fn eliminate(&mut self, s: usize, front: &mut Front<'_, T>, exchanges: &mut [u32]) -> Result<(), LinearError> {
        let (w, r) = (self.fronts.pivots(s).len(), self.fronts.below(s).len());
        let Front { lower, block, upper } = front;
        let largest = |entries: &[T]| entries.iter().fold(0.0, |max: f64, v| max.max((*v).into().abs()));
        let column = |x: &[T], n, k: usize| largest(&x[n * k..n * (k + 1)]);
        self.sizes.clear();
        self.sizes.extend((0..w).map(|k| column(block, w, k).max(column(lower, r, k))));
        let mut block = MatMut::from_column_major_slice_mut(block, w, w);
        let mut lower = MatMut::from_column_major_slice_mut(lower, r, w);
        let mut upper = MatMut::from_column_major_slice_mut(upper, r, w);
        let stack = MemStack::new(&mut self.memory);
        let positions = &mut self.positions[..w];
        lu_in_place(block.as_mut(), exchanges, positions, Par::Seq, stack, Default::default());
        for (k, size) in self.sizes.iter().enumerate() {
            let pivot: f64 = block[(k, k)].into();
            // The condition also holds for NaN.
            if !(pivot.abs() > SMALL_PIVOT * eps::<T>().into() * size && pivot.is_finite()) {
                return Err(LinearError::Singular { growth: f64::INFINITY });
            }
        }
        if exchanges.iter().zip(0..).any(|(from, to)| *from != to) {
            self.spare.clear();
            for from in &*exchanges {
                self.spare.extend(upper.as_ref().col(*from as usize).iter());
            }
            upper.copy_from(MatRef::from_column_major_slice(&self.spare, r, w));
        }
        solve_lower_triangular_in_place(block.as_ref().transpose(), lower.as_mut().transpose_mut(), Par::Seq);
        solve_unit_lower_triangular_in_place(block.as_ref(), upper.as_mut().transpose_mut(), Par::Seq);
        let begin = self.updates.len() - r * r;
        let update = MatMut::from_column_major_slice_mut(&mut self.updates[begin..], r, r);
        matmul(update, Accum::Add, lower.as_ref(), upper.as_ref().transpose(), -one::<T>(), Par::Seq);
        Ok(())
    }
}

/// Columns that are multiplied at once.
const COLUMNS: usize = 4;
/// Partial sums of a scalar product.
const SUMS: usize = 8;

/// Adds the product of a matrix, by columns, and a vector.
#[inline(always)]
fn add_product<T: RealField + Copy>(matrix: &[T], x: &[T], y: &mut [T]) {
    let n = y.len();
    let (many, few) = matrix.split_at(x.len() / COLUMNS * COLUMNS * n);
    let (x, last) = x.as_chunks();
    for ([x0, x1, x2, x3], columns) in x.iter().zip(many.chunks_exact((COLUMNS * n).max(1))) {
        let (first, second) = columns.split_at(2 * n);
        let ((a0, a1), (a2, a3)) = (first.split_at(n), second.split_at(n));
        for ((((y, a0), a1), a2), a3) in y.iter_mut().zip(a0).zip(a1).zip(a2).zip(a3) {
            *y += (*a0 * *x0 + *a1 * *x1) + (*a2 * *x2 + *a3 * *x3);
        }
    }
    for (x, column) in last.iter().zip(few.chunks_exact(n.max(1))) {
        y.iter_mut().zip(column).for_each(|(y, a)| *y += *a * *x);
    }
}

/// Subtracts the product of the transpose of a matrix, by columns, and a vector.
#[inline(always)]
fn subtract_transposed_product<T: RealField + Copy>(matrix: &[T], x: &[T], y: &mut [T]) {
    let (x, last) = x.as_chunks::<SUMS>();
    for (y, column) in y.iter_mut().zip(matrix.chunks_exact((SUMS * x.len() + last.len()).max(1))) {
        let (column, column_last) = column.as_chunks::<SUMS>();
        let mut sums = [zero::<T>(); SUMS];
        for (a, x) in column.iter().zip(x) {
            sums.iter_mut().zip(a).zip(x).for_each(|((sum, a), x)| *sum += *a * *x);
        }
        column_last.iter().zip(last).zip(&mut sums).for_each(|((a, x), sum)| *sum += *a * *x);
        *y -= sums.iter().fold(zero::<T>(), |total: T, sum| total + *sum);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::SplitMix64;

    use super::*;

    /// Returns a saddle point problem on an `m` by `m` grid, and the nodes of its unknowns.
    ///
    /// Each point has two velocities and a pressure, whose diagonal entry is zero. Couplings to neighbours are random;
    /// for every third point they are stored in one direction only. The unknowns of a field are contiguous.
    fn saddle_points(m: usize) -> (CsMatI<f64, u32>, Vec<u32>) {
        let n = m * m;
        let mut random = SplitMix64::seed_from_u64(1);
        let mut triplets = sprs::TriMatI::new((3 * n, 3 * n));
        for point in 0..n {
            let (i, j) = (point % m, point / m);
            for (a, b, value) in
                [(0, 0, 4.0), (1, 1, 4.0), (0, 2, 1.0), (1, 2, 0.7), (2, 0, -1.0), (2, 1, -0.7), (2, 2, 0.0)]
            {
                triplets.add_triplet(a * n + point, b * n + point, value);
            }
            for (has, other) in [(i + 1 < m, point + 1), (j + 1 < m, point + m)] {
                if !has {
                    continue;
                }
                for component in 0..2 {
                    triplets.add_triplet(component * n + point, component * n + other, random.random_range(-1.0..1.0));
                    if point % 3 != 0 {
                        triplets.add_triplet(
                            component * n + other,
                            component * n + point,
                            random.random_range(-1.0..1.0),
                        );
                    }
                    triplets.add_triplet(2 * n + other, component * n + point, 0.3 * random.random_range(-1.0..1.0));
                    triplets.add_triplet(component * n + point, 2 * n + other, 0.3 * random.random_range(-1.0..1.0));
                }
            }
        }
        (triplets.to_csc(), (0..3 * n).map(|k| (k % n) as u32).collect())
    }

    /// Returns `‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖)` in maximum norms, for the solution of random right-hand side with the
    /// factors.
    fn backward_error<T: RealField + Copy + Into<f64>>(
        factors: &mut StaticFactors<T>,
        matrix: &CsMatI<f64, u32>,
    ) -> (f64, Vec<f64>) {
        let mut random = SplitMix64::seed_from_u64(1);
        let rhs: Vec<f64> = (0..matrix.rows()).map(|_| random.random_range(-1.0..1.0)).collect();
        let mut x = rhs.clone();
        factors.substitute(&mut x).unwrap();
        let mut residual: Vec<f64> = rhs.iter().map(|b| -b).collect();
        sprs::prod::mul_acc_mat_vec_csc(matrix.view(), x.as_slice(), residual.as_mut_slice());
        let mut sums = vec![0.0; matrix.rows()];
        matrix.iter().for_each(|(value, (i, _))| sums[i as usize] += value.abs());
        let norm = |x: &[f64]| x.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        (norm(&residual) / (norm(&sums) * norm(&x) + norm(&rhs)), x)
    }

    #[test]
    fn saddle_points_are_solved_to_round_off() {
        for m in [1, 2, 7, 40] {
            let (matrix, nodes) = saddle_points(m);
            let (mut double, mut single) = (StaticFactors::<f64>::default(), StaticFactors::<f32>::default());
            double.factorize(&matrix, &nodes).unwrap();
            single.factorize(&matrix, &nodes).unwrap();
            let (of_double, of_single) =
                (backward_error(&mut double, &matrix).0, backward_error(&mut single, &matrix).0);
            assert!(of_double <= 1e-13 && of_single <= 1e-4, "m = {m}: {of_double:e} {of_single:e}");
        }
    }

    #[test]
    fn wide_vectors_change_no_bit() {
        let (matrix, nodes) = saddle_points(40);
        let mut factors = StaticFactors::<f32>::default();
        factors.factorize(&matrix, &nodes).unwrap();
        let mut random = SplitMix64::seed_from_u64(1);
        let mut wide: Vec<f64> = (0..matrix.rows()).map(|_| random.random_range(-1.0..1.0)).collect();
        let mut plain = wide.clone();
        factors.substitute(&mut wide).unwrap();
        factors.substitute_by(&mut plain, |substitution| substitution.call()).unwrap();
        assert!(wide.iter().zip(&plain).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn fronts_are_kept_and_change_no_bit() {
        let (matrix, nodes) = saddle_points(12);
        let mut used = StaticFactors::<f64>::default();
        used.factorize(&matrix, &nodes).unwrap();
        used.factorize(&matrix.map(|value| 2.0 * value), &nodes).unwrap();
        assert_eq!(used.n_symbolic, 1);
        used.factorize(&saddle_points(5).0, &saddle_points(5).1).unwrap();
        used.factorize(&matrix, &nodes).unwrap();
        assert_eq!(used.n_symbolic, 3);
        let mut new = StaticFactors::<f64>::default();
        new.factorize(&matrix, &nodes).unwrap();
        let (old, new) = (backward_error(&mut used, &matrix).1, backward_error(&mut new, &matrix).1);
        assert!(old.iter().zip(&new).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn a_pivot_without_size_is_an_error_and_there_are_no_factors_then() {
        // Zero diagonal entries in nodes of their own, far from each other: pivoting would have to exchange rows of
        // different fronts, which is not possible.
        let n = 40;
        let mut triplets = sprs::TriMatI::new((2 * n, 2 * n));
        for k in 0..n {
            triplets.add_triplet(k, n + k, 1.0);
            triplets.add_triplet(n + k, k, 1.0);
            triplets.add_triplet(n + k, n + (k + 1) % n, 0.5);
        }
        let matrix: CsMatI<f64, u32> = triplets.to_csc();
        let nodes: Vec<u32> = (0..2 * n as u32).collect();
        let mut factors = StaticFactors::<f32>::default();
        let outcome = factors.factorize(&matrix, &nodes);
        assert!(matches!(outcome, Err(LinearError::Singular { .. })), "{outcome:?}");
        assert_eq!(factors.substitute(&mut vec![0.0; 2 * n]), Err(LinearError::NotFactorized));
    }
}
