//! Inertia of the fluid.

use algebra::LocalSystem;

use crate::{CellTerm, FluidCell};

/// `ρ^f/dt (u - u*, v)_{Ω^f}`
///
/// Source: paper, fully discrete form after Eq. (11).
/// Couples: velocity × velocity.   Domain: fluid parts of active cells.
/// Units (cgs, per unit depth in 2D): residual dyn, tangent dyn·s/cm.
pub struct Inertia {
    /// Density `ρ^f`.
    pub density: f64,
    /// Time step.
    pub dt: f64,
}

impl<const D: usize> CellTerm<D> for Inertia {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let rate = self.density / self.dt;
        for q in cell.points() {
            let change = (q.velocity - q.history) * (rate * q.weight);
            for i in cell.nodes() {
                out.add_vector(cell.velocity(i), (change * q.shape[i]).as_slice());
                for j in cell.nodes() {
                    let mass = rate * q.weight * q.shape[i] * q.shape[j];
                    for a in 0..D {
                        out.add_tangent(cell.velocity(i) + a, cell.velocity(j) + a, mass);
                    }
                }
            }
        }
    }
}
