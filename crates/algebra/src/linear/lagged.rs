//! FGMRES with the factors of an old matrix.

mod base;

use sprs::CsMatI;

use self::base::Base;
use super::checked_factors::CheckedFactors;
use super::gmres::{Gmres, GmresSettings};
use super::subdomain::{BlockSolver, Subdomain, rows_of, with_neighbours};
use super::{LinearError, LinearReport, LinearSolver, LinearSystem};

/// Criteria for the use of old factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaggedSettings {
    /// Largest change of an entry of the equilibrated matrix with which row and column of the entry count as unchanged.
    /// The largest entries of rows and columns are near one.
    pub change: f64,
    /// Largest share of unknowns that have changed or have changed neighbours. Above it the matrix is factorised.
    pub largest_share: f64,
    /// Number of iterations of a solve above which the next matrix is factorised.
    pub most_iterations: usize,
    /// Iterations before a restart, and largest number of iterations of a solve. If a solve needs more, the present
    /// matrix is factorised and the solve is repeated.
    pub restart: usize,
}

impl Default for LaggedSettings {
    fn default() -> Self {
        Self { change: 0.3, largest_share: 0.5, most_iterations: 15, restart: 40 }
    }
}

/// Sparse LU that lags: one factorisation is used for the matrices of many solves, also when unknowns appear and
/// vanish.
///
/// The factors of an old matrix, applied to the unknowns of both matrices, precondition FGMRES for the present one.
/// Where an interface moved, rows have changed entirely; these unknowns and their neighbours are solved for again with
/// small factors of their own, on the residual that the old factors leave (a multiplicative Schwarz step). Unknowns are
/// matched by their keys ([`crate::BlockLayout::keys`]).
///
/// Both factors are in single precision, with pivots inside supernodes only. If such factors do not reduce residuals,
/// or GMRES does not converge with them, they are replaced by factors with free pivoting in double precision.
///
/// The matrix is factorised when the last solve took many iterations, when many unknowns have changed, or when a solve
/// does not converge. These criteria do not depend on times, so that runs can be repeated bit by bit.
pub struct LaggedSolver {
    settings: LaggedSettings,
    base: Option<Base>,
    patch: Patch,
    /// Whether the factors and the patch belong to the matrix that was given last.
    is_factorized: bool,
    must_factorize: bool,
    n_factorizations: usize,
    n_fallbacks: usize,
    gmres: Gmres,
    rhs: Vec<f64>,
    solution: Vec<f64>,
}

/// Relation of the present unknowns to those of the base, and factors where the matrix has changed.
#[derive(Default)]
struct Patch {
    /// Position in the base of each unknown, or [`NONE`].
    to_base: Vec<u32>,
    /// Ratios of old to present scales.
    row_ratio: Vec<f64>,
    column_ratio: Vec<f64>,
    /// Changed unknowns and their neighbours.
    changed: Subdomain,
    /// The rows of the changed unknowns and their neighbours.
    rows: Option<CsMatI<f64, u32>>,
    base_work: Vec<f64>,
}

/// Position in the base of unknowns that are not in the base.
const NONE: u32 = u32::MAX;

impl LaggedSolver {
    /// Creates a solver without a matrix.
    pub fn new(settings: LaggedSettings) -> Self {
        Self {
            settings,
            base: None,
            patch: Patch::default(),
            is_factorized: false,
            must_factorize: false,
            n_factorizations: 0,
            n_fallbacks: 0,
            gmres: Gmres::default(),
            rhs: Vec::new(),
            solution: Vec::new(),
        }
    }

    /// Factorises the present matrix, which becomes the base; with free pivoting if `must_pivot` or static pivots fail.
    fn renew(&mut self, system: &LinearSystem<'_>, must_pivot: bool) -> Result<(), LinearError> {
        let n = system.len();
        let factors = self.base.take().map(|base| base.factors).unwrap_or_default();
        self.n_factorizations += 1;
        let base = Base::new(system, factors, must_pivot)?;
        self.n_fallbacks += usize::from(base.factors.is_pivoting());
        self.base = Some(base);
        self.must_factorize = false;
        self.patch.set_to_base(n);
        Ok(())
    }
}

impl Patch {
    /// Records that the present matrix, of size `n`, is the matrix of the base.
    fn set_to_base(&mut self, n: usize) {
        self.to_base.clear();
        self.to_base.extend(0..n as u32);
        for ratio in [&mut self.row_ratio, &mut self.column_ratio] {
            ratio.clear();
            ratio.resize(n, 1.0);
        }
        self.changed.clear();
        self.rows = None;
    }

    /// Relates the present unknowns to those of the base.
    fn relate(&mut self, system: &LinearSystem<'_>, base: &Base) {
        self.to_base.clear();
        self.to_base.extend(system.layout.keys().iter().map(|key| {
            let found = base.keys.binary_search_by_key(key, |(key, _)| *key);
            found.map_or(NONE, |k| base.keys[k].1)
        }));
        let (old, scales) = (&base.scales, system.scales);
        for (ratio, (old, present)) in [
            (&mut self.row_ratio, (old.row(), scales.row())),
            (&mut self.column_ratio, (old.column(), scales.column())),
        ] {
            ratio.clear();
            ratio.extend(self.to_base.iter().zip(present).map(|(k, present)| match *k {
                NONE => 0.0,
                k => old[k as usize] / present,
            }));
        }
    }

