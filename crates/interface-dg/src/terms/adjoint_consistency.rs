//! The adjoint of the traction tests the velocity jump.

use algebra::LocalSystem;

use crate::piece_values::MortarPoint;

/// `-(u - v_s, T^f(v, -q) n^f)_Σ`; note `-q`, so that the pressure part is skew.
///
/// Source: paper, Eq. (4), α = 1.
/// Couples: velocity and pressure × velocity and solid.   Domain: interface pieces of the step.
/// Units (cgs, per unit depth in 2D): residual dyn and cm²/s.
/// test v_i e_a: μ ( (g_i·n^f) e_a + n^f_a g_i ), test q_i: +N_i n^f.
pub struct AdjointConsistency {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl AdjointConsistency {
    /// Adds the term at one point.
    pub(crate) fn add<const D: usize>(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let n = q.fluid_normal();
        let weight = -q.at.weight;
        for i in 0..=D {
            let g = q.gradients[i];
            let along = g.dot(&n);
            let jump_along = q.jump.dot(&g);
            for a in 0..D {
                out.add(D * i + a, weight * self.viscosity * (along * q.jump[a] + n[a] * jump_along));
            }
            out.add(q.pressure_row(i), weight * q.at.fluid[i] * q.jump.dot(&n));
            for (column, basis) in q.jump_basis() {
                for a in 0..D {
                    out.add_tangent(D * i + a, column + a, weight * self.viscosity * along * basis);
                    for b in 0..D {
                        out.add_tangent(D * i + a, column + b, weight * self.viscosity * n[a] * g[b] * basis);
                    }
                    out.add_tangent(q.pressure_row(i), column + a, weight * q.at.fluid[i] * n[a] * basis);
                }
            }
        }
    }
}
