//! Inertia of the solid.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::SolidCell;

/// `(ρ^s a, w)_{Ω̂^s}`, `a = c_a v - a_pred`; implicit Euler: `ρ^s/Δt (v - v^n, w)`
///
/// Source: paper, fully discrete problem after Eq. (4), with velocity as the unknown.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
/// With the consistent mass `m_ij = ∫ N_i N_j = |K| (1 + δ_ij)/((D + 1)(D + 2))` (P1):
///   residual_i = ρ Σ_j m_ij a_j,    tangent_ij = ρ c_a m_ij I.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Density in the reference configuration.
    pub density: f64,
}

impl<const D: usize> Term<SolidCell<'_, D>> for Inertia {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let off_diagonal = self.density * cell.volume / ((D + 1) * (D + 2)) as f64;
        for i in cell.nodes() {
            for j in cell.nodes() {
                let mass = if i == j { 2.0 * off_diagonal } else { off_diagonal };
                cell.add(i, mass * cell.acceleration[j], out);
                let k = Tensor::<D>::identity() * (mass * cell.acceleration_slope);
                out.add_block::<D, D>(cell.row(i), cell.row(j), k);
            }
        }
    }
}
