//! Incompressibility and its reaction, the pressure.

use algebra::{LocalSystem, Term};
use mesh::{MAX_CELL_VERTICES, Vector};

use crate::FluidCell;

/// `b(p, v) - b(q, u) = -(p, ∇·v)_{Ω^f} + (q, ∇·u)_{Ω^f}`
///
/// Source: paper, forms after Eq. (4).
/// Couples: velocity × pressure, pressure × velocity.   Domain: fluid parts of active cells.
/// Units: force and volume/time (2D: per unit depth).
/// With `g_i = ∇N_i`, `m_i = ∫ N_i`, and the velocity `u` at the stage:
///   residual_i = -g_i Σ_j m_j p_j and m_i ∇·u,    tangent_ij = -m_j g_i and m_i g_jᵀ.
pub struct Incompressibility;

impl<const D: usize> Term<FluidCell<'_, D>> for Incompressibility {
    #[inline]
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let g = cell.gradients;
        let m: [f64; MAX_CELL_VERTICES] = std::array::from_fn(|i| cell.moments.of(i));
        let divergence: f64 = (0..=D).map(|i| cell.velocities[i].dot(&g[i])).sum();
        let pressure: f64 = (0..=D).map(|j| m[j] * cell.pressures[j]).sum();
        for (i, g_i) in g[..=D].iter().enumerate() {
            out.add_vector::<D>(cell.velocity_row(i), g_i * -pressure);
            out.add(cell.pressure_row(i), m[i] * divergence);
        }
        if !out.has_tangent() {
            return;
        }
        for j in 0..=D {
            let (moment, g_j) = (m[j], g[j]);
            for (i, g_i) in g[..=D].iter().enumerate() {
                let column: Vector<D> = g_i * -moment;
                out.add_block::<D, 1>(cell.velocity_row(i), cell.pressure_row(j), column);
                out.add_block::<1, D>(cell.pressure_row(i), cell.velocity_row(j), (g_j * m[i]).transpose());
            }
        }
    }
}
