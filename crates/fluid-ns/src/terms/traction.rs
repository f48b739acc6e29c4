//! Traction given on open boundaries.

use algebra::LocalSystem;
use mesh::{Point, Vector};

use crate::open_boundary::{BoundaryTerm, OpenPoint};

/// `-(t, v)_Γ` with the traction `t = T^f n` given.
///
/// Source: natural boundary condition of Eq. (4); the paper has `t = 0`.
/// Couples: velocity.   Domain: wet pieces of the open boundary.
/// Units (cgs, per unit depth in 2D): residual dyn.
pub struct Traction<'a, const D: usize> {
    /// Traction at a point, given the outward normal, at a time; `None` for no traction.
    #[allow(clippy::type_complexity)]
    pub traction: Option<&'a (dyn Fn(&Point<D>, &Vector<D>, f64) -> Vector<D> + Send + Sync)>,
    /// Time.
    pub time: f64,
}

impl<const D: usize> BoundaryTerm<D> for Traction<'_, D> {
    fn add(&self, q: &OpenPoint<'_, D>, out: &mut LocalSystem) {
        let Some(traction) = self.traction else { return };
        let t = traction(&q.at.point, &q.at.normal, self.time) * q.at.weight;
        for i in 0..=D {
            out.add_vector(D * i, (t * -q.at.shape[i]).as_slice());
        }
    }
}
