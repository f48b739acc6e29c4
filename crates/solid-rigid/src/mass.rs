//! Mass, centre and second moment of a body.

use mesh::{Placed, Point, Tensor};

use crate::Error;
use crate::error::positive;
use crate::modes::{Spin, axis, n_rotations, rotation};

/// Mass, centre of mass and second moment of a body in the reference configuration.
///
/// Units (cgs, per unit depth in 2D): g/cm, cm, g·cm.
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
    /// Those of the body of uniform density inside of a closed surface, exactly.
    ///
    /// The body is the sum of the simplices between its facets and a point, with signs. For one with a vertex at the origin and
    /// the others at `x_i`: `∫ x xᵀ = |T| (Σ x_i x_iᵀ + s sᵀ)/((D + 1)(D + 2))`, `s = Σ x_i`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: density not positive. [`Error::Volume`]: the surface does not enclose a positive volume.
    pub fn of_surface(surface: &Placed<'_, D>, density: f64) -> Result<Self, Error> {
        positive("density", density)?;
        let boundary = surface.boundary();
        let origin = boundary.facets().next().map_or(Point::zeros(), |f| surface.facet_points(f)[0]);
        let (mut volume, mut first, mut second) = (0.0, Point::<D>::zeros(), Tensor::<D>::zeros());
        for facet in boundary.facets() {
            let points = surface.facet_points(facet).map(|x| x - origin);
            let corners = &points[..D];
            // The normal has the length of the parallelepiped of the facet, and the simplex is the D!-th part of the one above it.
            let parts = (1..=D).product::<usize>() as f64;
            let simplex = corners[0].dot(&surface.facet_normal_scaled(facet)) / parts;
            let sum: Point<D> = corners.iter().sum();
            volume += simplex;
            first += sum * (simplex / (D + 1) as f64);
            let squares = corners.iter().map(|x| x * x.transpose()).sum::<Tensor<D>>() + sum * sum.transpose();
            second += squares * (simplex / ((D + 1) * (D + 2)) as f64);
        }
        if !(volume.is_finite() && volume > 0.0) {
            return Err(Error::Volume { volume });
        }
        let arm = first / volume;
        Ok(Self {
            mass: density * volume,
            centre: origin + arm,
            second_moment: (second - arm * arm.transpose() * volume) * density,
        })
    }

    /// `J_kl = ∫ ρ (e_k × r)·(e_l × r)` of the body turned by `rotation`: row by row, the rotations that count.
    pub fn inertia(&self, turned_by: &Tensor<D>) -> [Spin; 3] {
        let moment = turned_by * self.second_moment * turned_by.transpose();
        let mut inertia = [[0.0; 3]; 3];
        for (k, row) in inertia.iter_mut().enumerate().take(n_rotations(D)) {
            for (l, entry) in row.iter_mut().enumerate().take(n_rotations(D)) {
                // ∫ ρ (S_k r)·(S_l r) = S_k : (S_l ∫ ρ r rᵀ), column by column.
                let column = |a: usize| rotation(l, &moment.column(a).into_owned());
                *entry = (0..D).map(|a| rotation::<D>(k, &axis(a)).dot(&column(a))).sum();
            }
        }
        inertia
    }
}
