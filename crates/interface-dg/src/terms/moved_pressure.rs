//! Pressure on the surface of the elements of a body, in place of the plane facets of the cut.

use algebra::{LocalSystem, Term};

use crate::MovedPoint;
use crate::moved_facet::row;

/// `α (∫_{Γ(d)} p n·w - ∫_Σ p n·w)`: moves the pressure `p` of the fluid from the plane facets `Σ`, at which the fluid
/// is cut, to the same points of the body on its elements, `Γ(d)`
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: velocity of the surface × velocity of the surface, pressure.   Domain: interface pieces of bodies that
/// deform.
/// Units: force (2D: per unit depth).
/// `Γ(d)` is at the stage of the step, where the stress of the body is evaluated; with implicit Euler it is at the
/// positions of the cut, and the term is zero for elements of order 1. A point of `Γ(d)` has the pressure at its place
/// on the element at the positions of the cut. Without this term a large pressure acts on positions that are
/// extrapolated, or those of the start: the force does not depend on the unknown positions, and the body vibrates with
/// growing amplitude from pressures of a tenth of Young's modulus on. The fluid has no row: the term corrects the
/// traction on the body by the distance between the two surfaces. It is of second order in the step if positions are
/// extrapolated, of first order with quasi-static steps, and of second order in the size of curved elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovedPressure;

impl<const D: usize> Term<MovedPoint<D>> for MovedPressure {
    fn add(&self, point: &MovedPoint<D>, out: &mut LocalSystem) {
        for (k, shape) in point.shape[..point.n_nodes].iter().enumerate() {
            out.add_vector::<D>(row::<D>(k), point.load * *shape);
            if out.has_tangent() {
                for (j, derivative) in point.by_velocity[..point.n_nodes].iter().enumerate() {
                    out.add_block::<D, D>(row::<D>(k), row::<D>(j), derivative * *shape);
                }
                for (j, derivative) in point.by_pressure[..=D].iter().enumerate() {
                    out.add_block::<D, 1>(row::<D>(k), row::<D>(point.n_nodes) + j, derivative * *shape);
                }
            }
        }
    }
}
