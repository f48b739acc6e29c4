//! Position and velocity of a rigid body.

use algebra::time::{Row, Weights};
use mesh::{Point, Tensor, Vector};

use crate::MassProperties;
use crate::modes::{Spin, n_rotations, rotated_by, spin_velocity};
use crate::terms::Momentum;

/// Position and velocity of a rigid body at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion<const D: usize> {
    /// Centre of mass.
    pub centre: Point<D>,
    /// Rotation from the reference configuration.
    pub rotation: Tensor<D>,
    /// Velocity of the centre.
    pub velocity: Vector<D>,
    /// Spin `ω`, rad/time.
    pub spin: Spin,
    /// Angular momentum `L` about the centre.
    pub angular_momentum: Spin,
    /// Acceleration of the centre. Accelerations and rates are zero at the start of a run, and with schemes that do not
    /// use them.
    pub acceleration: Vector<D>,
    /// Rate of the spin.
    pub spin_rate: Spin,
    /// Rate of the angular momentum.
    pub torque: Spin,
}

impl<const D: usize> RigidMotion<D> {
    /// Returns the motion at the start, in the reference configuration.
    pub fn initial(mass: &MassProperties<D>, velocity: Vector<D>, spin: Spin) -> Self {
        let rotation = Tensor::identity();
        let angular_momentum = angular_momentum(&mass.inertia(&rotation), &spin, n_rotations(D));
        let (acceleration, none) = (Vector::zeros(), [0.0; 3]);
        let (centre, spin_rate, torque) = (mass.centre, none, none);
        Self { centre, rotation, velocity, spin, angular_momentum, acceleration, spin_rate, torque }
    }

    /// Evaluates the displacement row of a time scheme, with a velocity and a spin at the stage. Returns the centre and
    /// the rotation `exp(φ ×) R`: `R` is that at the start, and the angles `φ` are the sum of spins in the row.
    pub fn placed(&self, row: &Row, velocity: &Vector<D>, spin: &Spin) -> (Point<D>, Tensor<D>) {
        let centre = self.centre * row.displacement + self.weighted_velocities(row, velocity);
        (centre, rotated_by::<D>(&self.weighted_spins(row, spin)) * self.rotation)
    }

    /// Returns the part of a row that depends on velocities and accelerations of the centre, for a velocity at the
    /// stage.
    fn weighted_velocities(&self, row: &Row, velocity: &Vector<D>) -> Vector<D> {
        velocity * row.slope + self.velocity * row.velocity + self.acceleration * row.acceleration
    }

    /// Returns the part of a row that depends on the spin and its rate, for a spin at the stage.
    fn weighted_spins(&self, row: &Row, spin: &Spin) -> Spin {
        std::array::from_fn(|k| {
            row.slope * spin[k] + row.velocity * self.spin[k] + row.acceleration * self.spin_rate[k]
        })
    }

    /// Returns the balance of momentum at the stage of a step.
    ///
    /// The angular momentum at the end is `J ω`. `J` is the inertia at the rotation extrapolated to the end of the step
    /// (generalised-α), or at the start (implicit Euler). Without torque the angular momentum is conserved exactly.
    pub fn momentum(&self, mass: &MassProperties<D>, gravity: Vector<D>, weights: &Weights) -> Momentum<D> {
        let rate = &weights.stage_acceleration;
        let inertia = mass.inertia(&self.placed(&weights.extrapolated[1], &Vector::zeros(), &[0.0; 3]).1);
        // L = (1 - α_f) J ω^{n+1} + α_f L^n at the stage, with ω = (1 - α_f) ω^{n+1} + α_f ω^n.
        let of_spin = angular_momentum(&inertia, &self.spin, n_rotations(D));
        let torque = |k: usize| {
            let at_stage = weights.alpha_f * (self.angular_momentum[k] - of_spin[k]);
            rate.slope * at_stage + rate.velocity * self.angular_momentum[k] + rate.acceleration * self.torque[k]
        };
        Momentum {
            mass: mass.mass,
            inertia,
            gravity,
            rate: rate.slope,
            acceleration: self.weighted_velocities(rate, &Vector::zeros()),
            torque: std::array::from_fn(torque),
        }
    }

