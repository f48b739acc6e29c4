//! Body force on the solid.

use algebra::LocalSystem;
use mesh::Vector;

use crate::{SolidCell, SolidTerm};

/// `-(ρ^s f^s, w)_{Ω̂^s}`, with `f^s` an acceleration (gravity)
///
/// Source: paper, Eq. (4), right-hand side; `f^s` is an acceleration, so the load is `ρ^s f^s`.
/// Couples: solid velocity × nothing.   Domain: reference cells.
/// Units (cgs, per unit depth in 2D): residual dyn/cm.
///   residual_i = -ρ |K|/(D + 1) f^s,    tangent = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyForce<const D: usize> {
    /// Density in the reference configuration, g/cm³.
    pub density: f64,
    /// Acceleration `f^s`, cm/s².
    pub acceleration: Vector<D>,
}

impl<const D: usize> SolidTerm<D> for BodyForce<D> {
    #[inline]
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem) {
        let load = self.acceleration * (-self.density * cell.volume / (D + 1) as f64);
        for i in cell.nodes() {
            out.add_vector(cell.velocity(i), load.as_slice());
        }
    }
}
