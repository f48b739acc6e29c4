//! Stability of the mortar with a share of the solid in its traction.

use mesh::BodyId;

use crate::InterfacePoints;
use crate::terms::Penalty;

/// A piece of the interface on which the penalty is too small for the share of the solid. Units of the penalty:
/// force·time per volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnstableShare {
    /// The body.
    pub body: BodyId,
    /// Smaller eigenvalue of the penalty `S`.
    pub penalty: f64,
    /// Smallest penalty for which the mortar is stable.
    pub required: f64,
}

/// Returns the first piece on which the mortar may be unstable, for small strains.
///
/// The mortar is stable if viscosity, elasticity and penalty bound the work of its traction on the jump. The penalty
/// that a traction requires grows with the square of its weight. If `σ` suffices for the traction of the fluid alone,
/// its share with the weight `α` requires `α² σ`. The share of the solid requires `(1 - α)²` times
/// [`body::SurfaceStress::trace_bound`], which must not exceed the rest `(1 - α²) σ`.
pub fn unstable_share<const D: usize>(points: &InterfacePoints<'_, D>, penalty: &Penalty) -> Option<UnstableShare> {
    let (solid, values) = (points.solid.as_ref()?, points.values);
    points.geometry.cut.interface().iter().enumerate().find_map(|(item, piece)| {
        let bound = solid.stresses[piece.body.index()].as_ref()?.trace_bound(piece.facet);
        let required = bound * (1.0 - solid.alpha) / (1.0 + solid.alpha);
        let (sizes, speed) = ([values.cell_size(item), values.viscous_length(item)], values.relative_speed(item));
        let [normal, tangential] = penalty.eigenvalues(sizes, speed, values.relative_acceleration(item));
        let penalty = normal.min(tangential);
        (penalty < required).then_some(UnstableShare { body: piece.body, penalty, required })
    })
}
