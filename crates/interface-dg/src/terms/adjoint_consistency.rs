//! Adjoint consistency of the mortar: the traction of the test functions on the velocity jump.

use algebra::{LocalSystem, Term};
use fluid_ns::NewtonianFluid;

use crate::MortarPoint;

/// `-(u - v_s, α T^f(v, -q) n^f + (1 - α) T^s(w) n^f)_Σ`; note `-q`, so that the pressure part is skew
///
/// Source: paper, Eq. (4). The unknown of the solid is its velocity at the stage: `T^s(w)` is the derivative of its
/// traction with respect to this velocity in the direction `w`, at the starting guess of the step.
/// Couples: velocity, pressure and, for α < 1, solid × velocity and solid.   Domain: interface pieces of the step.
/// Units: force and volume/time (2D: per unit depth).
/// Test `v_i e_a`: `μ ( (g_i·n^f) e_a + n^f_a g_i )`, test `q_i`: `+N_i n^f`.
pub struct AdjointConsistency {
    /// The fluid.
    pub fluid: NewtonianFluid,
}

impl<const D: usize> Term<MortarPoint<'_, D>> for AdjointConsistency {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let n = q.fluid_normal();
        let weight = -q.at.weight * q.alpha;
        for i in 0..=D {
            let test = self.fluid.viscous_traction_by_velocity(&q.gradients[i], &n).transpose();
            out.add_vector::<D>(q.velocity_row(i), test * q.jump * weight);
            out.add(q.pressure_row(i), weight * q.at.fluid[i] * q.jump.dot(&n));
            if !out.has_tangent() {
                continue;
            }
            for (column, basis) in q.jump_basis() {
                out.add_block::<D, D>(q.velocity_row(i), column, test * (weight * basis));
                let row = n.transpose() * (weight * q.at.fluid[i] * basis);
                out.add_block::<1, D>(q.pressure_row(i), column, row);
            }
        }
        if let Some(solid) = &q.solid {
            for (row, test) in &solid.adjoint {
                let test = test * (-q.at.weight * solid.weight);
                out.add(*row, test.dot(&q.jump));
                if !out.has_tangent() {
                    continue;
                }
                for (column, basis) in q.jump_basis() {
                    out.add_block::<1, D>(*row, column, test.transpose() * basis);
                }
            }
        }
    }
}
