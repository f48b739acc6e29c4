//! The global residual and tangent of one nonlinear solve.

use std::time::Instant;

use crate::linear::{LinearError, LinearSystem, ScaledMatrix};
use crate::scatter::{AffineSum, Scatter, Stripes, Work};
use crate::{BlockLayout, Constraints, Contributions, DofId, MatrixView, Pattern};

/// Time spent in one contribution, for reports only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContributionTiming {
    /// Name of the contribution.
    pub name: &'static str,
    /// Number of items.
    pub items: usize,
    /// Number of evaluations of all items.
    pub calls: usize,
    /// Wall-clock time of all calls, s. The time of a call is the time of its slowest thread.
    pub seconds: f64,
}

/// Layout, one sparse matrix and one residual.
///
/// Linear contributions are assembled once, when the system is built: their tangent `K` and their residual `r₀` at
/// x = 0. At a state x the system is then
///
/// `residual = K x + r₀ + Σ nonlinear residuals,    matrix = K + Σ nonlinear tangents`
///
/// with constrained rows and columns replaced by the identity and a zero residual. The share of prescribed values in
/// `K x` is constant and therefore part of `r₀`; `K` is stored without constrained rows and columns. Blocks are the
/// index ranges of the layout, not separate matrices. Later calls must be given the same contributions as the
/// constructor.
#[derive(Default)]
pub struct BlockSystem {
    layout: BlockLayout,
    pattern: Pattern,
    stripes: Stripes,
    /// `K`, without constrained rows and columns.
    linear_values: Vec<f64>,
    /// `r₀`, including the share of prescribed values.
    linear_residual: Vec<f64>,
    /// The matrix where there are nonlinear contributions, once it has been assembled.
    values: Vec<f64>,
    residual: Vec<f64>,
    matrix_is_linear: bool,
    constrained: Vec<bool>,
    prescribed: Vec<(DofId, f64)>,
    /// Values of tied dofs where their masters are zero.
    offsets: Vec<(DofId, f64)>,
    /// Entries in constrained rows and columns, with the value that each of them takes.
    eliminated: Vec<(u32, f64)>,
    /// The matrix of the last [`BlockSystem::equilibrate`] in its scales.
    scaled: ScaledMatrix,
    has_nonlinear: bool,
    timings: Vec<ContributionTiming>,
    seconds_pattern: f64,
    scatter: Scatter,
    affine: AffineSum,
}

impl BlockSystem {
    /// Builds the pattern and assembles the linear contributions. Until [`BlockSystem::assemble`] is called, matrix and
    /// residual are those at x = 0 without the nonlinear contributions.
    ///
    /// Contributions with tied dofs must be wrapped in [`crate::Tied`].
    ///
    /// # Panics
    /// A contribution or a constraint names a dof outside of the layout.
    pub fn new(layout: &BlockLayout, contributions: &[&dyn Contributions], constraints: &Constraints) -> Self {
        Self::default().recycle(layout, contributions, constraints)
    }

    /// Creates a system as [`BlockSystem::new`] does, in the memory of an old system of any size.
    pub fn recycle(
        mut self,
        layout: &BlockLayout,
        contributions: &[&dyn Contributions],
        constraints: &Constraints,
    ) -> Self {
        let n = layout.len();
        self.layout = layout.clone();
        let begin = Instant::now();
        let pattern_changed = self.pattern.rebuild(n, contributions);
        let n_stripes = Stripes::number(n);
        if pattern_changed || n_stripes != self.stripes.len() {
            self.stripes = self.stripes.recycle(n_stripes, layout, &self.pattern);
        }
        self.seconds_pattern = begin.elapsed().as_secs_f64();
        self.constrained.clear();
        self.constrained.resize(n, false);
        self.prescribed.clear();
        for (dof, value) in constraints.iter() {
            assert!(dof.index() < n, "constrained dof {} of {n} unknowns", dof.index());
            self.constrained[dof.index()] = true;
            self.prescribed.push((dof, value));
        }
        // The system has zero corrections of tied dofs. Their values follow from the corrections of their masters.
        for (dof, _) in constraints.ties() {
            assert!(dof.index() < n, "tied dof {} of {n} unknowns", dof.index());
            self.constrained[dof.index()] = true;
            self.prescribed.push((dof, 0.0));
        }
        self.offsets.clear();
        self.offsets.extend(constraints.offsets());
        self.find_eliminated();
        self.has_nonlinear = contributions.iter().any(|c| !c.is_linear() && !c.is_empty());
        self.timings.clear();
        self.timings.extend(contributions.iter().map(|c| ContributionTiming {
            name: c.name(),
            items: c.len(),
            ..ContributionTiming::default()
        }));
        self.assemble_linear(contributions);
        self
    }

