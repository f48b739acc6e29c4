//! Motions of bodies that do not deform.

use std::sync::Arc;

use mesh::{BoundaryMesh, Point, Vector};
use solid_rigid::{Guide, Spin};
use solver::body::PrescribedBody;

use super::error::{ErrorKind, Location, ScenarioError};
use super::formula::{Dual, Formula};
use super::geometry::input_path;
use super::key::Quantity;
use super::motion_table::{MotionTable, Pose};
use super::solver::{Time, TimeSchemeChoice};
use super::table::{At, Components, choices, keys};
use super::units::rounded_down;

choices! {
    /// Motion of a body that does not deform; angles are in radians, counter-clockwise.
    pub enum MotionChoice ["kind"] {
        /// At rest: an obstacle.
        Fixed = "fixed",
        /// Rotation, from the start.
        Rotating = "rotating" {
            /// Centre of the rotation.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Angular velocity, rad per time. The angle is its integral from the start.
            angular_velocity: At<Formula> [unit(Quantity::RATE)],
        },
        /// Formulas in the time `t`.
        Formula = "formula" {
            /// Displacement from the place of the shape.
            displacement: Components<At<Formula>> [unit(Quantity::LENGTH)],
            /// Angle about the centre, rad; no rotation if left out.
            angle: Option<At<Formula>>,
            /// Centre of the rotation before the displacement, with `angle`.
            centre: Option<At<Components<f64>>> [unit(Quantity::LENGTH)],
        },
        /// Free rigid body, moved by its weight, the fluid and contacts; it needs `density` and `gravity`.
        Free = "free" {
            /// Motions that are held.
            held: Vec<At<Held>>,
            /// Angular velocity at the start about the centre of mass, rad per time; a number is that about the third axis.
            initial_spin: Option<At<Spin>> [unit(Quantity::RATE)],
            /// Given motion until the body is released; free from the start if left out.
            guided: Option<GuideKeys>,
        },
        /// Table of displacements and angles over time.
        Table = "table" {
            /// CSV file, relative to the scenario.
            file: At<String>,
            /// Centre of the rotation before the displacement, with a column of angles.
            centre: Option<At<Components<f64>>> [unit(Quantity::LENGTH)],
        },
    }
}

keys! {
    /// A motion of the centre, without rotation, from the start until the body is released. The body begins with its
    /// velocity. The first step after the release is of first order, since the acceleration jumps.
    pub struct GuideKeys {
        /// Time of the release: the guide acts in all steps that begin before it.
        until: f64 [unit(Quantity::TIME), positive],
        /// Velocity, formulas in the time `t`.
        velocity: Components<At<Formula>> [unit(Quantity::VELOCITY)],
    }
}

choices! {
    /// Motion of a free body that is held.
    #[derive(Copy, Eq)]
    pub enum Held {
        /// Motion of the centre along the first axis.
        X = "x",
        /// Motion of the centre along the second axis.
        Y = "y",
        /// Motion of the centre along the third axis, in 3D.
        Z = "z",
        /// Rotation.
        Rotation = "rotation",
    }
}

/// Largest time between the last row of a table and the end that is round-off, relative to the end time.
const ROUND_OFF: f64 = 1e-9;

/// A rigid motion: `x(t) = c + d(t) + R(t) (X - c)`, with the velocity
/// `d'(t) + ω(t) × (x - c - d(t))`.
struct GivenMotion<const D: usize> {
    centre: Point<D>,
    path: Box<dyn Fn(f64) -> Pose<D> + Send + Sync>,
}

impl<const D: usize> GivenMotion<D> {
    /// Computes the position of a point of the body from its reference position.
    fn position(&self, reference: &Point<D>, t: f64) -> Point<D> {
        let pose = (self.path)(t);
        let arm = reference - self.centre;
        let (sin, cos) = pose.angle.value.sin_cos();
        let mut turned = arm;
        (turned[0], turned[1]) = (cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]);
        self.centre + pose.offset() + turned
    }

    /// Computes the velocity at time `t` of the point of the body whose position at time `begin` is `at`.
    fn velocity(&self, at: &Point<D>, [begin, t]: [f64; 2]) -> Vector<D> {
        let pose = (self.path)(t);
        let arm = at - self.centre - (self.path)(begin).offset();
        let mut velocity = Vector::<D>::from_fn(|axis, _| pose.displacement[axis].rate);
        velocity[0] -= pose.angle.rate * arm[1];
        velocity[1] += pose.angle.rate * arm[0];
        velocity
    }
}

