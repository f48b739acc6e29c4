//! The global residual and tangent of one nonlinear solve.

use std::time::Instant;

use crate::scatter::{Scatter, Target};
use crate::{BlockLayout, Constraints, Contributions, MatrixView, Pattern, Unknowns};

/// Time spent in one contribution, for reports only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContributionTiming {
    /// Name of the contribution.
    pub name: &'static str,
    /// Number of items.
    pub items: usize,
    /// How often all its items were evaluated and added.
    pub calls: usize,
    /// Wall-clock time of all calls.
    pub seconds: f64,
}

/// Layout, one sparse matrix and one residual.
///
/// Linear contributions are assembled once, when the system is built: their tangent `K` and their residual `r₀` at
/// x = 0. At a state x the system is then
///
/// `residual = K x + r₀ + Σ nonlinear residuals,    matrix = K + Σ nonlinear tangents`
///
/// with constrained rows and columns replaced by the identity and a zero residual. Blocks are the index ranges of the
/// layout, not separate matrices. The contributions handed to later calls must be those of the construction.
#[derive(Debug, Default)]
pub struct BlockSystem {
    layout: BlockLayout,
    pattern: Pattern,
    values: Vec<f64>,
    residual: Vec<f64>,
    linear_values: Vec<f64>,
    linear_residual: Vec<f64>,
    constrained: Vec<bool>,
    pub(crate) keys: Vec<u64>,
    has_nonlinear: bool,
    timings: Vec<ContributionTiming>,
    scatter: Scatter,
}

impl BlockSystem {
    /// Builds the pattern and assembles the linear contributions; matrix and residual are those at x = 0 without the
    /// nonlinear ones until [`BlockSystem::assemble`] is called.
    ///
    /// # Panics
    /// A contribution or a constraint names a dof outside of the layout.
    pub fn new(layout: &BlockLayout, contributions: &[&dyn Contributions], constraints: &Constraints) -> Self {
        Self::default().recycle(layout, contributions, constraints)
    }

    /// As [`BlockSystem::new`], in the memory of an old system of any size.
    pub fn recycle(
        mut self,
        layout: &BlockLayout,
        contributions: &[&dyn Contributions],
        constraints: &Constraints,
    ) -> Self {
        let n = layout.len();
        self.layout = layout.clone();
        self.keys.clear();
        self.pattern = self.pattern.recycle(n, contributions);
        self.constrained.clear();
        self.constrained.resize(n, false);
        for (dof, _) in constraints.iter() {
            assert!(dof.index() < n, "constrained dof {} of {n} unknowns", dof.index());
            self.constrained[dof.index()] = true;
        }
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

    /// Evaluates the linear contributions anew on the known pattern: for items whose dofs stayed what they were while
    /// their coefficients changed. Matrix and residual are those at x = 0 without the nonlinear ones.
    ///
    /// # Panics
    /// The contributions do not belong to this system.
    pub fn assemble_linear(&mut self, contributions: &[&dyn Contributions]) {
        let n = self.pattern.n_unknowns();
        self.residual.clear();
        self.residual.resize(n, 0.0);
        self.values.clear();
        self.values.resize(self.pattern.n_entries(), 0.0);
        let origin = vec![0.0; n];
        self.add(contributions, true, &origin, true);
        self.linear_values.clone_from(&self.values);
        self.linear_residual.clone_from(&self.residual);
        self.eliminate_rows();
        self.eliminate_matrix();
    }

    /// Evaluates residual and matrix at `x`, which satisfies the constraints.
    ///
    /// # Panics
    /// `x` or the contributions do not belong to this system.
    pub fn assemble(&mut self, contributions: &[&dyn Contributions], x: &[f64]) {
        self.start_residual(x);
        self.values.copy_from_slice(&self.linear_values);
        self.add(contributions, false, x, true);
        self.eliminate_rows();
        self.eliminate_matrix();
    }

    /// Evaluates only the residual at `x`; the matrix stays what it was.
    ///
    /// # Panics
    /// `x` or the contributions do not belong to this system.
    pub fn assemble_residual(&mut self, contributions: &[&dyn Contributions], x: &[f64]) {
        self.start_residual(x);
        self.add(contributions, false, x, false);
        self.eliminate_rows();
    }

    /// `residual = r₀ + K x`
    fn start_residual(&mut self, x: &[f64]) {
        assert_eq!(x.len(), self.pattern.n_unknowns(), "length of the state");
        self.residual.copy_from_slice(&self.linear_residual);
        let linear = view(&self.pattern, &self.linear_values);
        sprs::prod::mul_acc_mat_vec_csc(linear, x, self.residual.as_mut_slice());
    }

    /// Adds the linear or the nonlinear contributions.
    fn add(&mut self, contributions: &[&dyn Contributions], linear: bool, x: &[f64], with_tangent: bool) {
        assert_eq!(contributions.len(), self.timings.len(), "number of contributions");
        for (k, contribution) in contributions.iter().enumerate() {
            if contribution.is_linear() != linear || contribution.is_empty() {
                continue;
            }
            let map = self.pattern.map(k);
            assert_eq!(contribution.len(), map.len(), "items of {}", contribution.name());
            let start = Instant::now();
            let tangent = with_tangent.then_some(self.values.as_mut_slice());
            self.scatter.add(*contribution, &map, x, Target { residual: &mut self.residual, tangent });
            self.timings[k].calls += 1;
            self.timings[k].seconds += start.elapsed().as_secs_f64();
        }
    }

    fn eliminate_rows(&mut self) {
        for (value, constrained) in self.residual.iter_mut().zip(&self.constrained) {
            if *constrained {
                *value = 0.0;
            }
        }
    }

    fn eliminate_matrix(&mut self) {
        let ptr = self.pattern.column_ptr();
        for column in 0..self.pattern.n_unknowns() {
            let range = ptr[column] as usize..ptr[column + 1] as usize;
            let rows = &self.pattern.rows()[range.clone()];
            for (value, &row) in self.values[range].iter_mut().zip(rows) {
                if self.constrained[column] || self.constrained[row as usize] {
                    *value = if row as usize == column { 1.0 } else { 0.0 };
                }
            }
        }
    }

    /// The fields of the unknowns.
    pub fn layout(&self) -> &BlockLayout {
        &self.layout
    }

    /// Layout, nodes and keys of the unknowns, for linear solvers.
    pub fn unknowns(&self) -> Unknowns<'_> {
        Unknowns { layout: &self.layout, nodes: self.pattern.nodes(), keys: &self.keys }
    }

    /// The sparsity pattern.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The matrix of the last assembly.
    pub fn matrix(&self) -> MatrixView<'_> {
        view(&self.pattern, &self.values)
    }

    /// The residual of the last assembly.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Whether a dof is constrained, for each dof.
    pub fn constrained(&self) -> &[bool] {
        &self.constrained
    }

    /// Whether every contribution is linear.
    pub fn is_linear(&self) -> bool {
        !self.has_nonlinear
    }

    /// Times per contribution since the system was built.
    pub fn timings(&self) -> &[ContributionTiming] {
        &self.timings
    }
}

fn view<'a>(pattern: &'a Pattern, values: &'a [f64]) -> MatrixView<'a> {
    let n = pattern.n_unknowns();
    MatrixView::new_csc((n, n), pattern.column_ptr(), pattern.rows(), values)
}
