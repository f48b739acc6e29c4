//! Motions of bodies that do not deform.

use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;

use mesh::{BoundaryMesh, Point, Vector};
use solver::body::PrescribedBody;

use super::error::{ErrorKind, ScenarioError};
use super::formula::{Dual, Formula};
use super::key::Quantity;
use super::motion_table::{Pose, Table, TableError};
use super::solver::Time;
use super::table::{At, Components, choices};

choices! {
    /// Motion of a body that does not deform; angles are in radians, counter-clockwise.
    pub enum Motion ["kind"] {
        /// At rest: an obstacle.
        Fixed = "fixed",
        /// Steady rotation, from the start.
        Rotating = "rotating" {
            /// Centre of the rotation.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Angular velocity.
            angular_velocity: f64 [unit(Quantity::RATE)],
        },
        /// Formulas in the time `t`.
        Formula = "formula" {
            /// Displacement from the place of the shape.
            displacement: Components<At<Formula>> [unit(Quantity::LENGTH)],
            /// Angle about the centre; no rotation if left out.
            angle: Option<At<Formula>>,
            /// Centre of the rotation before the displacement, with `angle`.
            centre: Option<At<Components<f64>>> [unit(Quantity::LENGTH)],
        },
        /// Free rigid body, moved by its weight, the fluid and contacts; with `density` and `gravity`.
        Free = "free" {
            /// Motions that are held.
            held: Vec<At<Held>>,
            /// Angular velocity at the start; none if left out.
            initial_spin: Option<At<f64>> [unit(Quantity::RATE)],
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

/// Largest part of the end time by which the last row of a table may come too early: round-off.
const ROUND_OFF: f64 = 1e-9;

/// Position and angle of a rigid body as functions of time.
enum Path<const D: usize> {
    Fixed,
    Rotating { angular_velocity: f64 },
    Formula { displacement: Vec<Formula>, angle: Option<Formula> },
    Table(Table<D>),
}

impl<const D: usize> Path<D> {
    fn at(&self, t: f64) -> Pose<D> {
        match self {
            Self::Fixed => Pose::default(),
            Self::Rotating { angular_velocity } => {
                Pose { angle: angular_velocity * t, angular_velocity: *angular_velocity, ..Pose::default() }
            }
            Self::Formula { displacement, angle } => {
                let mut pose = Pose::default();
                for (axis, formula) in displacement.iter().enumerate() {
                    let Dual { value, rate } = formula.at(&[], t);
                    (pose.displacement[axis], pose.velocity[axis]) = (value, rate);
                }
                if let Some(formula) = angle {
                    let Dual { value, rate } = formula.at(&[], t);
                    (pose.angle, pose.angular_velocity) = (value, rate);
                }
                pose
            }
            Self::Table(table) => table.at(t),
        }
    }
}

/// A rigid motion: `x(t) = c + d(t) + R(t) (X - c)`, with the velocity
/// `d'(t) + ω(t) × (x - c - d(t))`.
struct GivenMotion<const D: usize> {
    centre: Point<D>,
    path: Path<D>,
}

impl<const D: usize> GivenMotion<D> {
    /// Computes the position of a point of the body from its reference position.
    fn position(&self, reference: &Point<D>, t: f64) -> Point<D> {
        let pose = self.path.at(t);
        let arm = reference - self.centre;
        let (sin, cos) = pose.angle.sin_cos();
        let mut turned = arm;
        (turned[0], turned[1]) = (cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]);
        self.centre + pose.displacement + turned
    }

    /// Computes the velocity at time `t` of the point of the body whose position at time `begin` is `at`.
    fn velocity(&self, at: &Point<D>, [begin, t]: [f64; 2]) -> Vector<D> {
        let pose = self.path.at(t);
        let arm = at - self.centre - self.path.at(begin).displacement;
        let mut velocity = pose.velocity;
        velocity[0] -= pose.angular_velocity * arm[1];
        velocity[1] += pose.angular_velocity * arm[0];
        velocity
    }
}

/// Builds a body with a given motion.
pub(super) fn prescribed<const D: usize>(
    name: &str,
    motion: &At<Motion>,
    time: &Time,
    (boundary, reference): (BoundaryMesh<D>, Vec<Point<D>>),
) -> Result<PrescribedBody<D>, ScenarioError> {
    let (path, centre) = match &**motion {
        // Free bodies have no given motion.
        Motion::Fixed | Motion::Free { .. } => (Path::Fixed, Point::zeros()),
        Motion::Rotating { centre, angular_velocity } => {
            (Path::Rotating { angular_velocity: *angular_velocity }, centre.vector())
        }
        Motion::Formula { displacement, angle, centre } => {
            let displacement = displacement.iter().map(|formula| checked(formula, time)).collect::<Result<_, _>>()?;
            let angle = angle.as_ref().map(|formula| checked(formula, time)).transpose()?;
            let centre = turning_centre(motion, centre.as_ref(), angle.is_some())?;
            (Path::Formula { displacement, angle }, centre)
        }
        Motion::Table { file, centre } => {
            let table = read_table(file, time)?;
            let centre = turning_centre(motion, centre.as_ref(), table.has_angle())?;
            (Path::Table(table), centre)
        }
    };
    let motion = Arc::new(GivenMotion { centre, path });
    let position = Arc::clone(&motion);
    Ok(PrescribedBody {
        name: name.to_owned(),
        boundary,
        reference,
        position: Arc::new(move |x, t| position.position(x, t)),
        velocity: Arc::new(move |x, times| motion.velocity(x, times)),
    })
}

/// Returns the centre of the rotation, which must be given if and only if the motion has an angle.
fn turning_centre<const D: usize>(
    motion: &At<Motion>,
    given: Option<&At<Components<f64>>>,
    has_angle: bool,
) -> Result<Point<D>, ScenarioError> {
    match (given, has_angle) {
        (Some(centre), true) => Ok(centre.vector()),
        (None, false) => Ok(Point::zeros()),
        (None, true) => Err(motion.at.error(ErrorKind::Missing("centre"))),
        (Some(centre), false) => Err(centre.at.error(ErrorKind::NoEffect("a motion without an angle"))),
    }
}

/// Largest number of times at which a formula is checked before a run.
const MOST_TRIALS: usize = 100_000;

/// Checks that value and rate of a formula are finite at every step, or at [`MOST_TRIALS`] of them.
fn checked(formula: &At<Formula>, time: &Time) -> Result<Formula, ScenarioError> {
    let n_steps = time.n_steps();
    for t in (0..=n_steps).step_by(n_steps / MOST_TRIALS + 1).map(|k| k as f64 * *time.step) {
        let Dual { value, rate } = formula.at(&[], t);
        for (what, number) in [("value", value), ("derivative", rate)] {
            if !number.is_finite() {
                let text = formula.text();
                return Err(formula.at.invalid(format!(
                    "the {what} of the formula `{text}` at t = {t} is {number}; change it so that value and derivative \
                     are finite throughout the run"
                )));
            }
        }
    }
    Ok((**formula).clone())
}

/// Reads a table and checks that it covers the run.
fn read_table<const D: usize>(file: &At<String>, time: &Time) -> Result<Table<D>, ScenarioError> {
    let path = table_path(file);
    let table = Table::read(&path).map_err(|error| file.at.error(error))?;
    let ((first, last), end) = (table.range(), time.end);
    if first > 0.0 || last < end * (1.0 - ROUND_OFF) {
        let what =
            format!("it covers the times {first} to {last}, but the run needs 0 to {end}; add rows or end earlier");
        return Err(file.at.error(TableError { path, line: None, what }));
    }
    Ok(table)
}

/// Returns the path of a table, whose name is relative to the scenario.
pub(super) fn table_path(file: &At<String>) -> PathBuf {
    file.at.file.parent().unwrap_or(FilePath::new("")).join(file.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula(text: &str) -> Formula {
        Formula::parse(text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn velocity_is_the_rate_of_the_position_of_every_point() {
        let centre = Point::<2>::new(0.3, -0.2);
        let displacement = vec![formula("0.4*sin(3*t)"), formula("t^2 - 1")];
        let swaying = Path::Formula { displacement, angle: Some(formula("1.5*cos(2*t)")) };
        for path in [Path::Fixed, Path::Rotating { angular_velocity: -2.5 }, swaying] {
            let motion = GivenMotion { centre, path };
            for x in [centre, Point::<2>::new(1.0, 2.0), Point::<2>::new(-0.7, 0.1)] {
                for t in [0.0, 0.3, 1.7] {
                    let h = 1e-5;
                    let difference = (motion.position(&x, t + h) - motion.position(&x, t - h)) / (2.0 * h);
                    let velocity = motion.velocity(&motion.position(&x, t), [t; 2]);
                    assert!((velocity - difference).norm() < 1e-8, "{velocity} {difference}");
                    // The velocity at earlier positions keeps all distances from the centre.
                    let before = motion.position(&x, t - 0.1) - motion.position(&centre, t - 0.1);
                    let relative = motion.velocity(&motion.position(&x, t - 0.1), [t - 0.1, t])
                        - motion.velocity(&motion.position(&centre, t - 0.1), [t - 0.1, t]);
                    assert!(relative.dot(&before).abs() < 1e-13);
                    assert!(
                        (motion.velocity(&motion.position(&centre, t - 0.1), [t - 0.1, t])
                            - motion.velocity(&motion.position(&centre, t), [t; 2]))
                        .norm()
                            < 1e-13
                    );
                    let arm = motion.position(&x, t) - motion.position(&centre, t);
                    assert!((arm.norm() - (x - centre).norm()).abs() < 1e-14);
                }
            }
        }
        let quarter = GivenMotion { centre, path: Path::Rotating { angular_velocity: std::f64::consts::FRAC_PI_2 } };
        let turned = quarter.position(&(centre + Vector::<2>::new(1.0, 0.0)), 1.0);
        assert!((turned - centre - Vector::<2>::new(0.0, 1.0)).norm() < 1e-15, "counter-clockwise");
    }
}
