//! Powers of the mortar, for the balance of energy.

use algebra::Sites;

use crate::InterfacePoints;
use crate::terms::Penalty;
use crate::traction::tractions_by_mean;

/// Powers on the interface. Units: energy/time (2D: per unit depth).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfacePower {
    /// `∫ σ_n |(u - v_s)·n|²`.
    pub penalty_normal: f64,
    /// `∫ σ_t |(u - v_s) - (u - v_s)·n n|²`. On surfaces along films `σ_f` replaces `σ_t`, and the power of the penalty
    /// on the mean slip is added ([`Penalty`]).
    pub penalty_tangential: f64,
    /// Power of the fluid on bodies of given motion, `∫ t·v_s` with the traction `t = -T^f n^f + S (u - v_s)`.
    pub given_motion: f64,
}

/// Returns the powers on the interface of a step at the state `x`.
pub fn interface_power<const D: usize>(
    points: &InterfacePoints<'_, D>,
    penalty: &Penalty,
    x: &[f64],
) -> InterfacePower {
    let mut power = InterfacePower::default();
    let by_mean = tractions_by_mean(points, penalty, x);
    for item in 0..points.len() {
        points.visit(item, x, |q| {
            let n = &q.piece.normal;
            let traction = penalty.weighted(q) * q.jump + by_mean[item] * q.at.weight;
            let along = q.jump.dot(n);
            power.penalty_normal += traction.dot(n) * along;
            power.penalty_tangential += traction.dot(&(q.jump - n * along));
            if q.n_solid == 0 {
                let by_fluid = (q.force_at_end() - q.traction) * q.at.weight;
                power.given_motion += (traction + by_fluid).dot(&(q.velocity - q.jump));
            }
        });
    }
    power
}
