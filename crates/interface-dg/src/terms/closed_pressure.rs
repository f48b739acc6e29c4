//! Pressure on the closed part of a surface.

use algebra::{LocalSystem, Term};

use crate::ClosedPoint;
use crate::moved_facet::row;

/// `(p n, w)` on the closed part of the surface of a body, with the pressure `p` at its rim, continued as in fluid at
/// rest
///
/// Source: Ager, Schott, Vuong, Popp, Wall 2019, doi:10.1002/nme.6094, who continue stresses of the fluid into the
/// contact zone.
/// Couples: velocity of the surface × velocity of the surface, pressure.   Domain: facets of the body without their
/// interface pieces.
/// Units: force (2D: per unit depth).
/// The fluid has no row: it has no volume between surfaces in contact. The pressure `p` is defined by
/// [`crate::FluidStress`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClosedPressure;

impl<const D: usize> Term<ClosedPoint<D>> for ClosedPressure {
    fn add(&self, point: &ClosedPoint<D>, out: &mut LocalSystem) {
        for (k, shape) in point.shape[..point.n_nodes].iter().enumerate() {
            out.add_vector::<D>(row::<D>(k), point.force * -shape);
            if out.has_tangent() {
                for (j, derivative) in point.by_velocity[..point.n_nodes].iter().enumerate() {
                    out.add_block::<D, D>(row::<D>(k), row::<D>(j), derivative * -shape);
                }
                for (q, derivative) in point.by_pressure.iter().enumerate() {
                    out.add_block::<D, 1>(row::<D>(k), row::<D>(point.n_nodes) + q, derivative * -shape);
                }
            }
        }
    }
}