    /// Finds the entries in constrained rows and columns; the rows follow from the columns by symmetry.
    fn find_eliminated(&mut self) {
        self.eliminated.clear();
        let (column_ptr, rows) = (self.pattern.column_ptr(), self.pattern.rows());
        for (dof, _) in &self.prescribed {
            let range = column_ptr[dof.index()] as usize..column_ptr[dof.index() + 1] as usize;
            for k in range {
                let other = rows[k] as usize;
                self.eliminated.push((k as u32, if other == dof.index() { 1.0 } else { 0.0 }));
                if !self.constrained[other] {
                    let begin = column_ptr[other] as usize;
                    let in_row = rows[begin..column_ptr[other + 1] as usize]
                        .partition_point(|&row| (row as usize) < dof.index());
                    self.eliminated.push(((begin + in_row) as u32, 0.0));
                }
            }
        }
    }

    /// Evaluates the linear contributions again on the known pattern: the dofs of their items are unchanged, their
    /// coefficients may have changed. Matrix and residual are those at x = 0 without the nonlinear contributions.
    /// Unknowns without a prescribed value are zero, and tied ones have their offsets.
    ///
    /// # Panics
    /// The contributions do not belong to this system.
    pub fn assemble_linear(&mut self, contributions: &[&dyn Contributions]) {
        let n = self.pattern.n_unknowns();
        let mut residual = std::mem::take(&mut self.linear_residual);
        let mut values = std::mem::take(&mut self.linear_values);
        residual.resize(n, 0.0);
        values.resize(self.pattern.n_entries(), 0.0);
        let mut origin = std::mem::take(&mut self.residual);
        origin.clear();
        origin.resize(n, 0.0);
        self.offsets.iter().for_each(|(dof, offset)| origin[dof.index()] = *offset);
        self.add(contributions, true, &origin, &mut residual, Some(&mut values));
        let (column_ptr, rows) = (self.pattern.column_ptr(), self.pattern.rows());
        for &(dof, prescribed) in self.prescribed.iter().filter(|(_, prescribed)| *prescribed != 0.0) {
            let column = column_ptr[dof.index()] as usize..column_ptr[dof.index() + 1] as usize;
            for (&row, value) in rows[column.clone()].iter().zip(&values[column]) {
                residual[row as usize] += value * prescribed;
            }
        }
        self.eliminated.iter().for_each(|&(k, value)| values[k as usize] = value);
        self.prescribed.iter().for_each(|(dof, _)| residual[dof.index()] = 0.0);
        origin.copy_from_slice(&residual);
        (self.residual, self.linear_residual, self.linear_values) = (origin, residual, values);
        self.matrix_is_linear = true;
    }

    /// Evaluates residual and matrix at `x`, which satisfies the constraints.
    ///
    /// # Panics
    /// `x` or the contributions do not belong to this system.
    pub fn assemble(&mut self, contributions: &[&dyn Contributions], x: &[f64]) {
        let mut values = std::mem::take(&mut self.values);
        if self.has_nonlinear {
            values.resize(self.linear_values.len(), 0.0);
            self.evaluate(contributions, x, Some(&mut values));
            self.eliminated.iter().for_each(|&(k, value)| values[k as usize] = value);
        } else {
            self.evaluate(contributions, x, None);
        }
        self.values = values;
        self.matrix_is_linear = !self.has_nonlinear;
    }

    /// Evaluates only the residual at `x`; the matrix is unchanged.
    ///
    /// # Panics
    /// `x` or the contributions do not belong to this system.
    pub fn assemble_residual(&mut self, contributions: &[&dyn Contributions], x: &[f64]) {
        self.evaluate(contributions, x, None);
    }

