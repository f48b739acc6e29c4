//! Balance of momentum and of angular momentum of a rigid body.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::centre::RigidVelocity;
use crate::modes::{Spin, n_rotations};

/// `M (A - g)` for translations, `dL/dt` for rotations; implicit Euler: `M (V - V^n)/Δt - M g` and `(J ω - L^n)/Δt`
///
/// Source: Newton's and Euler's laws of motion: the rigid velocities as test functions in the inertia of the paper,
/// fully discrete problem after Eq. (4).
/// Couples: velocity and spin × velocity and spin.   Domain: the body.
/// Units: force and torque (2D: per unit depth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum<const D: usize> {
    /// Mass `M`.
    pub mass: f64,
    /// Inertia `J` about the centre: the angular momentum at the end of the step is `J` times the spin at the end. Only
    /// the first rows and columns are used, one per rotation.
    pub inertia: [Spin; 3],
    /// Acceleration `g` of gravity.
    pub gravity: Vector<D>,
    /// Derivative of the acceleration at the stage with respect to the velocity at the stage; `1/Δt` for implicit
    /// Euler.
    pub rate: f64,
    /// Acceleration `A` at the stage for zero velocity.
    pub acceleration: Vector<D>,
    /// Rate of the angular momentum at the stage for zero spin.
    pub torque: Spin,
}

impl<const D: usize> Term<RigidVelocity<D>> for Momentum<D> {
    fn add(&self, body: &RigidVelocity<D>, out: &mut LocalSystem) {
        for a in 0..D {
            out.add(a, self.mass * (body.velocity[a] * self.rate + self.acceleration[a] - self.gravity[a]));
            out.add_tangent(a, a, self.mass * self.rate);
        }
        for k in 0..n_rotations(D) {
            let momentum: f64 = body.spin.iter().zip(&self.inertia[k]).map(|(omega, j)| j * omega).sum();
            out.add(D + k, momentum * self.rate + self.torque[k]);
            for l in 0..n_rotations(D) {
                out.add_tangent(D + k, D + l, self.inertia[k][l] * self.rate);
            }
        }
    }
}
