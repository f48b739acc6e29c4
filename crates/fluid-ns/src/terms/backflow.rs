//! Stabilisation of inflow through open boundaries.

use algebra::{LocalSystem, Term};
use mesh::Tensor;

use crate::OpenPoint;

/// `-ρ^f/2 (min(u*·n, 0) u, v)_Γ`: removes the kinetic energy of fluid that enters through an open boundary
///
/// Source: Bazilevs et al. 2009, DOI 10.1016/j.cma.2009.04.015; not in the paper, although fluid enters through its
/// open sides.
/// Couples: velocity × velocity.   Domain: wet pieces of open sides, with convection.
/// Units: force (2D: per unit depth).
pub struct Backflow {
    /// Density `ρ^f`.
    pub density: f64,
}

impl<const D: usize> Term<OpenPoint<'_, D>> for Backflow {
    fn add(&self, q: &OpenPoint<'_, D>, out: &mut LocalSystem) {
        let inflow = -0.5 * self.density * q.at.weight * q.known_velocity.dot(&q.at.normal).min(0.0);
        if inflow == 0.0 {
            return;
        }
        for i in 0..=D {
            out.add_vector::<D>(q.velocity_row(i), q.velocity * (inflow * q.at.shape[i]));
            for j in 0..=D {
                let block = Tensor::<D>::from_diagonal_element(inflow * q.at.shape[i] * q.at.shape[j]);
                out.add_block::<D, D>(q.velocity_row(i), q.velocity_row(j), block);
            }
        }
    }
}
