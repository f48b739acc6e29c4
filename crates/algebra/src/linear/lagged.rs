//! FGMRES with the factors of an old matrix.

use sprs::CsMatI;

use super::factors::Factors;
use super::gmres::{Gmres, GmresReport, GmresSettings};
use super::scaled::Scaled;
use super::subdomain::{BlockSolver, Subdomain, with_neighbours};
use super::{Equilibration, LinearError, LinearReport, LinearSolver, MatrixView, Unknowns, check_sides};

/// When old factors are good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaggedSettings {
    /// Change of an entry of the equilibrated matrix, whose rows and columns have largest entries near one, from which on
    /// its unknown counts as changed.
    pub change: f64,
    /// Share of the unknowns that may have changed; with more the matrix is factorised.
    pub largest_share: f64,
    /// Iterations of a solve beyond which the next matrix is factorised.
    pub most_iterations: usize,
    /// Iterations before a restart, and the most of a solve: after these the present matrix is factorised.
    pub restart: usize,
}

impl Default for LaggedSettings {
    fn default() -> Self {
        Self { change: 0.3, largest_share: 0.5, most_iterations: 15, restart: 40 }
    }
}

/// Sparse LU that lags: one factorisation serves the matrices of many solves, also when unknowns come and go.
///
/// The factors of an old matrix, applied to the unknowns that both have, precondition FGMRES for the present one. Where an
/// interface moved, rows have changed entirely; these unknowns and their neighbours are solved for anew with small factors
/// of their own, on the residual that the old factors leave (a multiplicative Schwarz step). Unknowns are told apart by
/// their keys ([`Unknowns::keys`]); without keys every matrix is factorised.
///
/// The matrix is factorised when the last solve took many iterations, when many unknowns have changed, or when a solve does
/// not converge: counts decide, never times, so that runs can be repeated bit by bit.
pub struct LaggedSolver {
    settings: LaggedSettings,
    present: Scaled,
    keys: Vec<u64>,
    nodes: Vec<u32>,
    base: Option<Base>,
    patch: Patch,
    wants_factors: bool,
    n_factorizations: usize,
    gmres: Gmres,
    rhs: Vec<f64>,
    solution: Vec<f64>,
}

/// The matrix that was factorised last.
struct Base {
    scaled: Scaled,
    factors: Factors,
    /// Keys of its unknowns with their positions, sorted.
    keys: Vec<(u64, u32)>,
}

/// How the present unknowns relate to those of the base, and the factors where the matrix has changed.
#[derive(Default)]
struct Patch {
    /// Position in the base of each unknown; `NONE` where it has none.
    to_base: Vec<u32>,
    /// Ratios of old to present scales.
    row_ratio: Vec<f64>,
    column_ratio: Vec<f64>,
    /// Changed unknowns and their neighbours.
    changed: Subdomain,
    base_work: Vec<f64>,
}

const NONE: u32 = u32::MAX;

impl LaggedSolver {
    /// A solver without a matrix.
    pub fn new(settings: LaggedSettings) -> Self {
        Self {
            settings,
            present: Scaled::default(),
            keys: Vec::new(),
            nodes: Vec::new(),
            base: None,
            patch: Patch::default(),
            wants_factors: false,
            n_factorizations: 0,
            gmres: Gmres::default(),
            rhs: Vec::new(),
            solution: Vec::new(),
        }
    }

    /// Factorises the present matrix, which becomes the base.
    fn renew(&mut self) -> Result<(), LinearError> {
        let Some(matrix) = &self.present.matrix else { return Err(LinearError::NotFactorized) };
        let n = matrix.rows();
        let mut base = self.base.take().unwrap_or_else(|| Base {
            scaled: Scaled::default(),
            factors: Factors::default(),
            keys: Vec::new(),
        });
        base.factors.clear_pattern();
        self.n_factorizations += 1;
        base.factors.factorize(matrix, &self.nodes)?;
        base.factors.probe(n, &mut self.solution)?;
        base.scaled.scales.clone_from(&self.present.scales);
        base.scaled.matrix = Some(matrix.clone());
        base.keys.clear();
        base.keys.extend(self.keys.iter().zip(0..).map(|(key, k)| (*key, k)));
        base.keys.sort_unstable();
        self.base = Some(base);
        self.wants_factors = false;
        self.patch.is_base(n);
        Ok(())
    }
}

impl Patch {
    /// The present matrix is that of the base.
    fn is_base(&mut self, n: usize) {
        self.to_base.clear();
        self.to_base.extend(0..n as u32);
        for ratio in [&mut self.row_ratio, &mut self.column_ratio] {
            ratio.clear();
            ratio.resize(n, 1.0);
        }
        self.changed.clear();
    }

