//! Bodies that do not deform: those whose motion a scenario prescribes, where they are, and how fast, at any time; and free ones.

mod formula;
mod table;

use std::path::PathBuf;
use std::sync::Arc;

use mesh::{BoundaryMesh, Point, SimplexMesh, Vector, VertexId};
use solver::solid_rigid::modes::n_rotations;
use solver::{BodyKind, PrescribedBody, RigidBody};

use super::ScenarioFile;
use super::lower::vector;
use super::problem::{Problem, ScenarioError};
use super::schema::{self, Held, Motion};
use formula::{Dual, Formula};
use table::Table;

pub use formula::FormulaError;
pub use table::TableError;

/// Largest part of the end time by which the last row of a table may come too early: round-off.
const ROUND_OFF: f64 = 1e-9;

/// How far a rigid body has moved and turned, and how fast it moves and turns.
///
/// It turns counter-clockwise in the plane of the first two axes; angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose<const D: usize> {
    displacement: Vector<D>,
    velocity: Vector<D>,
    angle: f64,
    angular_velocity: f64,
}

impl<const D: usize> Default for Pose<D> {
    fn default() -> Self {
        Self { displacement: Vector::zeros(), velocity: Vector::zeros(), angle: 0.0, angular_velocity: 0.0 }
    }
}

/// What gives the pose at a time.
enum Path<const D: usize> {
    Fixed,
    Rotating { angular_velocity: f64 },
    Formula { displacement: [Formula; D], angle: Option<Formula> },
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
                    let Dual { value, rate } = formula.at(t);
                    (pose.displacement[axis], pose.velocity[axis]) = (value, rate);
                }
                if let Some(formula) = angle {
                    let Dual { value, rate } = formula.at(t);
                    (pose.angle, pose.angular_velocity) = (value, rate);
                }
                pose
            }
            Self::Table(table) => table.at(t),
        }
    }
}

/// A motion that keeps all distances: `x(t) = c + d(t) + R(t) (X - c)`, with the velocity
/// `d'(t) + ω(t) × (x - c - d(t))`.
struct GivenMotion<const D: usize> {
    centre: Point<D>,
    path: Path<D>,
}

impl<const D: usize> GivenMotion<D> {
    fn position(&self, reference: &Point<D>, t: f64) -> Point<D> {
        let pose = self.path.at(t);
        let arm = reference - self.centre;
        let (sin, cos) = pose.angle.sin_cos();
        let mut turned = arm;
        (turned[0], turned[1]) = (cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]);
        self.centre + pose.displacement + turned
    }

    /// Velocity for time `t` of a point of the body that is at `at` at the time `begin`.
    fn velocity(&self, at: &Point<D>, [begin, t]: [f64; 2]) -> Vector<D> {
        let pose = self.path.at(t);
        let arm = at - self.centre - self.path.at(begin).displacement;
        let mut velocity = pose.velocity;
        velocity[0] -= pose.angular_velocity * arm[1];
        velocity[1] += pose.angular_velocity * arm[0];
        velocity
    }
}

/// Body `index`, which does not deform: with the motion that is given, or free.
pub(super) fn undeformed<const D: usize>(
    file: &ScenarioFile,
    index: usize,
    motion: &Motion,
    shape: &SimplexMesh<D>,
) -> Result<BodyKind<D>, ScenarioError> {
    let path = format!("body.{index}.motion");
    let (boundary, reference) = surface(shape);
    let motion = match motion {
        Motion::Free { held, initial_spin } => {
            let body = free(file, index, (boundary, reference), held, *initial_spin)?;
            return Ok(BodyKind::Rigid(Box::new(body)));
        }
        Motion::Fixed {} => GivenMotion { centre: Point::zeros(), path: Path::Fixed },
        Motion::Rotating { centre, angular_velocity } => GivenMotion {
            centre: vector(file, &format!("{path}.centre"), centre)?,
            path: Path::Rotating { angular_velocity: *angular_velocity },
        },
        Motion::Formula { displacement, angle, centre } => {
            formulas(file, &path, displacement, angle.as_ref(), centre.as_ref())?
        }
        Motion::Table { file: name, centre } => {
            let table = read_table(file, &format!("{path}.file"), name)?;
            GivenMotion {
                centre: turning_centre(file, &path, centre.as_ref(), table.turns())?,
                path: Path::Table(table),
            }
        }
    };
    let motion = Arc::new(motion);
    let position = Arc::clone(&motion);
    Ok(BodyKind::Prescribed(PrescribedBody {
        boundary,
        reference,
        position: Arc::new(move |x, t| position.position(x, t)),
        velocity: Arc::new(move |x, times| motion.velocity(x, times)),
    }))
}

