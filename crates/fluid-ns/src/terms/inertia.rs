//! Inertia of the fluid.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::FluidCell;

/// `ρ^f (a, v)_{Ω^f}`; implicit Euler: `ρ^f/Δt (u - u*, v)`, `u*` the previous velocity on the new space
///
/// Source: paper, fully discrete form after Eq. (11).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units: force (2D: per unit depth).
/// With `m_ij = ∫ N_i N_j`, the acceleration `a` at the stage and its derivative `s` with respect to the velocity:
///   residual_i = ρ Σ_j m_ij a_j,    tangent_ij = s ρ m_ij I.
pub struct Inertia {
    /// Density `ρ^f`.
    pub density: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Inertia {
    #[inline]
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        for i in 0..=D {
            let force = cell.moments.weighted(i, &cell.accelerations) * self.density;
            out.add_vector::<D>(cell.velocity_row(i), force);
        }
        if !out.has_tangent() {
            return;
        }
        let weight = self.density * cell.acceleration_slope;
        for j in 0..=D {
            for i in 0..=D {
                let block = Tensor::<D>::from_diagonal_element(weight * cell.moments.at(i, j));
                out.add_block::<D, D>(cell.velocity_row(i), cell.velocity_row(j), block);
            }
        }
    }
}
