//! Body force on the solid.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::SolidCell;
use crate::cell::row;

/// `-(ρ^s f^s, w)_{Ω̂^s}`, with `f^s` an acceleration (gravity)
///
/// Source: paper, Eq. (4), right-hand side; `f^s` is an acceleration, so the load is `ρ^s f^s`.
/// Couples: solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
///   residual_i = -ρ ∫ N_i f^s,    ∫ N_i = Σ_j m_ij,    tangent = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyForce<const D: usize> {
    /// Density of each group of cells in the reference configuration.
    pub densities: Vec<f64>,
    /// Acceleration `f^s`.
    pub acceleration: Vector<D>,
}

impl<const D: usize> Term<SolidCell<'_, D>> for BodyForce<D> {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let load = self.acceleration * -self.densities[cell.group];
        for i in cell.nodes() {
            let volume: f64 = cell.mass_of(i).iter().sum();
            out.add_vector::<D>(row::<D>(i), load * volume);
        }
    }
}
