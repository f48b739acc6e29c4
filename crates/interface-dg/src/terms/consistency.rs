//! Consistency of the mortar: one traction acts on fluid and solid.

use algebra::{LocalSystem, Term};
use fluid_ns::NewtonianFluid;

use crate::MortarPoint;

/// `-(α T^f(u, p) n^f + (1 - α) T^s(d) n^f, v - w)_Σ`, with `T^f = -p I + 2 μ D(u)`
///
/// Source: paper, Eq. (4).
/// Couples: velocity and solid × velocity, pressure and, for α < 1, solid.   Domain: interface pieces of the step.
/// Units: force (2D: per unit depth).
/// Derivative of the traction with respect to `u_j`: `μ ( (g_j·n^f) I + g_j ⊗ n^f )`, with respect to `p_j`:
/// `-N_j n^f`.
pub struct Consistency {
    /// The fluid.
    pub fluid: NewtonianFluid,
}

impl<const D: usize> Term<MortarPoint<'_, D>> for Consistency {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let n = q.fluid_normal();
        for (row, basis) in q.jump_basis() {
            let weight = -q.at.weight * basis;
            out.add_vector::<D>(row, q.shared_traction() * weight);
            if !out.has_tangent() {
                continue;
            }
            let of_fluid = weight * q.alpha;
            for j in 0..=D {
                let by_velocity = self.fluid.viscous_traction_by_velocity(&q.gradients[j], &n);
                out.add_block::<D, D>(row, q.velocity_row(j), by_velocity * of_fluid);
                out.add_block::<D, 1>(row, q.pressure_row(j), n * (-of_fluid * q.at.fluid[j]));
            }
            if let Some(solid) = &q.solid {
                for (column, by_velocity) in &solid.derivatives {
                    out.add_block::<D, 1>(row, *column, by_velocity * (weight * solid.weight));
                }
            }
        }
    }
}
