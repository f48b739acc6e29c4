//! Traction given on open boundaries.

use algebra::{LocalSystem, Term};

use super::TractionFunction;
use crate::OpenPoint;

/// `-(t, v)_Γ` with the traction `t = T^f n` given
///
/// Source: natural boundary condition of Eq. (4); the paper has `t = 0`.
/// Couples: velocity.   Domain: wet pieces of the open boundary.
/// Units: force (2D: per unit depth).
pub struct Traction<'a, const D: usize> {
    /// Traction at a point, given the outward normal, at a time.
    pub traction: TractionFunction<'a, D>,
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> Term<OpenPoint<'_, D>> for Traction<'_, D> {
    fn add(&self, q: &OpenPoint<'_, D>, out: &mut LocalSystem) {
        let t = (self.traction)(&q.at.point, &q.at.normal, self.time) * q.at.weight;
        (0..=D).for_each(|i| out.add_vector::<D>(q.velocity_row(i), t * -q.at.shape[i]));
    }
}
