//! Pressure of a film between its last part and the edge at which it ends.

use algebra::{LocalSystem, Term};

use crate::MortarPoint;

/// `(p' n, w)_Σ - (q' n, v_s)_Σ` with the additional pressure `p'` on the surfaces along the last part of a film, and
/// the normal `n` out of the body
///
/// Source: Galerkin's method with a pressure of the film that falls linearly up to the edge in place of the end of the
/// last part ([`fluid_ns::LastPiece`]).
/// Couples: solid × pressure, pressure × solid.   Domain: interface pieces along films, in their last parts.
/// Units: force and volume/time (2D: per unit depth).
/// The discrete pressure is that of open fluid already at the end of the last part, and not at the edge. `p'` adds the
/// missing force: with it the force is that of a pressure that falls linearly up to the edge. With the test function
/// `q'`, the fluid that the body displaces there enters the film. The two products cancel in the energy except for
/// pressures of fluid at rest. The fluid has no row: the forces on the surfaces on both sides differ if these have
/// different areas in the last part, or different factors.
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
