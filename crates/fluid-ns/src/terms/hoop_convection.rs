//! Hoop part of the skew convection of an axisymmetric flow.

use algebra::{LocalSystem, Term};
use mesh::{Tensor, Vector};

use crate::FluidCell;

/// Degree of quadrature: the radius in the weight cancels `1/r`, and three P1 functions remain.
const DEGREE: usize = 3;

/// `ρ^f/2 ((u_r/r) u, v)_{Ω^f}`: the part of `ρ^f/2 ((∇·u) u, v)` that the divergence in the half plane `(r, z)` does
/// not contain
///
/// Source: the skew part of [`Convection`](crate::terms::Convection) in cylindrical coordinates, without swirl.
/// Couples: velocity × velocity.   Domain: fluid parts of active cells; none in Cartesian coordinates.
/// Units: force of the whole circle.
/// At a quadrature point of weight w:
///   residual_i = w ρ/2 N_i (u_r/r) u,    tangent_ij = w ρ/2 N_i N_j ((u_r/r) I + u ⊗ e_r/r).
pub struct HoopConvection {
    /// Density `ρ^f`.
    pub density: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for HoopConvection {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some((radial, _)) = cell.hoop else { return };
        let has_tangent = out.has_tangent();
        cell.for_each_point(DEGREE, |x, weight, shape| {
            let u = cell.velocities.iter().zip(shape).fold(Vector::zeros(), |sum, (u, n)| sum + u * *n);
            let (weight, rate) = (0.5 * self.density * weight, u[radial] / x[radial]);
            let mut by_velocity = Tensor::<D>::from_diagonal_element(rate);
            for a in 0..D {
                by_velocity[(a, radial)] += u[a] / x[radial];
            }
            for i in 0..=D {
                out.add_vector::<D>(cell.velocity_row(i), u * (weight * shape[i] * rate));
                for j in (0..=D).filter(|_| has_tangent) {
                    let block = by_velocity * (weight * shape[i] * shape[j]);
                    out.add_block::<D, D>(cell.velocity_row(i), cell.velocity_row(j), block);
                }
            }
        });
    }
}
