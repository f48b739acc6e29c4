//! Inertia of the solid.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::SolidCell;
use crate::cell::row;

/// `(ρ^s a, w)_{Ω̂^s}`, `a = c_a v - a_pred`; implicit Euler: `ρ^s/Δt (v - v^n, w)`
///
/// Source: paper, fully discrete problem after Eq. (4), with velocity as the unknown.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
/// With the consistent mass `m_ij = ∫ N_i N_j`:
///   residual_i = ρ Σ_j m_ij a_j,    tangent_ij = ρ c_a m_ij I.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Density in the reference configuration.
    pub density: f64,
}

impl<const D: usize> Term<SolidCell<'_, D>> for Inertia {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        for i in cell.nodes() {
            for (j, mass) in cell.mass_of(i).iter().enumerate() {
                let mass = self.density * mass;
                out.add_vector::<D>(row::<D>(i), mass * cell.acceleration[j]);
                let k = Tensor::<D>::identity() * (mass * cell.acceleration_slope);
                out.add_block::<D, D>(row::<D>(i), row::<D>(j), k);
            }
        }
    }
}
