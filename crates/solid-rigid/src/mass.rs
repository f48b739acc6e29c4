//! Mass, centre and second moment of a body.

use mesh::{Enclosed, Placed, Point, Tensor, positive, unit_vector};

use crate::Error;
use crate::modes::{Spin, n_rotations, rotation};

/// Mass, centre of mass and second moment of a body in the reference configuration.
///
/// Units: mass, length, mass·length²; mass and second moment per unit depth in 2D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties<const D: usize> {
    /// Mass `M`.
    pub mass: f64,
    /// Centre of mass.
    pub centre: Point<D>,
    /// `∫ ρ r rᵀ` about the centre; its trace is the moment of inertia in 2D.
    pub second_moment: Tensor<D>,
}

impl<const D: usize> MassProperties<D> {
    /// Computes the properties of the body of uniform density inside a closed surface, exactly up to round-off.
    ///
    /// # Errors
    /// [`Error::Parameter`]: density not positive. [`Error::Volume`]: the surface does not enclose a positive volume.
    pub fn of_surface(surface: &Placed<'_, D>, density: f64) -> Result<Self, Error> {
        positive("density", density)?;
        let Enclosed { volume, centre, second_moment } = surface.enclosed();
        if !(volume.is_finite() && volume > 0.0) {
            return Err(Error::Volume { volume });
        }
        Ok(Self { mass: density * volume, centre, second_moment: second_moment * density })
    }

    /// Returns `J_kl = ∫ ρ (e_k × r)·(e_l × r)` of the body after the rotation `turned_by`, row by row. Only the first
    /// rows and columns are used, one per rotation.
    pub fn inertia(&self, turned_by: &Tensor<D>) -> [Spin; 3] {
        let moment = turned_by * self.second_moment * turned_by.transpose();
        let mut inertia = [[0.0; 3]; 3];
        for (k, row) in inertia.iter_mut().enumerate().take(n_rotations(D)) {
            for (l, entry) in row.iter_mut().enumerate().take(n_rotations(D)) {
                // ∫ ρ (S_k r)·(S_l r) = S_k : (S_l ∫ ρ r rᵀ), column by column.
                let column = |a: usize| rotation(l, &moment.column(a).into_owned());
                *entry = (0..D).map(|a| rotation::<D>(k, &unit_vector(a)).dot(&column(a))).sum();
            }
        }
        inertia
    }
}
