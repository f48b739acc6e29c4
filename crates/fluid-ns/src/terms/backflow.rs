//! Stabilisation of inflow through open boundaries.

use algebra::LocalSystem;

use crate::open_boundary::{BoundaryTerm, OpenPoint};

/// `-ρ^f/2 (min(u*·n, 0) u, v)_Γ`: takes the kinetic energy out of fluid that enters through an open boundary.
///
/// Source: Bazilevs et al. 2009, DOI 10.1016/j.cma.2009.04.015; not in the paper, whose open sides see inflow.
/// Couples: velocity × velocity.   Domain: wet pieces of the zero-traction boundary.
/// Units (cgs, per unit depth in 2D): residual dyn, tangent dyn·s/cm.
pub struct Backflow {
    /// Density `ρ^f`.
    pub density: f64,
}

impl<const D: usize> BoundaryTerm<D> for Backflow {
    fn add(&self, q: &OpenPoint<'_, D>, out: &mut LocalSystem) {
        let inflow = -0.5 * self.density * q.at.weight * q.history.dot(&q.at.normal).min(0.0);
        if inflow == 0.0 {
            return;
        }
        for i in 0..=D {
            out.add_vector(D * i, (q.velocity * (inflow * q.at.shape[i])).as_slice());
            for j in 0..=D {
                for a in 0..D {
                    out.add_tangent(D * i + a, D * j + a, inflow * q.at.shape[i] * q.at.shape[j]);
                }
            }
        }
    }
}
