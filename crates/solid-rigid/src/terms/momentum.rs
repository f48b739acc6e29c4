//! Balance of momentum and of angular momentum of a rigid body.

use algebra::LocalSystem;
use mesh::Vector;

use crate::modes::{Spin, n_rotations};

/// `M (V - V^n)/Δt - M g` for translations, `(J ω - L^n)/Δt` for rotations
///
/// Source: Newton's and Euler's laws of motion, implicit Euler in time, with the inertia `J` of the rotation at step n: the rigid
/// velocities as test functions in the inertia of the paper, fully discrete problem after Eq. (4).
/// Couples: velocity and spin × velocity and spin.   Domain: the body.
/// Units (cgs, per unit depth in 2D): residual dyn/cm and dyn, tangent g/(s cm) and g·cm/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum<const D: usize> {
    /// Mass `M`.
    pub mass: f64,
    /// Inertia `J` about the centre, rows of the rotations that count.
    pub inertia: [Spin; 3],
    /// Acceleration `g` of gravity.
    pub gravity: Vector<D>,
    /// Velocity `V^n` at the begin of the step.
    pub velocity: Vector<D>,
    /// Angular momentum `L^n` at the begin of the step.
    pub angular_momentum: Spin,
    /// Length `Δt` of the step.
    pub dt: f64,
}

impl<const D: usize> Momentum<D> {
    /// Adds the term, given the velocity of the centre and the spin at the end of the step.
    pub fn add(&self, velocity: &Vector<D>, spin: &[f64], out: &mut LocalSystem) {
        for a in 0..D {
            out.add(a, self.mass * ((velocity[a] - self.velocity[a]) / self.dt - self.gravity[a]));
            out.add_tangent(a, a, self.mass / self.dt);
        }
        for k in 0..n_rotations(D) {
            let momentum: f64 = spin.iter().zip(&self.inertia[k]).map(|(omega, j)| j * omega).sum();
            out.add(D + k, (momentum - self.angular_momentum[k]) / self.dt);
            for l in 0..n_rotations(D) {
                out.add_tangent(D + k, D + l, self.inertia[k][l] / self.dt);
            }
        }
    }
}
