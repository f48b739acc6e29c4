//! Pressure on the moved surface of a body that deforms.

use algebra::{LocalSystem, Term};

use crate::MovedPoint;

/// `Σ_f p_f (∫_{f(d)} n·w - ∫_{f*} n·w)`: moves the pressure `p_f` of the fluid from the facets `f*`, at which the
/// fluid is cut, to the facets `f(d)` at the stage of the step, where the body has its stress
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: velocities of the vertices of a facet.   Domain: wet facets of bodies that deform.
/// Units: force (2D: per unit depth).
/// `p_f` is the mean pressure on the facet in the step before. Without this term the stiffness of a large pressure acts
/// on extrapolated positions, and the body vibrates with growing amplitude from pressures of a tenth of Young's modulus
/// on. The fluid has no row: the term is a correction of second order in the step to the traction on the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovedPressure;

impl<const D: usize> Term<MovedPoint<D>> for MovedPressure {
    fn add(&self, point: &MovedPoint<D>, out: &mut LocalSystem) {
        for (k, shape) in point.shape.iter().enumerate() {
            let weight = point.pressure * shape;
            out.add_vector::<D>(point.row(k), point.change * weight);
            if out.has_tangent() {
                for (j, derivative) in point.by_velocity.iter().enumerate() {
                    out.add_block::<D, D>(point.row(k), point.row(j), derivative * weight);
                }
            }
        }
    }
}
