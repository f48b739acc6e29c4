//! Pressure on the moved surface of a body that deforms.

use algebra::{LocalSystem, Term};

use crate::MovedPoint;

/// `α (∫_{Σ(d)} p n·w - ∫_{Σ*} p n·w)`: moves the pressure `p` of the fluid from the wet surface `Σ*`, at which the
/// fluid is cut, to `Σ(d)`, the same points of the body at the stage of the step, where the body has its stress
///
/// Source: follower load; Bonet, Wood 1997, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.5.
/// Couples: velocity of the surface × velocity of the surface, pressure.   Domain: interface pieces of bodies that
/// deform.
/// Units: force (2D: per unit depth).
/// A point of the body has the pressure of the point of the cut where it is assumed. Without this term the stiffness of
/// a large pressure acts on extrapolated positions, and the body vibrates with growing amplitude from pressures of a
/// tenth of Young's modulus on. The fluid has no row: the term is a correction of second order in the step to the
/// traction on the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovedPressure;

impl<const D: usize> Term<MovedPoint<D>> for MovedPressure {
    fn add(&self, point: &MovedPoint<D>, out: &mut LocalSystem) {
        for (k, shape) in point.shape[..point.n_nodes].iter().enumerate() {
            let weight = point.pressure * shape;
            out.add_vector::<D>(point.row(k), point.change * weight);
            if out.has_tangent() {
                for (vertex, derivative) in point.vertices.iter().zip(&point.by_velocity) {
                    out.add_block::<D, D>(point.row(k), point.row(*vertex), derivative * weight);
                }
                for (j, derivative) in point.by_pressure[..=D].iter().enumerate() {
                    out.add_block::<D, 1>(
                        point.row(k),
                        point.row(point.n_nodes) + j,
                        point.change * (shape * derivative),
                    );
                }
            }
        }
    }
}