impl MotionChoice {
    /// Returns the motion of a body whose shape is shifted: a centre of rotation moves with the shape.
    pub(super) fn shifted(&self, shift: Option<&Components<f64>>) -> Self {
        let mut motion = self.clone();
        match (&mut motion, shift) {
            (Self::Rotating { centre, .. }, Some(shift)) => *centre = centre.plus(shift),
            (Self::Formula { centre: Some(centre), .. } | Self::Table { centre: Some(centre), .. }, Some(shift)) => {
                *centre = centre.map(|centre| centre.plus(shift));
            }
            _ => {}
        }
        motion
    }
}

impl GuideKeys {
    /// Builds the motion. The velocity is evaluated until the body is released.
    pub(super) fn guide<const D: usize>(&self, time: &Time) -> Result<Guide<D>, ScenarioError> {
        let guided = Time { end: time.end.min(self.until + *time.step), ..time.clone() };
        let axes = self.velocity.iter().map(|formula| finite(formula, &guided)).collect::<Result<Vec<_>, _>>()?;
        let velocity = Arc::new(move |t| Vector::from_fn(|axis, _| axes[axis].at(&[], t).value));
        Ok(Guide { until: self.until, velocity })
    }
}

/// Message about motions that axisymmetric coordinates exclude.
pub(super) const AXIAL: &str =
    "in axisymmetric coordinates a rigid body moves along the axis only; set other motions to zero, or leave them out";

/// Returns whether a formula is the number zero.
pub(super) fn is_zero(formula: &Formula) -> bool {
    formula.is_constant() && formula.at(&[], 0.0).value == 0.0
}

/// Checks that a given motion in axisymmetric coordinates is one along the axis.
fn check_axial<const D: usize>(motion: &At<MotionChoice>, radial: usize, time: &Time) -> Result<(), ScenarioError> {
    let place = match &**motion {
        MotionChoice::Fixed | MotionChoice::Free { .. } => None,
        MotionChoice::Rotating { angular_velocity, .. } => Some(&angular_velocity.at),
        MotionChoice::Formula { displacement, angle, .. } => {
            let along = displacement.get(radial).filter(|formula| !is_zero(formula));
            along.or(angle.as_ref()).map(|formula| &formula.at)
        }
        MotionChoice::Table { file, .. } => {
            let table = read_table::<D>(file, time)?;
            let at = |k: usize| table.at(k as f64 * *time.step);
            let moves = |pose: Pose<D>| pose.displacement[radial].value != 0.0 || pose.angle.value != 0.0;
            (0..=time.n_steps()).any(|k| moves(at(k))).then_some(&file.at)
        }
    };
    place.map_or(Ok(()), |place| Err(place.invalid(AXIAL)))
}

/// Builds a body with a given motion.
pub(super) fn prescribed<const D: usize>(
    name: &str,
    motion: &At<MotionChoice>,
    time: &Time,
    boundary: BoundaryMesh<D>,
    reference: Vec<Point<D>>,
) -> Result<PrescribedBody<D>, ScenarioError> {
    if let Some(radial) = boundary.coordinates().radial() {
        check_axial::<D>(motion, radial, time)?;
    }
    let motion = match &**motion {
        // Free bodies have no given motion.
        MotionChoice::Fixed | MotionChoice::Free { .. } => {
            GivenMotion { centre: Point::zeros(), path: Box::new(|_| Pose::default()) }
        }
        MotionChoice::Rotating { centre, angular_velocity } => {
            let rate = finite(angular_velocity, time)?;
            let angle = Angle::of(rate, time);
            check_turn(&angular_velocity.at, |t| angle.at(t), time)?;
            if let Some(at) = unresolved(|t| angle.at(t), time) {
                let what = format!("the rotation with `{}`", angular_velocity.text());
                return Err(angular_velocity.at.invalid(too_fast(&what, at, time)));
            }
            let path = move |t| Pose { angle: angle.at(t), ..Pose::default() };
            GivenMotion { centre: centre.vector(), path: Box::new(path) }
        }
        MotionChoice::Formula { displacement, angle, centre } => {
            let axes = displacement.iter().map(|formula| checked(formula, time)).collect::<Result<Vec<_>, _>>()?;
            let turns = |given: &At<Formula>| {
                let formula = checked(given, time)?;
                check_turn(&given.at, |t| formula.at(&[], t), time).map(|()| formula)
            };
            let angle = angle.as_ref().map(turns).transpose()?;
            let centre = turning_centre(motion, centre.as_ref(), angle.is_some())?;
            let path = move |t| Pose {
                displacement: std::array::from_fn(|axis| axes[axis].at(&[], t)),
                angle: angle.as_ref().map_or_else(Dual::default, |formula| formula.at(&[], t)),
            };
            GivenMotion { centre, path: Box::new(path) }
        }
        MotionChoice::Table { file, centre } => {
            let table = read_table(file, time)?;
            check_turn(&file.at, |t| table.at(t).angle, time)?;
            let centre = turning_centre(motion, centre.as_ref(), table.has_angle())?;
            GivenMotion { centre, path: Box::new(move |t| table.at(t)) }
        }
    };
    let motion = Arc::new(motion);
    let position = Arc::clone(&motion);
    Ok(PrescribedBody {
        name: name.to_owned(),
        boundary,
        reference,
        position: Arc::new(move |x, t| position.position(x, t)),
        velocity: Arc::new(move |x, times| motion.velocity(x, times)),
    })
}

