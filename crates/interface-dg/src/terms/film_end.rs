//! Pressure of a film between its last part and the edge at which it ends.

use algebra::{LocalSystem, Term};

use crate::MortarPoint;

/// `(p' n, w)_Σ - (q' n, v_s)_Σ` with the additional pressure `p'` on the surfaces along the last part of a film, the
/// force of the film between this part and its edge ([`fluid_ns::LastPiece`]), and the normal `n` out of the body
///
/// Source: Galerkin's method with the pressure of the film that falls linearly up to the edge in place of the end of
/// the part. `q'` is its test function: the fluid that the body displaces there flows along the film.
/// Couples: solid × pressure, pressure × solid.   Domain: interface pieces along films, in their last parts.
/// Units: force and volume/time (2D: per unit depth).
/// The fluid has no row. The additional forces on opposite surfaces cancel if their areas in the last parts and the
/// factors are equal; otherwise action and reaction differ. The term is skew but for the pressures of fluid at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmEnd;

impl<const D: usize> Term<MortarPoint<'_, D>> for FilmEnd {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let Some((pressure, by_pressure)) = q.at_end else { return };
        let (weight, n) = (q.at.weight * q.alpha, q.piece.normal);
        let of_body = q.velocity - q.jump;
        for (i, slope) in by_pressure[..=D].iter().enumerate() {
            out.add(q.pressure_row(i), -weight * slope * of_body.dot(&n));
        }
        // The basis of the jump is negative for the body.
        for (row, basis) in q.jump_basis().skip(D + 1) {
            let tested = n * (-weight * basis);
            out.add_vector::<D>(row, tested * pressure);
            if !out.has_tangent() {
                continue;
            }
            for (i, slope) in by_pressure[..=D].iter().enumerate() {
                out.add_block::<D, 1>(row, q.pressure_row(i), tested * *slope);
                out.add_block::<1, D>(q.pressure_row(i), row, tested.transpose() * -slope);
            }
        }
    }
}