    /// Finds the unknowns whose row or column has changed by more than `change`, and their neighbours.
    fn find_changed(&self, matrix: &CsMatI<f64, u32>, base: &Base, change: f64) -> Vec<u32> {
        let n = matrix.rows();
        let old = &base.matrix;
        let mut from_base = vec![NONE; old.rows()];
        for (i, k) in self.to_base.iter().enumerate() {
            if *k != NONE {
                from_base[*k as usize] = i as u32;
            }
        }
        let mut changed: Vec<bool> = self.to_base.iter().map(|k| *k == NONE).collect();
        // Entries of a column of the old matrix in the scales of the present one.
        let mut column = vec![0.0; n];
        for (j, entries) in matrix.outer_iterator().enumerate() {
            let k = self.to_base[j];
            if k == NONE {
                entries.indices().iter().for_each(|i| changed[*i as usize] = true);
                continue;
            }
            let Some(old_entries) = old.outer_view(k as usize) else { continue };
            for (row, value) in old_entries.iter() {
                let i = from_base[row];
                if i == NONE {
                    // An unknown that has vanished was coupled to this one.
                    changed[j] |= value.abs() > change;
                } else {
                    column[i as usize] = value / (self.row_ratio[i as usize] * self.column_ratio[j]);
                }
            }
            for (i, value) in entries.iter() {
                if (value - column[i]).abs() > change {
                    changed[i] = true;
                    changed[j] = true;
                }
                column[i] = 0.0;
            }
            for row in old_entries.indices() {
                let i = from_base[*row as usize];
                if i != NONE {
                    if column[i as usize].abs() > change {
                        changed[i as usize] = true;
                        changed[j] = true;
                    }
                    column[i as usize] = 0.0;
                }
            }
        }
        with_neighbours(matrix, &changed)
    }

    /// Computes `z ≈ A⁻¹ r`: applies the old factors, then the factors of the changed unknowns to the remaining
    /// residual.
    fn apply(&mut self, factors: &mut CheckedFactors, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        let n_base = factors.len();
        self.base_work.clear();
        self.base_work.resize(n_base, 0.0);
        for ((r, k), ratio) in r.iter().zip(&self.to_base).zip(&self.row_ratio) {
            if *k != NONE {
                self.base_work[*k as usize] = r * ratio;
            }
        }
        factors.substitute(&mut self.base_work)?;
        for ((z, k), ratio) in z.iter_mut().zip(&self.to_base).zip(&self.column_ratio) {
            *z = if *k == NONE { 0.0 } else { self.base_work[*k as usize] * ratio };
        }
        match &self.rows {
            Some(rows) => self.changed.correct_remainder(rows, r, z),
            None => Ok(()),
        }
    }
}

impl LinearSolver for LaggedSolver {
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError> {
        self.is_factorized = false;
        if let Some(base) = self.base.as_ref().filter(|_| !self.must_factorize && !system.is_empty()) {
            self.patch.relate(system, base);
            let changed = self.patch.find_changed(system.matrix, base, self.settings.change);
            let n_changed = changed.len();
            let is_small = n_changed as f64 <= self.settings.largest_share * system.len() as f64;
            let rows = (n_changed > 0 && is_small).then(|| rows_of(system.matrix, &changed));
            let patch = &mut self.patch.changed;
            self.is_factorized = is_small && patch.factorize(system, changed, n_changed, BlockSolver::SingleLu).is_ok();
            self.patch.rows = rows;
        }
        if !self.is_factorized && !system.is_empty() {
            self.renew(system, false)?;
        }
        self.is_factorized = true;
        Ok(())
    }

    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<LinearReport, LinearError> {
        if !self.is_factorized {
            return Err(LinearError::NotFactorized);
        }
        system.scale_rhs(rhs, x, &mut self.rhs)?;
        if system.is_empty() {
            return Ok(LinearReport::default());
        }
        let settings =
            GmresSettings { tolerance, restart: self.settings.restart, max_iterations: self.settings.restart };
        let mut iterations = 0;
        let mut outcome = self.iterate(system, &settings);
        for must_pivot in [false, true] {
            let Err(LinearError::NotConverged { iterations: n, .. }) = outcome else { break };
            iterations += n;
            self.renew(system, must_pivot)?;
            outcome = self.iterate(system, &settings);
        }
        let report = outcome?;
        iterations += report.iterations;
        self.must_factorize |= report.iterations > self.settings.most_iterations;
        system.unscale(&self.solution, x);
        Ok(LinearReport { iterations, ..report })
    }

    fn n_factorizations(&self) -> usize {
        self.n_factorizations
    }

    fn n_fallbacks(&self) -> usize {
        self.n_fallbacks
    }

    fn memory(&self) -> Vec<Vec<f64>> {
        self.base.as_ref().filter(|_| !self.must_factorize).map_or(Vec::new(), Base::to_lists)
    }

    fn recall(&mut self, memory: &[Vec<f64>]) -> Result<(), LinearError> {
        (self.base, self.is_factorized, self.must_factorize) = (None, false, false);
        if !memory.is_empty() {
            self.base = Some(Base::from_lists(memory)?);
        }
        Ok(())
    }
}

impl LaggedSolver {
    /// Runs FGMRES from zero for the scaled right-hand side.
    fn iterate(&mut self, system: &LinearSystem<'_>, settings: &GmresSettings) -> Result<LinearReport, LinearError> {
        let patch = &mut self.patch;
        let Some(base) = &mut self.base else { return Err(LinearError::NotFactorized) };
        let mut precondition = |r: &[f64], z: &mut [f64]| patch.apply(&mut base.factors, r, z);
        self.gmres.solve(system.matrix, &mut precondition, &self.rhs, &mut self.solution, settings)
    }
}
