//! Incompressibility and its reaction, the pressure.

use algebra::LocalSystem;

use crate::{CellTerm, FluidCell};

/// `b(p, v) - b(q, u) = -(p, ∇·v)_{Ω^f} + (q, ∇·u)_{Ω^f}`
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × pressure, pressure × velocity.   Domain: fluid parts of active cells.
/// Units (cgs, per unit depth in 2D): residual dyn and cm²/s.
pub struct Incompressibility;

impl<const D: usize> CellTerm<D> for Incompressibility {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let divergence = cell.grad_u().trace();
        for q in cell.points() {
            for i in cell.nodes() {
                let g_i = cell.gradients[i] * q.weight;
                out.add_vector(cell.velocity(i), (g_i * -q.pressure).as_slice());
                out.add(cell.pressure(i), q.weight * q.shape[i] * divergence);
                for j in cell.nodes() {
                    for a in 0..D {
                        let coupling = g_i[a] * q.shape[j];
                        out.add_tangent(cell.velocity(i) + a, cell.pressure(j), -coupling);
                        out.add_tangent(cell.pressure(j), cell.velocity(i) + a, coupling);
                    }
                }
            }
        }
    }
}