    /// Returns the motion at the end of a step, given velocity and spin at the stage. `inertia` is that of
    /// [`RigidMotion::momentum`] for this step.
    pub fn after(&self, inertia: &[Spin; 3], weights: &Weights, velocity: Vector<D>, spin: Spin) -> Self {
        let (centre, rotation) = self.placed(&weights.displacement, &velocity, &spin);
        let end = self.weighted_spins(&weights.velocity, &spin);
        let angular_momentum = angular_momentum(inertia, &end, n_rotations(D));
        let torque = |k: usize| {
            let (row, alpha) = (&weights.acceleration, weights.alpha_f);
            let at_stage = (1.0 - alpha) * angular_momentum[k] + alpha * self.angular_momentum[k];
            row.slope * at_stage + row.velocity * self.angular_momentum[k] + row.acceleration * self.torque[k]
        };
        Self {
            centre,
            rotation,
            velocity: self.weighted_velocities(&weights.velocity, &velocity),
            spin: end,
            angular_momentum,
            acceleration: self.weighted_velocities(&weights.acceleration, &velocity),
            spin_rate: self.weighted_spins(&weights.acceleration, &spin),
            torque: std::array::from_fn(torque),
        }
    }

    /// Evaluates two rows of a time scheme, for the position and for velocity, spin and angular momentum. Known values
    /// are those of this motion with the accelerations and rates of `rates`; velocity and spin at the stage are zero.
    pub fn at_rows(&self, rates: &Self, [displacement, velocity]: &[Row; 2]) -> Self {
        let (acceleration, spin_rate, torque) = (rates.acceleration, rates.spin_rate, rates.torque);
        let known = Self { acceleration, spin_rate, torque, ..*self };
        let (centre, rotation) = known.placed(displacement, &Vector::zeros(), &[0.0; 3]);
        let sum = |of: &Spin, rate: &Spin| {
            std::array::from_fn(|k| velocity.velocity * of[k] + velocity.acceleration * rate[k])
        };
        let (spin, angular_momentum) = (sum(&self.spin, &spin_rate), sum(&self.angular_momentum, &torque));
        let velocity = known.weighted_velocities(velocity, &Vector::zeros());
        Self { centre, rotation, velocity, spin, angular_momentum, ..known }
    }

    /// Returns centre, rotation (column by column), velocity and acceleration of the centre, then spin, angular
    /// momentum, rate of the spin and rate of the angular momentum (three numbers each): `D² + 3 D + 12` numbers.
    pub fn to_numbers(&self) -> Vec<f64> {
        let vectors = self.centre.iter().chain(&self.rotation).chain(&self.velocity).chain(&self.acceleration);
        let spins = [self.spin, self.angular_momentum, self.spin_rate, self.torque];
        vectors.chain(spins.iter().flatten()).copied().collect()
    }

    /// Reads the numbers of [`RigidMotion::to_numbers`].
    ///
    /// # Panics
    /// The list has fewer numbers.
    pub fn from_numbers(numbers: &[f64]) -> Self {
        let (centre, rest) = numbers.split_at(D);
        let (rotation, rest) = rest.split_at(D * D);
        let (velocity, rest) = rest.split_at(D);
        let (acceleration, rest) = rest.split_at(D);
        let spin = |k: usize| std::array::from_fn(|a| rest[3 * k + a]);
        Self {
            centre: Point::from_column_slice(centre),
            rotation: Tensor::from_column_slice(rotation),
            velocity: Vector::from_column_slice(velocity),
            acceleration: Vector::from_column_slice(acceleration),
            spin: spin(0),
            angular_momentum: spin(1),
            spin_rate: spin(2),
            torque: spin(3),
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

    /// Returns `A + dω/dt × r + ω × (ω × r)` with `r = x - c`: acceleration of the body at a current position.
    pub fn acceleration_at(&self, x: &Point<D>) -> Vector<D> {
        let arm = x - self.centre;
        let inwards = spin_velocity(&self.spin, &spin_velocity(&self.spin, &arm));
        self.acceleration + spin_velocity(&self.spin_rate, &arm) + inwards
    }

    /// Returns `1/2 M V² + 1/2 ω·L`.
    pub fn kinetic_energy(&self, mass: &MassProperties<D>) -> f64 {
        let spinning: f64 = self.spin.iter().zip(&self.angular_momentum).map(|(omega, l)| omega * l).sum();
        0.5 * (mass.mass * self.velocity.norm_squared() + spinning)
    }
}

/// Returns the angular momentum `J ω`; `n` is the number of rotations.
fn angular_momentum(inertia: &[Spin; 3], spin: &Spin, n: usize) -> Spin {
    let mut momentum = [0.0; 3];
    for k in 0..n {
        momentum[k] = (0..n).map(|l| inertia[k][l] * spin[l]).sum();
    }
    momentum
}