/// The angle of a rotation whose angular velocity is given: `φ(t) = ∫_0^t ω ds`.
struct Angle {
    rate: Formula,
    /// Length of an interval: a step, or several steps in runs of more than [`MOST_TRIALS`] steps.
    interval: f64,
    /// Angles at the start and at the ends of intervals; empty if the angular velocity is constant.
    at_ends: Vec<f64>,
}

/// Points and weights of the Gauss rule with three points on `[0, 1]`.
const GAUSS: [[f64; 2]; 3] =
    [[0.112_701_665_379_258_31, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];

impl Angle {
    /// Integrates the angular velocity over the intervals of a run. The last one is continued to later times.
    fn of(rate: Formula, time: &Time) -> Self {
        let n_steps = time.n_steps();
        let stride = n_steps / MOST_TRIALS + 1;
        let (n, interval) = (n_steps / stride, stride as f64 * *time.step);
        let mut angle = Self { rate, interval, at_ends: Vec::new() };
        if !angle.rate.is_constant() {
            let sums = (0..n).scan(0.0, |sum, k| {
                *sum += angle.integral(k as f64 * interval, (k + 1) as f64 * interval);
                Some(*sum)
            });
            angle.at_ends = std::iter::once(0.0).chain(sums).collect();
        }
        angle
    }

    /// Returns the integral of the angular velocity over an interval, by Gauss's rule of degree 5.
    fn integral(&self, begin: f64, end: f64) -> f64 {
        let sum: f64 =
            GAUSS.iter().map(|[at, weight]| weight * self.rate.at(&[], begin + at * (end - begin)).value).sum();
        sum * (end - begin)
    }

    /// Returns angle and angular velocity.
    fn at(&self, t: f64) -> Dual {
        let rate = self.rate.at(&[], t).value;
        let Some(last) = self.at_ends.len().checked_sub(1) else { return Dual { value: rate * t, rate } };
        let k = ((t / self.interval) as usize).min(last);
        Dual { value: self.at_ends[k] + self.integral(k as f64 * self.interval, t), rate }
    }
}

/// Returns the centre of the rotation. It must be given if and only if the motion has an angle.
fn turning_centre<const D: usize>(
    motion: &At<MotionChoice>,
    given: Option<&At<Components<f64>>>,
    has_angle: bool,
) -> Result<Point<D>, ScenarioError> {
    match (given, has_angle) {
        (Some(centre), true) => Ok(centre.vector()),
        (None, false) => Ok(Point::zeros()),
        (None, true) => {
            let value = "a list of numbers, the point about which the angle turns".to_owned();
            Err(motion.at.error(ErrorKind::Needed { key: "centre", value }))
        }
        (Some(centre), false) => Err(centre.at.error(ErrorKind::NoEffect("a motion without an angle"))),
    }
}

/// Largest number of times at which a formula is checked before a run.
const MOST_TRIALS: usize = 100_000;

/// Largest difference between the displacement of a body in a step and the velocity at the end of the step times the
/// length of the step, relative to the largest velocity. It limits the average over all steps, and in a single step the
/// excess over the velocities at both ends. Six steps in a period give 0.5.
const UNRESOLVED: f64 = 0.5;

/// Returns the time of a step that does not resolve a motion along an axis or of an angle, if there is one. The body
/// and the fluid on its surface would have different displacements.
fn unresolved(at: impl Fn(f64) -> Dual, time: &Time) -> Option<f64> {
    let (n_steps, dt) = (time.n_steps(), *time.step);
    let steps = || (0..n_steps).step_by(n_steps / MOST_TRIALS + 1);
    let ends = |k: usize| [at(k as f64 * dt), at((k + 1) as f64 * dt)];
    let mut fastest = 0.0_f64;
    let (mut swept, mut missed, mut farthest) = (0.0, 0.0, 0.0_f64);
    for [begin, end] in steps().map(ends) {
        fastest = fastest.max(begin.rate.abs()).max(end.rate.abs());
        farthest = farthest.max(begin.value.abs()).max(end.value.abs());
        swept += end.rate.abs() * dt;
        missed += (end.value - begin.value - end.rate * dt).abs();
    }
    // Displacements are differences of positions, which have round-off.
    let room = UNRESOLVED * fastest * dt + 1e-12 * farthest;
    let is_jump = |[begin, end]: [Dual; 2]| {
        let moved = end.value - begin.value;
        let (low, high) = (begin.rate.min(end.rate) * dt, begin.rate.max(end.rate) * dt);
        moved < low - room || moved > high + room
    };
    let jump = steps().find(|k| is_jump(ends(*k)));
    let fails = || (missed > UNRESOLVED * swept + 1e-12 * farthest * n_steps as f64).then_some(0);
    jump.or_else(fails).map(|k| k as f64 * dt)
}

/// Largest angle of a rotation in a step, rad: six steps in a turn.
const LARGEST_TURN: f64 = 1.05;

/// Checks that a body turns by less than [`LARGEST_TURN`] in every step, except in steps to states of equilibrium.
fn check_turn(at: &Location, angle: impl Fn(f64) -> Dual, time: &Time) -> Result<(), ScenarioError> {
    if *time.scheme == TimeSchemeChoice::QuasiStatic {
        return Ok(());
    }
    let (n_steps, dt) = (time.n_steps(), *time.step);
    let mut steps = (0..n_steps).step_by(n_steps / MOST_TRIALS + 1).map(|k| k as f64 * dt);
    let turn = |t: f64| (angle(t + dt).value - angle(t).value).abs();
    steps.find(|t| turn(*t) > LARGEST_TURN).map_or(Ok(()), |t| Err(at.invalid(too_far(turn(t), dt))))
}

/// Checks that a free body turns by less than [`LARGEST_TURN`] in the first step.
pub(super) fn check_spin(spin: &At<Spin>, time: &Time) -> Result<(), ScenarioError> {
    let turn = spin.iter().map(|rate| rate * rate).sum::<f64>().sqrt() * *time.step;
    if turn > LARGEST_TURN { Err(spin.at.invalid(too_far(turn, *time.step))) } else { Ok(()) }
}

/// Returns the message about a body that turns too far in a step.
fn too_far(turn: f64, dt: f64) -> String {
    let longest = rounded_down(dt * LARGEST_TURN / turn);
    format!(
        "the body turns by {turn:.2} rad in a step of {dt}; use steps of at most {longest:e}, six in a turn, and better twenty (velocities are in radians per time)"
    )
}

/// Returns the message about a motion that steps do not resolve.
fn too_fast(what: &str, at: f64, time: &Time) -> String {
    let dt = *time.step;
    format!(
        "{what} is not resolved by steps of {dt}: from t = {at} on, displacements in a step and the velocity that the fluid is given differ by more than half; use \
         smaller steps, or a motion without jumps"
    )
}

/// Returns a formula after a check that its value is finite at every step, or at [`MOST_TRIALS`] of them.
pub(super) fn finite(formula: &At<Formula>, time: &Time) -> Result<Formula, ScenarioError> {
    check_finite(formula, time, |at| vec![("value", at.value)], "it is finite")
}

/// Returns a formula after a check that its `numbers` are finite at every step, or at [`MOST_TRIALS`] of them.
fn check_finite(
    formula: &At<Formula>,
    time: &Time,
    numbers: fn(Dual) -> Vec<(&'static str, f64)>,
    aim: &str,
) -> Result<Formula, ScenarioError> {
    let n_steps = time.n_steps();
    for t in (0..=n_steps).step_by(n_steps / MOST_TRIALS + 1).map(|k| k as f64 * *time.step) {
        if let Some((what, number)) = numbers(formula.at(&[], t)).into_iter().find(|(_, number)| !number.is_finite()) {
            let text = formula.text();
            return Err(formula.at.invalid(format!(
                "the {what} of the formula `{text}` at t = {t} is {number}; change it so that {aim} throughout the run"
            )));
        }
    }
    Ok((**formula).clone())
}

/// Returns a formula after a check that its value and rate are finite, and that steps resolve the motion.
fn checked(formula: &At<Formula>, time: &Time) -> Result<Formula, ScenarioError> {
    match unresolved(|t| formula.at(&[], t), time) {
        Some(at) => Err(formula.at.invalid(too_fast(&format!("the formula `{}`", formula.text()), at, time))),
        None => {
            let numbers = |Dual { value, rate }| vec![("value", value), ("derivative", rate)];
            check_finite(formula, time, numbers, "value and derivative are finite")
        }
    }
}

/// Reads a table and checks that it covers the run.
fn read_table<const D: usize>(file: &At<String>, time: &Time) -> Result<MotionTable<D>, ScenarioError> {
    let path = input_path(file);
    let table = MotionTable::read(&path).map_err(|message| file.at.invalid(message))?;
    let ((first, last), end) = (table.range(), time.end);
    if first > 0.0 || last < end * (1.0 - ROUND_OFF) {
        let path = path.display();
        return Err(file.at.invalid(format!(
            "{path}: it covers the times {first} to {last}, but the run needs 0 to {end}; add rows or end earlier"
        )));
    }
    let of_axis = |axis: usize| unresolved(|t| table.at(t).displacement[axis], time);
    let found = (0..D).find_map(of_axis).or_else(|| unresolved(|t| table.at(t).angle, time));
    found.map_or(Ok(table.clone()), |at| Err(file.at.invalid(too_fast("the motion of this table", at, time))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_is_the_rate_of_the_position_of_every_point() {
        let swaying = |t: f64| Pose {
            displacement: [
                Dual { value: 0.4 * (3.0 * t).sin(), rate: 1.2 * (3.0 * t).cos() },
                Dual { value: t * t - 1.0, rate: 2.0 * t },
            ],
            angle: Dual { value: 1.5 * (2.0 * t).cos(), rate: -3.0 * (2.0 * t).sin() },
        };
        let centre = Point::<2>::new(0.3, -0.2);
        let motion = GivenMotion { centre, path: Box::new(swaying) };
        for x in [centre, Point::<2>::new(1.0, 2.0), Point::<2>::new(-0.7, 0.1)] {
            for t in [0.0, 0.3, 1.7] {
                let at = |t: f64| motion.position(&x, t);
                let difference = (at(t + 1e-5) - at(t - 1e-5)) / 2e-5;
                let velocity = motion.velocity(&at(t), [t; 2]);
                assert!((velocity - difference).norm() < 1e-8, "{velocity} {difference}");
                // The velocity at earlier positions keeps all distances from the centre, which moves as at the end.
                let (before, middle) = (at(t - 0.1), motion.position(&centre, t - 0.1));
                let of_centre = motion.velocity(&middle, [t - 0.1, t]);
                let relative = motion.velocity(&before, [t - 0.1, t]) - of_centre;
                assert!(relative.dot(&(before - middle)).abs() < 1e-13);
                let at_end = motion.velocity(&motion.position(&centre, t), [t; 2]);
                assert!((of_centre - at_end).norm() < 1e-13);
                let arm = at(t) - motion.position(&centre, t);
                assert!((arm.norm() - (x - centre).norm()).abs() < 1e-14);
            }
        }
        let quarter = |_| Pose { angle: Dual { value: std::f64::consts::FRAC_PI_2, rate: 0.0 }, ..Pose::default() };
        let turned = GivenMotion { centre, path: Box::new(quarter) }.position(&(centre + Vector::<2>::x()), 1.0);
        assert!((turned - centre - Vector::<2>::y()).norm() < 1e-15, "counter-clockwise");
    }
}
