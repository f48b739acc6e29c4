//! Time schemes: how displacement and acceleration follow from the velocity at the end of a step.
//!
//! The unknown of every field is its velocity `v` at the end of the step. A scheme gives the weights of `v` and of known
//! values (levels) in displacement and acceleration. `V` is a number or a vector; there is one at each node.

mod generalised_alpha;
mod implicit_euler;
mod quasi_static;

pub use generalised_alpha::GeneralisedAlpha;
pub use implicit_euler::ImplicitEuler;
pub use quasi_static::QuasiStatic;

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, Mul};

/// A value at a node.
pub trait Value: Copy + Sum + Add<Output = Self> + Mul<f64, Output = Self> {}

impl<V: Copy + Sum + Add<Output = V> + Mul<f64, Output = V>> Value for V {}

/// A field at one time, one value per node. Lists that are not needed or not known are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Level<V> {
    /// Displacement.
    pub displacement: Vec<V>,
    /// Velocity.
    pub velocity: Vec<V>,
    /// Acceleration; empty at the start of a run, where it is unknown.
    pub acceleration: Vec<V>,
}

impl<V> Default for Level<V> {
    /// Creates an empty set of lists.
    fn default() -> Self {
        Self { displacement: Vec::new(), velocity: Vec::new(), acceleration: Vec::new() }
    }
}

/// One quantity as a weighted sum: of the unknown velocity, and of known values at earlier times, newest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Weight of the unknown velocity.
    pub slope: f64,
    /// Weights of known displacements.
    pub displacement: [f64; 2],
    /// Weights of known velocities.
    pub velocity: [f64; 2],
    /// Weight of the newest known acceleration.
    pub acceleration: f64,
}

/// Displacement and acceleration at the end of a step, and the stage at which equations are evaluated.
///
/// The stage lies between the newest known level and the end: `q_stage = (1 - α) q_end + α q_known`, with `α_m` for
/// accelerations and `α_f` for displacements and velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Displacement at the end.
    pub displacement: Row,
    /// Acceleration at the end.
    pub acceleration: Row,
    /// Weight `α_f` of the newest known displacement and velocity in the stage.
    pub alpha_f: f64,
    /// Weight `α_m` of the newest known acceleration in the stage.
    pub alpha_m: f64,
}

/// A time scheme: a table of weights.
pub trait TimeScheme: Send + Sync + Debug {
    /// Returns the number of known levels that a step reads.
    fn depth(&self) -> usize {
        1
    }

    /// Returns the weights of a step. `lengths` are those of this step and of the ones before, newest first; `starts`
    /// is true if no acceleration is known.
    fn weights(&self, lengths: &[f64], starts: bool) -> Weights;
}

/// A quantity that is affine in the velocity `v` of each node: `q = predicted + slope v`.
#[derive(Clone, Debug, PartialEq)]
pub struct Affine<V> {
    /// Derivative with respect to `v`.
    pub slope: f64,
    /// Values at zero velocity; an empty list means zero everywhere.
    pub predicted: Vec<V>,
}

impl<V: Value> Affine<V> {
    /// Returns the value at a node with velocity `v`.
    #[inline]
    pub fn at(&self, node: usize, v: V) -> V {
        match self.predicted.get(node) {
            Some(&predicted) => predicted + v * self.slope,
            None => v * self.slope,
        }
    }

    /// Builds a row of a scheme from known levels, newest first.
    fn from_row(row: &Row, levels: &[Level<V>]) -> Self {
        let mut terms: Vec<(f64, &[V])> = Vec::new();
        for (k, level) in levels.iter().take(row.velocity.len()).enumerate() {
            terms.extend([(row.displacement[k], level.displacement.as_slice()), (row.velocity[k], &level.velocity)]);
        }
        terms.extend(levels.first().map(|level| (row.acceleration, level.acceleration.as_slice())));
        terms.retain(|(weight, values)| *weight != 0.0 && !values.is_empty());
        let n = terms.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
        let sum = |node: usize| terms.iter().map(|(weight, values)| values[node] * *weight).sum();
        Self { slope: row.slope, predicted: (0..n).map(sum).collect() }
    }

    /// Interpolates between the end of a step and known values, at the fraction `alpha` of the step before its end.
    fn moved_back(&self, alpha: f64, known: &[V]) -> Self {
        if alpha == 0.0 {
            return self.clone();
        }
        let value = |node: usize| {
            let end = self.predicted.get(node).map(|predicted| *predicted * (1.0 - alpha));
            end.into_iter().chain([known[node] * alpha]).sum()
        };
        Self { slope: (1.0 - alpha) * self.slope, predicted: (0..known.len()).map(value).collect() }
    }
}

/// Displacement, velocity and acceleration at one time within a step, affine in the velocity at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<V> {
    /// Displacement.
    pub displacement: Affine<V>,
    /// Velocity.
    pub velocity: Affine<V>,
    /// Acceleration.
    pub acceleration: Affine<V>,
}

/// One step of a scheme.
///
/// Terms of a weak form depend on the scheme through the stage only. Surfaces in contact with fluid and other bodies
/// are those at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRule<V> {
    /// At the end of the step.
    pub end: Motion<V>,
    /// At the stage, where the equations hold.
    pub stage: Motion<V>,
    /// Distance of the stage from the end, as a fraction of the step.
    pub alpha_f: f64,
}

impl<V: Value> StepRule<V> {
    /// Applies a scheme to known levels, newest first; `lengths` are those of this step and of the ones before.
    pub fn new(scheme: &dyn TimeScheme, lengths: &[f64], levels: &[Level<V>]) -> Self {
        let newest = levels.first();
        let known = |list: fn(&Level<V>) -> &Vec<V>| newest.map_or(&[][..], |level| list(level).as_slice());
        let accelerations = known(|level| &level.acceleration);
        let weights = scheme.weights(lengths, accelerations.is_empty());
        let end = Motion {
            displacement: Affine::from_row(&weights.displacement, levels),
            velocity: Affine { slope: 1.0, predicted: Vec::new() },
            acceleration: Affine::from_row(&weights.acceleration, levels),
        };
        let Weights { alpha_f, alpha_m, .. } = weights;
        let stage = Motion {
            displacement: end.displacement.moved_back(alpha_f, known(|level| &level.displacement)),
            velocity: end.velocity.moved_back(alpha_f, known(|level| &level.velocity)),
            acceleration: end.acceleration.moved_back(alpha_m, accelerations),
        };
        Self { end, stage, alpha_f }
    }

    /// Returns the level at the end of the step for the velocities there.
    pub fn level(&self, velocity: Vec<V>) -> Level<V> {
        let at = |quantity: &Affine<V>| velocity.iter().enumerate().map(|(node, v)| quantity.at(node, *v)).collect();
        Level { displacement: at(&self.end.displacement), acceleration: at(&self.end.acceleration), velocity }
    }
}
