//! Inertia of the solid.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::SolidCell;
use crate::cell::row;

/// `(ρ^s a, w)_{Ω̂^s}`, `a = a_pred + c_a v`; implicit Euler: `ρ^s/Δt (v - v^n, w)`
///
/// Source: paper, fully discrete problem after Eq. (4), with velocity as the unknown.
/// Couples: solid velocity × solid velocity.   Domain: reference cells.
/// Units: force (2D: per unit depth).
/// With the mass `m_ij = ∫ N_i N_j` of the cell, or the redistributed mass:
///   residual_i = ρ Σ_j m_ij a_j,    tangent_ij = ρ c_a m_ij I.
#[derive(Clone, Debug, PartialEq)]
pub struct Inertia {
    /// Density of each group of cells in the reference configuration.
    pub densities: Vec<f64>,
}

impl<const D: usize> Term<SolidCell<'_, D>> for Inertia {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let density = self.densities[cell.group];
        for i in cell.nodes() {
            let mut force = Vector::zeros();
            for (j, mass) in cell.mass_of(i).iter().enumerate() {
                let mass = density * mass;
                force += mass * cell.acceleration[j];
                let slope = mass * cell.acceleration_slope;
                (0..D).for_each(|a| out.add_tangent(row::<D>(i) + a, row::<D>(j) + a, slope));
            }
            out.add_vector::<D>(row::<D>(i), force);
        }
    }
}
