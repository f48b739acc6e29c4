//! The fluid's traction acts on fluid and solid alike.

use algebra::LocalSystem;

use crate::piece_values::MortarPoint;

/// `-(T^f(u, p) n^f, v - w)_Σ`, with `T^f = -p I + 2 μ D(u)`.
///
/// Source: paper, Eq. (4), α = 1.
/// Couples: velocity and solid × velocity and pressure.   Domain: interface pieces of the step.
/// Units (cgs, per unit depth in 2D): residual dyn.
/// tangent for u_j e_b: μ ( (g_j·n^f) e_b + n^f_b g_j ), for p_j: -N_j n^f.
pub struct Consistency {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl Consistency {
    /// Adds the term at one point.
    pub(crate) fn add<const D: usize>(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let n = q.fluid_normal();
        for (row, basis) in q.jump_basis() {
            let weight = -q.at.weight * basis;
            out.add_vector(row, (q.traction * weight).as_slice());
            for j in 0..=D {
                let g = q.gradients[j];
                let along = g.dot(&n);
                for b in 0..D {
                    out.add_tangent(row + b, D * j + b, weight * self.viscosity * along);
                    for a in 0..D {
                        out.add_tangent(row + a, D * j + b, weight * self.viscosity * n[b] * g[a]);
                    }
                    out.add_tangent(row + b, q.pressure_row(j), -weight * q.at.fluid[j] * n[b]);
                }
            }
        }
    }
}
