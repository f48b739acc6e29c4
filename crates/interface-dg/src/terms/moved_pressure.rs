//! Uniform pressure on the moved surface of a body that deforms.

use algebra::{LocalSystem, Term};

use crate::MovedPoint;

/// `p ∫_{Γ(d)} n·w - p ∫_{Γ*} n·w`: moves the uniform part `p` of the fluid's pressure from the surface `Γ*`, at which
/// the fluid is cut, to the surface `Γ(d)` at the stage of the step, where the body has its stress
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: velocities of the vertices of a facet.   Domain: the whole surface of a body that deforms.
/// Units: force (2D: per unit depth).
/// Without this term the stiffness of a large pressure acts on extrapolated positions, and the body vibrates with
/// growing amplitude from pressures of a tenth of Young's modulus on. A uniform pressure has no resultant on a closed
/// surface, so that the momentum of fluid and body is conserved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedPressure {
    /// Pressure `p`: the mean pressure on the surface in the step before.
    pub pressure: f64,
}

impl<const D: usize> Term<MovedPoint<D>> for MovedPressure {
    fn add(&self, point: &MovedPoint<D>, out: &mut LocalSystem) {
        for (k, shape) in point.shape.iter().enumerate() {
            let weight = self.pressure * shape;
            out.add_vector::<D>(point.row(k), point.change * weight);
            if out.has_tangent() {
                for (j, derivative) in point.by_velocity.iter().enumerate() {
                    out.add_block::<D, D>(point.row(k), point.row(j), derivative * weight);
                }
            }
        }
    }
}
