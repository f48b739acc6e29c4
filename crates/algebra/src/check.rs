//! Finite-difference check of tangents, for tests of any [`Contributions`].

use std::collections::BTreeSet;

use crate::{Contributions, DofId, LocalSystem};

/// Returns the larger deviation; NaN is treated as infinite.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// The entry of a tangent that deviates most from its finite difference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentDeviation {
    /// `|tangent − difference|`, less the bound of round-off, relative to the smaller one of the largest entries
    /// of the row and of the column; infinite if both are zero but the difference is not.
    pub relative: f64,
    /// Item of the entry.
    pub item: usize,
    /// Local row of the entry.
    pub row: usize,
    /// Local column of the entry. It is the number of columns if the residual of a linear contribution is not linear.
    pub column: usize,
}

/// Compares the tangents of all items at `x` with central differences and returns the worst relative deviation.
///
/// Unknown `j` is moved by `±step (1 + |x_j|)`; 1e-6 to 1e-5 is a good step for smooth residuals. For linear
/// contributions `residual(x) = tangent x + residual(0)` is checked too. [`worst_tangent_entry`] returns the place of
/// the worst entry.
///
/// # Panics
/// An item has a dof twice.
pub fn check_tangent(contribution: &dyn Contributions, x: &[f64], step: f64) -> f64 {
    worst_tangent_entry(contribution, 0..contribution.len(), x, step).relative
}

/// Checks some items as [`check_tangent`] does, and returns the place of the largest deviation.
///
/// # Panics
/// An item has a dof twice.
pub fn worst_tangent_entry(
    contribution: &dyn Contributions,
    items: impl IntoIterator<Item = usize>,
    x: &[f64],
    step: f64,
) -> TangentDeviation {
    let mut worst = TangentDeviation::default();
    let mut moved = x.to_vec();
    let origin = vec![0.0; x.len()];
    let mut dofs = Vec::new();
    let [mut at_x, mut above, mut below] = [(); 3].map(|()| LocalSystem::new());
    let evaluate = |item: usize, x: &[f64], n: usize, out: &mut LocalSystem| {
        out.reset(n);
        contribution.add(item, x, out);
    };
    for item in items {
        dofs.clear();
        contribution.dofs(item, &mut dofs);
        let n = dofs.len();
        let distinct: BTreeSet<DofId> = dofs.iter().copied().collect();
        assert_eq!(distinct.len(), n, "{} item {item}: a dof occurs twice", contribution.name());
        evaluate(item, x, n, &mut at_x);
        let magnitudes = Magnitudes::new(&at_x, &dofs, x);
        let mut compare = |row: usize, column: usize, error: f64, noise: f64, scale: f64| {
            let relative = if error <= noise { 0.0 } else { (error - noise) / scale };
            if relative > worst.relative || (relative.is_nan() && !worst.relative.is_nan()) {
                worst = TangentDeviation { relative, item, row, column };
            }
        };
        for (column, dof) in dofs.iter().enumerate() {
            let h = step * (1.0 + x[dof.index()].abs());
            moved[dof.index()] = x[dof.index()] + h;
            evaluate(item, &moved, n, &mut above);
            moved[dof.index()] = x[dof.index()] - h;
            evaluate(item, &moved, n, &mut below);
            moved[dof.index()] = x[dof.index()];
            for row in 0..n {
                let difference = (above.residual()[row] - below.residual()[row]) / (2.0 * h);
                let error = (at_x.tangent_at(row, column) - difference).abs();
                compare(
                    row,
                    column,
                    error,
                    magnitudes.round_off[row] / h,
                    magnitudes.row[row].min(magnitudes.column[column]),
                );
            }
        }
        if contribution.is_linear() {
            evaluate(item, &origin, n, &mut above);
            for row in 0..n {
                let product: f64 = dofs.iter().enumerate().map(|(j, d)| at_x.tangent_at(row, j) * x[d.index()]).sum();
                let error = (at_x.residual()[row] - above.residual()[row] - product).abs();
                compare(row, n, error, magnitudes.round_off[row], magnitudes.terms[row]);
            }
        }
    }
    worst
}

/// Magnitudes of a local system, to which deviations are compared.
struct Magnitudes {
    row: Vec<f64>,
    column: Vec<f64>,
    /// `Σ |tangent_ij x_j| + |residual_i|`
    terms: Vec<f64>,
    /// Bound of the round-off error of the residual.
    round_off: Vec<f64>,
}

impl Magnitudes {
    fn new(system: &LocalSystem, dofs: &[DofId], x: &[f64]) -> Self {
        let n = system.len();
        let entry = |i: usize, j: usize| system.tangent_at(i, j).abs();
        let terms: Vec<f64> = (0..n)
            .map(|i| system.residual()[i].abs() + (0..n).map(|j| entry(i, j) * x[dofs[j].index()].abs()).sum::<f64>())
            .collect();
        Self {
            row: (0..n).map(|i| (0..n).map(|j| entry(i, j)).fold(0.0, f64::max)).collect(),
            column: (0..n).map(|j| (0..n).map(|i| entry(i, j)).fold(0.0, f64::max)).collect(),
            round_off: terms.iter().map(|t| 16.0 * f64::EPSILON * t).collect(),
            terms,
        }
    }
}
