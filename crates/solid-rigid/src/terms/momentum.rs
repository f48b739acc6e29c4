//! Balance of momentum and of angular momentum of a rigid body.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use crate::centre::RigidVelocity;
use crate::modes::{Spin, n_rotations};

/// `M (V - V^n)/Δt - M g` for translations, `(J ω - L^n)/Δt` for rotations
///
/// Source: Newton's and Euler's laws of motion, implicit Euler in time, with the inertia `J` of the rotation at step n: the
/// rigid velocities as test functions in the inertia of the paper, fully discrete problem after Eq. (4).
/// Couples: velocity and spin × velocity and spin.   Domain: the body.
/// Units: force and torque (2D: per unit depth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum<const D: usize> {
    /// Mass `M`.
    pub mass: f64,
    /// Inertia `J` about the centre; only the first rows and columns are used, one per rotation.
    pub inertia: [Spin; 3],
    /// Acceleration `g` of gravity.
    pub gravity: Vector<D>,
    /// Velocity `V^n` at the start of the step.
    pub velocity: Vector<D>,
    /// Angular momentum `L^n` at the start of the step.
    pub angular_momentum: Spin,
    /// Inverse `1/Δt` of the length of the step.
    pub rate: f64,
}

impl<const D: usize> Term<RigidVelocity<D>> for Momentum<D> {
    fn add(&self, body: &RigidVelocity<D>, out: &mut LocalSystem) {
        for a in 0..D {
            out.add(a, self.mass * ((body.velocity[a] - self.velocity[a]) * self.rate - self.gravity[a]));
            out.add_tangent(a, a, self.mass * self.rate);
        }
        for k in 0..n_rotations(D) {
            let momentum: f64 = body.spin.iter().zip(&self.inertia[k]).map(|(omega, j)| j * omega).sum();
            out.add(D + k, (momentum - self.angular_momentum[k]) * self.rate);
            for l in 0..n_rotations(D) {
                out.add_tangent(D + k, D + l, self.inertia[k][l] * self.rate);
            }
        }
    }
}
