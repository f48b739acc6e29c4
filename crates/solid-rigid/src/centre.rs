//! The unknowns of a rigid body as a site of weak forms.

use algebra::{BlockLayout, DofId, FieldId, Sites};
use mesh::Vector;

use crate::modes::{Spin, n_rotations};

/// Velocity of the centre and spin of a rigid body at the stage of the step: the site of
/// [`Momentum`](crate::terms::Momentum).
#[derive(Clone, Copy, Debug)]
pub struct RigidVelocity<const D: usize> {
    /// Velocity `V` of the centre, local rows from 0.
    pub velocity: Vector<D>,
    /// Spin `ω`, local rows from `D`.
    pub spin: Spin,
}

/// The unknowns of a rigid body in `D` dimensions: one item with one site.
#[derive(Clone, Copy)]
pub struct RigidCentre<'a, const D: usize> {
    /// The layout.
    pub layout: &'a BlockLayout,
    /// Field with one node: translations, then rotations.
    pub whole: FieldId,
}

impl<const D: usize> Sites for RigidCentre<'_, D> {
    type Site = RigidVelocity<D>;

    fn len(&self) -> usize {
        1
    }

    fn dofs(&self, _item: usize, out: &mut Vec<DofId>) {
        out.extend(self.layout.node(self.whole, 0));
    }

    fn visit(&self, _item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let whole = &x[self.layout.range(self.whole)];
        let mut spin = [0.0; 3];
        spin[..n_rotations(D)].copy_from_slice(&whole[D..]);
        visit(&RigidVelocity { velocity: Vector::from_column_slice(&whole[..D]), spin });
    }
}