    /// Evaluates the residual at `x` and, on request, the matrix before elimination.
    fn evaluate(&mut self, contributions: &[&dyn Contributions], x: &[f64], mut values: Option<&mut [f64]>) {
        assert_eq!(x.len(), self.pattern.n_unknowns(), "length of the state");
        let mut residual = std::mem::take(&mut self.residual);
        let (entries, r, copy) = (&self.linear_values, &self.linear_residual, values.as_deref_mut());
        self.affine.evaluate(&self.pattern, entries, copy, r, x, &mut residual);
        if self.has_nonlinear {
            self.add(contributions, false, x, &mut residual, values);
        }
        self.prescribed.iter().for_each(|(dof, _)| residual[dof.index()] = 0.0);
        self.residual = residual;
    }

    /// Adds the linear contributions to zero, or the nonlinear ones to the current values.
    fn add(
        &mut self,
        contributions: &[&dyn Contributions],
        linear: bool,
        x: &[f64],
        residual: &mut [f64],
        values: Option<&mut [f64]>,
    ) {
        assert_eq!(contributions.len(), self.timings.len(), "number of contributions");
        let mut works = Vec::with_capacity(contributions.len());
        for (index, &contribution) in contributions.iter().enumerate() {
            if contribution.is_linear() == linear && !contribution.is_empty() {
                let items = self.pattern.items(index);
                assert_eq!(contribution.len(), items.len(), "items of {}", contribution.name());
                works.push(Work { index, contribution, pattern: &self.pattern, items });
            }
        }
        let dealt = self.stripes.deal(&self.pattern, residual, values);
        self.scatter.add(&works, x, &self.stripes, dealt, linear, |index, seconds| {
            self.timings[index].calls += 1;
            self.timings[index].seconds += seconds;
        });
    }

    /// Returns the fields of the unknowns.
    pub fn layout(&self) -> &BlockLayout {
        &self.layout
    }

    /// Returns the sparsity pattern.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Returns the matrix of the last assembly.
    pub fn matrix(&self) -> MatrixView<'_> {
        let values = if self.matrix_is_linear { &self.linear_values } else { &self.values };
        let n = self.pattern.n_unknowns();
        MatrixView::new_csc((n, n), self.pattern.column_ptr(), self.pattern.rows(), values)
    }

    /// Equilibrates the matrix of the last assembly. Later assemblies do not change the equilibrated copy.
    ///
    /// # Errors
    /// A row or column is zero, or an entry is not finite.
    pub fn equilibrate(&mut self) -> Result<(), LinearError> {
        let mut scaled = std::mem::take(&mut self.scaled);
        let outcome = scaled.set(self.matrix());
        self.scaled = scaled;
        outcome
    }

    /// Returns the matrix of the last [`BlockSystem::equilibrate`] as a linear system.
    ///
    /// # Errors
    /// [`LinearError::NotFactorized`]: no matrix was equilibrated, or the last one has no scales.
    pub fn linear_system(&self) -> Result<LinearSystem<'_>, LinearError> {
        self.scaled.system(&self.layout)
    }

    /// Returns `‖R r‖`: Euclidean norm of the residual in the row scales of the last [`BlockSystem::equilibrate`], over
    /// the unconstrained dofs (constrained rows of the residual are zero).
    pub fn row_norm(&self) -> f64 {
        let scale = self.scaled.scales().row();
        self.residual.iter().zip(scale).map(|(r, s)| (r * s).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns `‖C⁻¹ v‖`: Euclidean norm of a state or correction in the column scales of the last
    /// [`BlockSystem::equilibrate`], over the unconstrained dofs.
    pub fn column_norm(&self, v: &[f64]) -> f64 {
        let scale = self.scaled.scales().column();
        let free = v.iter().zip(scale).zip(&self.constrained).filter(|(_, constrained)| !**constrained);
        free.map(|((v, s), _)| (v / s).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the residual of the last assembly.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Returns whether a dof is constrained, for each dof.
    pub fn constrained(&self) -> &[bool] {
        &self.constrained
    }

    /// Returns whether every contribution is linear.
    pub fn is_linear(&self) -> bool {
        !self.has_nonlinear
    }

    /// Returns the wall-clock time for building the pattern, or for finding that it is unchanged.
    pub fn seconds_pattern(&self) -> f64 {
        self.seconds_pattern
    }

    /// Returns the times per contribution since the system was built.
    pub fn timings(&self) -> &[ContributionTiming] {
        &self.timings
    }
}
