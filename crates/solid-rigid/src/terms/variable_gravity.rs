//! Weight of a rigid body in a gravity that varies in time.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::RigidVelocity;

/// `-M g(t) · W`, with the velocity `W` of the centre as test function
///
/// Source: Newton's law of motion. In a frame of reference with the acceleration `a(t)` there is an additional gravity
/// `-a(t)`.
/// Couples: velocity.   Domain: the body.
/// Units: force (2D: per unit depth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableGravity<const D: usize> {
    /// Force `M g` at the stage.
    pub force: Vector<D>,
}

impl<const D: usize> Term<RigidVelocity<D>> for VariableGravity<D> {
    fn add(&self, _: &RigidVelocity<D>, out: &mut LocalSystem) {
        out.add_vector::<D>(0, -self.force);
    }
}
