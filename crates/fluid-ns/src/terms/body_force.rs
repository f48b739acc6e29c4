//! Body force on the fluid.

use algebra::LocalSystem;
use mesh::{Point, Vector};

use crate::{CellTerm, FluidCell};

/// `-(f^f, v)_{Ω^f}`, force per volume.
///
/// Source: paper, right side of Eq. (4).
/// Couples: velocity.   Domain: fluid parts of active cells.
/// Units (cgs, per unit depth in 2D): residual dyn.
pub struct BodyForce<'a, const D: usize> {
    /// Force per volume at a point and time; `None` for no force.
    #[allow(clippy::type_complexity)]
    pub force: Option<&'a (dyn Fn(&Point<D>, f64) -> Vector<D> + Send + Sync)>,
    /// Time.
    pub time: f64,
}

impl<const D: usize> CellTerm<D> for BodyForce<'_, D> {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some(force) = self.force else { return };
        for q in cell.points {
            let f = force(&cell.position(&q.shape), self.time) * q.weight;
            for i in cell.nodes() {
                out.add_vector(cell.velocity(i), (f * -q.shape[i]).as_slice());
            }
        }
    }
}
