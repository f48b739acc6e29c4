//! Hoop strain of an axisymmetric flow: the strain of circles around the axis.

use algebra::{LocalSystem, Term};

use crate::FluidCell;

/// `2 μ^f (u_r/r, v_r/r)_{Ω^f} - (p, v_r/r)_{Ω^f} + (q, u_r/r)_{Ω^f}`: the contributions of the entry `D_θθ(u) = u_r/r`
/// of the strain rate, which the gradient in the half plane `(r, z)` does not contain
///
/// Source: the forms `a^f` and `b` of the paper in cylindrical coordinates, without swirl.
/// Couples: radial velocity × radial velocity, radial velocity × pressure, pressure × radial velocity.
/// Domain: fluid parts of active cells; none in Cartesian coordinates.
/// Units: force and volume/time, of the whole circle.
/// With `k_ij = ∫ N_i N_j/r²`, `l_ij = ∫ N_i N_j/r` and the radial velocity `u_r` at the stage:
///   residual_i = 2 μ Σ_j k_ij u_rj - Σ_j l_ij p_j and Σ_j l_ij u_rj,    tangent_ij = 2 μ k_ij, -l_ij and l_ij.
pub struct Hoop {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Hoop {
    #[inline]
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some((radial, moments)) = cell.hoop else { return };
        let has_tangent = out.has_tangent();
        for i in 0..=D {
            let (row, pressure_row) = (cell.velocity_row(i) + radial, cell.pressure_row(i));
            for j in 0..=D {
                let viscous = 2.0 * self.viscosity * moments.by_square.at(i, j);
                let divergence = moments.by_radius.at(i, j);
                out.add(row, viscous * cell.velocities[j][radial] - divergence * cell.pressures[j]);
                out.add(pressure_row, divergence * cell.velocities[j][radial]);
                if !has_tangent {
                    continue;
                }
                out.add_tangent(row, cell.velocity_row(j) + radial, viscous);
                out.add_tangent(row, cell.pressure_row(j), -divergence);
                out.add_tangent(pressure_row, cell.velocity_row(j) + radial, divergence);
            }
        }
    }
}
