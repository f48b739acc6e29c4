//! Penalty on the velocity jump.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::MortarPoint;

/// `γ_Σ μ^f/h_K (u - v_s, v - w)_Σ`, with `h_K` the size of the background cell
///
/// Source: paper, Eq. (4).
/// Couples: velocity and solid × velocity and solid.   Domain: interface pieces of the step.
/// Units: force (2D: per unit depth).
pub struct Penalty {
    /// `γ_Σ`.
    pub gamma_sigma: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl Penalty {
    /// Returns the traction on the body per velocity jump, `γ_Σ μ^f/h_K`.
    pub(crate) fn coefficient<const D: usize>(&self, q: &MortarPoint<'_, D>) -> f64 {
        self.gamma_sigma * self.viscosity / q.cell_size
    }
}

impl<const D: usize> Term<MortarPoint<'_, D>> for Penalty {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let weight = q.at.weight * self.coefficient(q);
        for (row, test) in q.jump_basis() {
            out.add_vector::<D>(row, q.jump * (weight * test));
            for (column, trial) in q.jump_basis() {
                let block = Tensor::<D>::from_diagonal_element(weight * test * trial);
                out.add_block::<D, D>(row, column, block);
            }
        }
    }
}
