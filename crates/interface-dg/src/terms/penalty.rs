//! Penalty on the velocity jump.

use algebra::LocalSystem;

use crate::piece_values::MortarPoint;

/// `γ_Σ μ^f/h_K (u - v_s, v - w)_Σ`, with `h_K` the size of the background cell.
///
/// Source: paper, Eq. (4).
/// Couples: velocity and solid × velocity and solid.   Domain: interface pieces of the step.
/// Units (cgs, per unit depth in 2D): residual dyn, tangent dyn·s/cm.
pub struct Penalty {
    /// `γ_Σ`.
    pub gamma_sigma: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl Penalty {
    /// Adds the term at one point.
    pub(crate) fn add<const D: usize>(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let weight = q.at.weight * self.gamma_sigma * self.viscosity / q.cell_size;
        for (row, test) in q.jump_basis() {
            out.add_vector(row, (q.jump * (weight * test)).as_slice());
            for (column, trial) in q.jump_basis() {
                for a in 0..D {
                    out.add_tangent(row + a, column + a, weight * test * trial);
                }
            }
        }
    }
}