    /// Relates the present unknowns to those of the base.
    fn relate(&mut self, keys: &[u64], scales: &Equilibration, base: &Base) {
        self.to_base.clear();
        self.to_base.extend(keys.iter().map(|key| {
            let found = base.keys.binary_search_by_key(key, |(key, _)| *key);
            found.map_or(NONE, |k| base.keys[k].1)
        }));
        let old = &base.scaled.scales;
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
        let Some(old) = &base.scaled.matrix else { return Vec::new() };
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
                    // A vanished unknown acted on this one.
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

    /// `z ≈ A⁻¹ r`: the old factors, then those of the members on what is left.
    fn apply(
        &mut self,
        matrix: &CsMatI<f64, u32>,
        factors: &mut Factors,
        r: &[f64],
        z: &mut [f64],
    ) -> Result<(), LinearError> {
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
        if self.changed.members().is_empty() {
            return Ok(());
        }
        self.base_work.clear();
        self.base_work.extend(r.iter().map(|r| -r));
        sprs::prod::mul_acc_mat_vec_csc(matrix.view(), &*z, self.base_work.as_mut_slice());
        self.base_work.iter_mut().for_each(|r| *r = -*r);
        self.changed.correct(&self.base_work, z)
    }
}

impl LinearSolver for LaggedSolver {
    fn factorize(&mut self, matrix: MatrixView<'_>, unknowns: Unknowns<'_>) -> Result<(), LinearError> {
        assert_eq!(matrix.rows(), unknowns.nodes.len(), "nodes of the unknowns");
        let n = matrix.rows();
        self.present.set(matrix)?;
        self.nodes.clear();
        self.nodes.extend_from_slice(unknowns.nodes);
        self.keys.clear();
        self.keys.extend_from_slice(unknowns.keys);
        if n == 0 {
            return Ok(());
        }
        if let Scaled { scales, matrix: Some(scaled) } = &self.present
            && let Some(base) = self.base.as_ref().filter(|_| !self.wants_factors && self.keys.len() == n)
        {
            self.patch.relate(&self.keys, scales, base);
            let changed = self.patch.find_changed(scaled, base, self.settings.change);
            let n_changed = changed.len();
            if n_changed as f64 <= self.settings.largest_share * n as f64
                && self
                    .patch
                    .changed
                    .factorize(scaled, changed, n_changed, &self.nodes, scales, BlockSolver::Lu)
                    .is_ok()
            {
                return Ok(());
            }
        }
        self.renew()
    }

    fn solve(&mut self, rhs: &[f64], x: &mut [f64], tolerance: f64) -> Result<LinearReport, LinearError> {
        let Some(matrix) = &self.present.matrix else { return Err(LinearError::NotFactorized) };
        check_sides(matrix.rows(), rhs, x)?;
        if matrix.rows() == 0 {
            return Ok(LinearReport::default());
        }
        self.present.scale_rhs(rhs, &mut self.rhs);
        let settings =
            GmresSettings { tolerance, restart: self.settings.restart, max_iterations: self.settings.restart };
        let mut iterations = 0;
        let mut outcome = self.iterate(&settings);
        if let Err(LinearError::NotConverged { iterations: n, .. }) = outcome {
            iterations += n;
            self.renew()?;
            outcome = self.iterate(&settings);
        }
        let report = outcome?;
        iterations += report.iterations;
        self.wants_factors |= report.iterations > self.settings.most_iterations;
        self.present.unscale(&self.solution, x);
        Ok(LinearReport { iterations, backward_error: report.residual })
    }

    fn equilibration(&self) -> &Equilibration {
        &self.present.scales
    }

    fn n_factorizations(&self) -> usize {
        self.n_factorizations
    }

    fn forget(&mut self) {
        self.wants_factors = true;
    }
}

impl LaggedSolver {
    /// FGMRES from zero for the scaled right-hand side.
    fn iterate(&mut self, settings: &GmresSettings) -> Result<GmresReport, LinearError> {
        let (Some(matrix), Some(base)) = (&self.present.matrix, &mut self.base) else {
            return Err(LinearError::NotFactorized);
        };
        let patch = &mut self.patch;
        let mut precondition = |r: &[f64], z: &mut [f64]| patch.apply(matrix, &mut base.factors, r, z);
        self.gmres.solve_matrix(matrix, &mut precondition, &self.rhs, &mut self.solution, settings)
    }
}
