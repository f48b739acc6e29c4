//! Body force on the fluid.

use algebra::{LocalSystem, Term};

use super::ForceFunction;
use crate::FluidCell;

/// Degree of quadrature: a linear force times a P1 function.
const DEGREE: usize = 2;

/// `-(f^f, v)_{Ω^f}`, force per volume
///
/// Source: paper, right side of Eq. (4).
/// Couples: velocity.   Domain: fluid parts of active cells.
/// Units: force (2D: per unit depth).
pub struct BodyForce<'a, const D: usize> {
    /// Force per volume at a point and time.
    pub force: ForceFunction<'a, D>,
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for BodyForce<'_, D> {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        cell.for_each_point(DEGREE, |x, weight, shape| {
            let f = (self.force)(x, self.time) * weight;
            (0..=D).for_each(|i| out.add_vector::<D>(cell.velocity_row(i), f * -shape[i]));
        });
    }
}
