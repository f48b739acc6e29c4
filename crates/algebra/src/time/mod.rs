//! Time schemes: how a step advances displacement and velocity.
//!
//! The unknown of every field is its velocity `v` at the *stage* of the step, the time at which the equations hold. A
//! scheme gives displacement and acceleration at the stage, and the motion at the end of the step, as sums of `v` and
//! of known values at the start.

mod generalised_alpha;
mod implicit_euler;
mod quasi_static;
mod row;

pub use generalised_alpha::GeneralisedAlpha;
pub use implicit_euler::ImplicitEuler;
pub use quasi_static::QuasiStatic;
pub use row::Row;

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, Mul};

/// A value at a node: a number or a vector.
pub trait Value: Copy + Sum + Add<Output = Self> + Mul<f64, Output = Self> {}

impl<V: Copy + Sum + Add<Output = V> + Mul<f64, Output = V>> Value for V {}

/// A field at one time, one value per node. Lists that are not needed or not known are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Level<V> {
    /// Displacement.
    pub displacement: Vec<V>,
    /// Velocity.
    pub velocity: Vec<V>,
    /// Acceleration; empty at the start of a run, where it is unknown, and with schemes that do not need it.
    pub acceleration: Vec<V>,
}

impl<V> Default for Level<V> {
    /// Creates an empty set of lists.
    fn default() -> Self {
        Self { displacement: Vec::new(), velocity: Vec::new(), acceleration: Vec::new() }
    }
}

impl<V: Value> Level<V> {
    /// Evaluates two rows of a scheme, one for the displacement and one for the velocity. Known values are displacement
    /// and velocity of this level and the accelerations of `rates`; the unknown velocity is zero.
    pub fn at_rows(&self, rates: &Self, rows: &[Row; 2]) -> Self {
        let known = Self { acceleration: rates.acceleration.clone(), ..self.clone() };
        let [displacement, velocity] = rows.map(|row| Affine::new(&row, &known).predicted);
        Self { displacement, velocity, acceleration: Vec::new() }
    }
}

/// The weights of a scheme for one step: one [`Row`] for each quantity.
///
/// Contact acts at *shifted* displacements. Their change over the step is `Δt v` with the velocity `v` at the stage, so
/// that the work of a force on `v` is the force times the change of the shifted displacement. For implicit Euler the
/// shifted displacements are the displacements at the ends of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Displacement at the stage.
    pub stage_displacement: Row,
    /// Acceleration at the stage; zero if the scheme neglects inertia.
    pub stage_acceleration: Row,
    /// Displacement at the end.
    pub displacement: Row,
    /// Velocity at the end.
    pub velocity: Row,
    /// Acceleration at the end. A zero row means that no field keeps accelerations. A fluid with moving bodies needs
    /// them: without them the penalty at surfaces contains `1/Δt`, so that the added mass of bodies grows as steps
    /// become shorter.
    pub acceleration: Row,
    /// Displacement at the stage, at which the mesh is cut, and at the end, extrapolated from known values. Implicit
    /// Euler: the displacement at the start for both.
    pub extrapolated: [Row; 2],
    /// Shifted displacement at the start and at the end.
    pub shifted: [Row; 2],
    /// Displacement and velocity of two motions at one time. The mean of their energies is the *energy of the scheme*,
    /// which a step without forces cannot increase where energies are quadratic.
    pub of_energy: [[Row; 2]; 2],
    /// Whether a force with a potential acts as a discrete gradient, which conserves energy. Otherwise the force at the
    /// end of the step acts, which dissipates energy if the potential is convex.
    pub conserves: bool,
    /// Whether the pressure of the fluid acts on the surfaces of elastic bodies at the stage; otherwise on those at
    /// which the mesh is cut.
    pub pressure_at_stage: bool,
    /// Distance of the stage from the end, as a fraction of the step.
    pub alpha_f: f64,
}

/// A time scheme: a table of weights.
pub trait TimeScheme: Send + Sync + Debug {
    /// Returns the weights of a step of length `dt`. `starts`: the acceleration at its start is unknown.
    fn weights(&self, dt: f64, starts: bool) -> Weights;
}

impl Weights {
    /// Returns the level at the end of the step for the velocities at the stage.
    pub fn end<V: Value>(&self, start: &Level<V>, stage_velocity: &[V]) -> Level<V> {
        let at = |row: &Row| {
            let quantity = Affine::new(row, start);
            let needed = *row != Row::default();
            let values = stage_velocity.iter().enumerate().filter(|_| needed);
            values.map(|(node, v)| quantity.at(node, *v)).collect()
        };
        let displacement = if start.displacement.is_empty() { Vec::new() } else { at(&self.displacement) };
        Level { displacement, velocity: at(&self.velocity), acceleration: at(&self.acceleration) }
    }

    /// Returns whether the scheme has inertia.
    pub fn has_inertia(&self) -> bool {
        self.stage_acceleration != Row::default()
    }

    /// Returns the velocity at the stage for which the velocity at the end has a given value.
    pub fn stage_velocity(&self, end: f64, start: f64) -> f64 {
        if self.alpha_f == 0.0 { end } else { (1.0 - self.alpha_f) * end + self.alpha_f * start }
    }
}

/// A quantity that is affine in the velocity `v` of each node at the stage: `q = predicted + slope v`.
#[derive(Clone, Debug, PartialEq)]
pub struct Affine<V> {
    /// Derivative with respect to `v`.
    pub slope: f64,
    /// Values at zero velocity; an empty list means zero everywhere.
    pub predicted: Vec<V>,
}

impl<V: Value> Affine<V> {
    /// Evaluates a row for known values at the start of the step.
    pub fn new(row: &Row, start: &Level<V>) -> Self {
        let known = [
            (row.displacement, &start.displacement),
            (row.velocity, &start.velocity),
            (row.acceleration, &start.acceleration),
        ];
        let terms = || known.iter().filter(|(weight, values)| *weight != 0.0 && !values.is_empty());
        let n = terms().map(|(_, values)| values.len()).max().unwrap_or(0);
        let sum = |node: usize| terms().map(|(weight, values)| values[node] * *weight).sum();
        Self { slope: row.slope, predicted: (0..n).map(sum).collect() }
    }

    /// Returns the value at a node with velocity `v`.
    #[inline]
    pub fn at(&self, node: usize, v: V) -> V {
        match self.predicted.get(node) {
            Some(&predicted) => predicted + v * self.slope,
            None => v * self.slope,
        }
    }
}

/// Displacement and acceleration of a field at the stage. Terms of a weak form depend on the scheme only through them.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRule<V> {
    /// Displacement.
    pub displacement: Affine<V>,
    /// Acceleration.
    pub acceleration: Affine<V>,
}

impl<V: Value> StepRule<V> {
    /// Applies the weights of a step to known values at its start.
    pub fn new(weights: &Weights, start: &Level<V>) -> Self {
        Self {
            displacement: Affine::new(&weights.stage_displacement, start),
            acceleration: Affine::new(&weights.stage_acceleration, start),
        }
    }
}