/// A free rigid body.
fn free<const D: usize>(
    file: &ScenarioFile,
    index: usize,
    (boundary, reference): (BoundaryMesh<D>, Vec<Point<D>>),
    held: &[Held],
    initial_spin: Option<f64>,
) -> Result<RigidBody<D>, ScenarioError> {
    let given: &schema::Body = &file.scenario().bodies[index];
    let path = |key: &str| format!("body.{index}.{key}");
    let missing = |key: &str| file.missing(&format!("body.{index}"), key);
    let density = given.density.ok_or_else(|| missing("density"))?;
    let gravity = vector(file, &path("gravity"), given.gravity.as_ref().ok_or_else(|| missing("gravity"))?)?;
    let mut body = RigidBody::new(boundary, reference, density, gravity).map_err(|e| file.error(&path("shape"), e))?;
    for (k, motion) in held.iter().enumerate() {
        let axis = match motion {
            Held::X => 0,
            Held::Y => 1,
            Held::Z => 2,
            Held::Rotation => {
                body.holds_rotation = true;
                continue;
            }
        };
        let Some(slot) = body.held_axes.get_mut(axis) else {
            let with = "two dimensions";
            return Err(file.error(&path(&format!("motion.held.{k}")), Problem::NoEffect { with }));
        };
        *slot = true;
    }
    let mut spin = [0.0; 3];
    // The plane of the first two axes: the only rotation in 2D, the last one in 3D.
    spin[n_rotations(D) - 1] = initial_spin.unwrap_or_default();
    body.initial_spin = spin;
    if let Some(velocity) = &given.initial_velocity {
        body.initial_velocity = vector(file, &path("initial_velocity"), velocity)?;
    }
    // What is held does not move at the start either.
    for (axis, velocity) in body.initial_velocity.iter().enumerate() {
        if body.held_axes[axis] && *velocity != 0.0 {
            let with = "an axis that is held";
            return Err(file.error(&path(&format!("initial_velocity.{axis}")), Problem::NoEffect { with }));
        }
    }
    if body.holds_rotation && initial_spin.is_some_and(|spin| spin != 0.0) {
        return Err(file.error(&path("motion.initial_spin"), Problem::NoEffect { with: "a rotation that is held" }));
    }
    Ok(body)
}

/// The surface of a mesh with its own vertices.
fn surface<const D: usize>(mesh: &SimplexMesh<D>) -> (BoundaryMesh<D>, Vec<Point<D>>) {
    let whole = mesh.boundary();
    let mut numbers: Vec<Option<VertexId>> = vec![None; mesh.n_vertices()];
    let mut reference = Vec::new();
    let mut facets = Vec::with_capacity(D * whole.n_facets());
    for vertex in whole.facets().flat_map(|facet| whole.facet(facet)) {
        facets.push(*numbers[vertex.index()].get_or_insert_with(|| {
            reference.push(mesh.vertex(*vertex));
            VertexId::new(reference.len() - 1)
        }));
    }
    (BoundaryMesh::from_facets(facets), reference)
}

/// The centre about which a body turns; without an angle nothing would look at it.
fn turning_centre<const D: usize>(
    file: &ScenarioFile,
    path: &str,
    given: Option<&Vec<f64>>,
    turns: bool,
) -> Result<Point<D>, ScenarioError> {
    let at = format!("{path}.centre");
    match (given, turns) {
        (Some(centre), true) => vector(file, &at, centre),
        (None, false) => Ok(Point::zeros()),
        (None, true) => Err(file.missing(path, "centre")),
        (Some(_), false) => Err(file.error(&at, Problem::NoEffect { with: "a motion without an angle" })),
    }
}

