//! Position and velocity of a rigid body.

use mesh::{Point, Tensor, Vector};

use crate::MassProperties;
use crate::modes::{Spin, n_rotations, rotated_by, spin_velocity};

/// Position and velocity of a rigid body at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion<const D: usize> {
    /// Centre of mass.
    pub centre: Point<D>,
    /// Rotation from the reference configuration.
    pub rotation: Tensor<D>,
    /// Velocity of the centre.
    pub velocity: Vector<D>,
    /// Spin `ω`, rad/s.
    pub spin: Spin,
    /// Angular momentum `L` about the centre.
    pub angular_momentum: Spin,
}

impl<const D: usize> RigidMotion<D> {
    /// Returns the motion at the start, in the reference configuration.
    pub fn initial(mass: &MassProperties<D>, velocity: Vector<D>, spin: Spin) -> Self {
        let rotation = Tensor::identity();
        let angular_momentum = product(&mass.inertia(&rotation), &spin, n_rotations(D));
        Self { centre: mass.centre, rotation, velocity, spin, angular_momentum }
    }

    /// Returns the motion at the end of a step of length `dt` with velocity and spin there.
    ///
    /// The angular momentum is that of the balance over the step, `J(R^n) ω` with the `inertia` at its start: without
    /// torque it is conserved exactly.
    pub fn after(&self, inertia: &[Spin; 3], dt: f64, velocity: Vector<D>, spin: Spin) -> Self {
        Self {
            centre: self.centre + velocity * dt,
            rotation: rotated_by::<D>(&spin.map(|omega| omega * dt)) * self.rotation,
            velocity,
            spin,
            angular_momentum: product(inertia, &spin, n_rotations(D)),
        }
    }

    /// Writes centre, rotation (column by column), velocity, spin and angular momentum as one list of numbers.
    pub fn to_numbers(&self) -> Vec<f64> {
        let vectors = self.centre.iter().chain(&self.rotation).chain(&self.velocity);
        vectors.chain(&self.spin).chain(&self.angular_momentum).copied().collect()
    }

    /// Reads the numbers of [`RigidMotion::to_numbers`].
    ///
    /// # Panics
    /// The list has another length.
    pub fn from_numbers(numbers: &[f64]) -> Self {
        let (centre, rest) = numbers.split_at(D);
        let (rotation, rest) = rest.split_at(D * D);
        let (velocity, rest) = rest.split_at(D);
        let spin = |k: usize| std::array::from_fn(|a| rest[3 * k + a]);
        Self {
            centre: Point::from_column_slice(centre),
            rotation: Tensor::from_column_slice(rotation),
            velocity: Vector::from_column_slice(velocity),
            spin: spin(0),
            angular_momentum: spin(1),
        }
    }

    /// Returns the current position of a point of the body.
    pub fn position(&self, mass: &MassProperties<D>, reference: &Point<D>) -> Point<D> {
        self.centre + self.rotation * (reference - mass.centre)
    }

    /// Returns `V + ω × (x - c)`: velocity of the body at a current position.
    pub fn velocity_at(&self, x: &Point<D>) -> Vector<D> {
        self.velocity + spin_velocity(&self.spin, &(x - self.centre))
    }

    /// Returns `1/2 M V² + 1/2 ω·L`.
    pub fn kinetic_energy(&self, mass: &MassProperties<D>) -> f64 {
        let spinning: f64 = self.spin.iter().zip(&self.angular_momentum).map(|(omega, l)| omega * l).sum();
        0.5 * (mass.mass * self.velocity.norm_squared() + spinning)
    }
}

fn product(inertia: &[Spin; 3], spin: &Spin, n: usize) -> Spin {
    let mut momentum = [0.0; 3];
    for k in 0..n {
        momentum[k] = (0..n).map(|l| inertia[k][l] * spin[l]).sum();
    }
    momentum
}