/// A motion by formulas.
fn formulas<const D: usize>(
    file: &ScenarioFile,
    path: &str,
    displacement: &[String],
    angle: Option<&String>,
    centre: Option<&Vec<f64>>,
) -> Result<GivenMotion<D>, ScenarioError> {
    let formula = |key: &str, text: &String| read_formula(file, &format!("{path}.{key}"), text);
    let read = displacement.iter().enumerate().map(|(k, text)| formula(&format!("displacement.{k}"), text));
    let read: Vec<Formula> = read.collect::<Result<_, _>>()?;
    let wrong = || Problem::Components { found: displacement.len(), dimension: D };
    let displacement = read.try_into().map_err(|_| file.error(&format!("{path}.displacement"), wrong()))?;
    let angle = angle.map(|text| formula("angle", text)).transpose()?;
    let centre = turning_centre(file, path, centre, angle.is_some())?;
    Ok(GivenMotion { centre, path: Path::Formula { displacement, angle } })
}

/// Most times at which a formula is tried before a run.
const MOST_TRIALS: usize = 100_000;

/// A formula that has a finite value and a finite rate at every step, or at many if there are very many.
fn read_formula(file: &ScenarioFile, path: &str, text: &str) -> Result<Formula, ScenarioError> {
    let formula = Formula::parse(text).map_err(|e| file.error(path, e))?;
    let step = file.scenario().time.step;
    let stride = file.n_steps() / MOST_TRIALS + 1;
    for time in (0..=file.n_steps()).step_by(stride).map(|k| k as f64 * step) {
        let Dual { value, rate } = formula.at(time);
        for (what, number) in [("value", value), ("derivative", rate)] {
            if !number.is_finite() {
                let formula = formula.text().to_owned();
                return Err(file.error(path, Problem::FormulaValue { formula, what, number, time }));
            }
        }
    }
    Ok(formula)
}

/// A table that covers the run.
fn read_table<const D: usize>(file: &ScenarioFile, path: &str, name: &str) -> Result<Table<D>, ScenarioError> {
    let found = table_path(file, name);
    let table = Table::read(&found).map_err(|e| file.error(path, e))?;
    let ((first, last), end) = (table.range(), file.scenario().time.end);
    if first > 0.0 || last < end * (1.0 - ROUND_OFF) {
        let what =
            format!("it covers the times {first} to {last}, but the run needs 0 to {end}; add rows or end earlier");
        return Err(file.error(path, TableError { path: found, line: None, what }));
    }
    Ok(table)
}

/// Where a table lies: relative to the scenario.
pub(super) fn table_path(file: &ScenarioFile, name: &str) -> PathBuf {
    file.document.file().parent().map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula(text: &str) -> Formula {
        Formula::parse(text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn velocity_is_the_rate_of_the_position_of_every_point() {
        let centre = Point::<2>::new(0.3, -0.2);
        let displacement = [formula("0.4*sin(3*t)"), formula("t^2 - 1")];
        let swaying = Path::Formula { displacement, angle: Some(formula("1.5*cos(2*t)")) };
        for path in [Path::Fixed, Path::Rotating { angular_velocity: -2.5 }, swaying] {
            let motion = GivenMotion { centre, path };
            for x in [centre, Point::<2>::new(1.0, 2.0), Point::<2>::new(-0.7, 0.1)] {
                for t in [0.0, 0.3, 1.7] {
                    let h = 1e-5;
                    let difference = (motion.position(&x, t + h) - motion.position(&x, t - h)) / (2.0 * h);
                    let velocity = motion.velocity(&motion.position(&x, t), [t; 2]);
                    assert!((velocity - difference).norm() < 1e-8, "{velocity} {difference}");
                    // Where it was before, with the velocity of now: no point is nearer to the centre than it was.
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
