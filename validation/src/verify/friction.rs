//! Coulomb friction: blocks on a slope that stick and that slide, elastic and rigid, and a block that comes to rest on
//! a floor.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::contact::{AugmentedLagrangianLaw, ContactForm, NitscheLaw, RigidPlane};
use cutwater::mesh::generate::structured_box;
use cutwater::mesh::{Point, Vector};
use cutwater::solid_rigid::RigidBody;
use cutwater::solid_svk::{LameParameters, LinearElastic};
use cutwater::solver::ContactObstacle;

use super::dry::{Touch, elastic, run, run_of};
use super::{Failure, Record};

// Gravity, density, Young's modulus, and Poisson's ratio: under its weight the block becomes shorter by 2.5e-4 of its
// height.
const GRAVITY: f64 = 10.0;
const DENSITY: f64 = 1.0;
const YOUNG: f64 = 1e4;
const POISSON: f64 = 0.3;
/// Height of the block. It is four times as wide, so that it does not topple.
const HEIGHT: f64 = 0.5;
/// Angle of the slope, radians: its tangent is 0.577.
const SLOPE: f64 = std::f64::consts::FRAC_PI_6;
const STEP: f64 = 1e-3;
/// Time after which the vibration of the block that has been put down has faded: 15 periods.
const FADED: f64 = 0.25;
/// Relative tolerance of accelerations, distances and forces.
const TOLERANCE: f64 = 0.01;
/// Largest displacement of a block that sticks, relative to its displacement without friction.
const DRIFT: f64 = 1e-3;
/// Relative tolerance of the motion and the multipliers of the rigid block. Its motion is exact up to the tolerance of
/// the multipliers.
const RIGID_TOLERANCE: f64 = 1e-6;

/// Displacement and velocity of the centre of mass, and the tangential force of contact over the weight.
struct BlockMotion<const D: usize> {
    displacement: Vector<D>,
    velocity: Vector<D>,
    tangential: f64,
}

/// A block on the plane whose last coordinate is zero, with the coefficient of friction, the direction of gravity and
/// the initial velocity.
struct SlopeBlock<const D: usize> {
    friction: f64,
    down: Vector<D>,
    velocity: Vector<D>,
    cells: usize,
}

impl<const D: usize> SlopeBlock<D> {
    /// Computes the motion at the given times.
    fn at<const N: usize>(&self, times: [f64; N]) -> Result<[BlockMotion<D>; N], Failure> {
        let corner = std::array::from_fn(|axis| if axis == D - 1 { HEIGHT } else { 4.0 * HEIGHT });
        let n = std::array::from_fn(|axis| if axis == D - 1 { self.cells } else { 4 * self.cells });
        let mesh = structured_box::<D>([0.0; D], corner, n)?;
        let material = LinearElastic::new(LameParameters::from_young_poisson(YOUNG, POISSON)?);
        let mut body = elastic(mesh, DENSITY, material, self.down * GRAVITY, Arc::new(ImplicitEuler))?;
        let velocity = self.velocity;
        body.options.initial_velocity = Some(Arc::new(move |_| velocity));
        let law = NitscheLaw::new(10.0, 0.0, self.friction)?;
        let mut into = Vector::<D>::zeros();
        into[D - 1] = -1.0;
        let floor = Touch {
            facets: body.part("bottom")?,
            form: ContactForm::new(law, 0.1)?,
            obstacle: ContactObstacle::Rigid(Box::new(RigidPlane::new(Point::zeros(), into)?)),
        };
        let mut run = run(vec![body], Some(floor), STEP, 1e-9)?;
        let mass = DENSITY * corner.iter().product::<f64>();
        let (mut displacement, mut found) = (Vector::zeros(), Vec::new());
        for time in times {
            let mut last = None;
            while run.state.time < time - 0.5 * STEP {
                let report = run.advance()?;
                let momentum = report.bodies[0].balance.ok_or("an elastic body has a mass")?.momentum;
                displacement += momentum * (STEP / mass);
                last = Some((momentum / mass, report.contacts[0].force));
            }
            let (velocity, force) = last.ok_or("times increase")?;
            let tangential = (0..D - 1).map(|axis| force[axis] * force[axis]).sum::<f64>().sqrt() / (mass * GRAVITY);
            found.push(BlockMotion { displacement, velocity, tangential });
        }
        found.try_into().map_err(|_| "one state for each time".into())
    }
}

/// Records a block on the slope whose friction holds it, and one whose friction does not.
fn slope<const D: usize>(record: &mut Record, cells: usize, along: Vector<D>) -> Result<(), Failure> {
    let mut down = along * SLOPE.sin();
    down[D - 1] = -SLOPE.cos();
    let block = |friction| SlopeBlock { friction, down, velocity: Vector::zeros(), cells };
    let space = if D == 2 { "plane" } else { "space" };

    let [first, last] = block(0.3).at([FADED, 2.0 * FADED])?;
    let acceleration = (last.velocity - first.velocity) / FADED;
    let exact = GRAVITY * (SLOPE.sin() - 0.3 * SLOPE.cos());
    let name = format!("{space}, coefficient 0.3, slope of 30°: acceleration along the slope");
    record.near_relative(name, acceleration.dot(&along), exact, TOLERANCE);
    let across = (acceleration - along * acceleration.dot(&along)).norm() / exact;
    record.at_most(format!("{space}, the same: acceleration in other directions, relative"), across, TOLERANCE);

    let [first, last] = block(0.7).at([FADED, 2.0 * FADED])?;
    let free = 0.5 * GRAVITY * SLOPE.sin() * (2.0 * FADED).powi(2);
    let drift = (last.displacement - first.displacement).norm() / free;
    let name = format!("{space}, coefficient 0.7: motion in the second half over the way without friction");
    record.at_most(name, drift, DRIFT);
    let name = format!("{space}, coefficient 0.7: force of friction over the weight");
    record.near_relative(name, last.tangential, SLOPE.sin(), TOLERANCE);
    Ok(())
}

/// Records a rigid block on the slope, by the augmented Lagrangian with two parameters.
fn rigid_slope<const D: usize>(record: &mut Record, along: Vector<D>) -> Result<(), Failure> {
    let mut down = along * SLOPE.sin();
    down[D - 1] = -SLOPE.cos();
    let corner: [f64; D] = std::array::from_fn(|axis| if axis == D - 1 { HEIGHT } else { 4.0 * HEIGHT });
    let mesh = structured_box::<D>([0.0; D], corner, [2; D])?;
    let bottom = mesh.tag("bottom").ok_or("a box has a bottom")?;
    let mass = DENSITY * corner.iter().product::<f64>();
    let end = 2.0 * FADED;
    let space = if D == 2 { "plane" } else { "space" };
    // The inertia of the block against a motion in one step, per area.
    let inertia = DENSITY * HEIGHT / (STEP * STEP);
    for factor in [10.0, 100.0] {
        let motion = |friction: f64| -> Result<(Vector<D>, f64, f64), Failure> {
            let body = RigidBody::new("block", mesh.boundary(), mesh.vertices().to_vec(), DENSITY, down * GRAVITY)?;
            let facets = body.boundary.facets().filter(|f| body.boundary.tag(*f) == Some(bottom)).collect();
            let law = AugmentedLagrangianLaw::new(factor * inertia, 0.0, friction, RIGID_TOLERANCE)?;
            let mut into = Vector::<D>::zeros();
            into[D - 1] = -1.0;
            let obstacle = ContactObstacle::Rigid(Box::new(RigidPlane::new(Point::zeros(), into)?));
            let touch = Touch { facets, form: ContactForm::new(law, 1.0)?, obstacle };
            let mut run = run_of(vec![Arc::new(body)], Some(touch), Arc::new(ImplicitEuler), [STEP, 1e-9])?;
            let mut last = run.advance()?;
            while run.state.time < end - 0.5 * STEP {
                last = run.advance()?;
            }
            let velocity = last.bodies[0].balance.ok_or("a free body has a mass")?.momentum / mass;
            let gap = last.contacts[0].minimum_gap.ok_or("a plane has a gap")?;
            Ok((velocity, last.contacts[0].force.dot(&-along) / (mass * GRAVITY), gap))
        };
        let name = format!("rigid block, {space}, parameter {factor} times its inertia");
        let (velocity, force, gap) = motion(0.3)?;
        let exact = along * (end * GRAVITY * (SLOPE.sin() - 0.3 * SLOPE.cos()));
        let error = (velocity - exact).norm() / exact.norm();
        record.at_most(format!("{name}, coefficient 0.3: error of the velocity, relative"), error, RIGID_TOLERANCE);
        record.near_relative(format!("{name}: friction over the weight"), force, 0.3 * SLOPE.cos(), RIGID_TOLERANCE);
        record.at_most(format!("{name}: distance from the plane over the height"), gap.abs() / HEIGHT, RIGID_TOLERANCE);
        let (velocity, force, _) = motion(0.7)?;
        let free = end * GRAVITY * SLOPE.sin();
        let drift = velocity.norm() / free;
        record.at_most(format!("{name}, coefficient 0.7: speed over that without friction"), drift, RIGID_TOLERANCE);
        record.near_relative(format!("{name}: friction over the weight"), force, SLOPE.sin(), RIGID_TOLERANCE);
    }
    Ok(())
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let cells = if record.full { 8 } else { 4 };
    slope::<2>(record, cells, Vector::<2>::new(1.0, 0.0))?;
    if record.full {
        // A direction along neither axis nor diagonal of the mesh.
        slope::<3>(record, 2, Vector::<3>::new(0.8, -0.6, 0.0))?;
    }
    rigid_slope(record, Vector::<2>::new(1.0, 0.0))?;
    rigid_slope(record, Vector::<3>::new(0.8, -0.6, 0.0))?;
    let (speed, friction) = (1.0, 0.3);
    let thrown =
        SlopeBlock { friction, down: Vector::<2>::new(0.0, -1.0), velocity: Vector::<2>::new(speed, 0.0), cells };
    let [last] = thrown.at([2.0 * speed / (friction * GRAVITY)])?;
    let distance = speed * speed / (2.0 * friction * GRAVITY);
    record.near_relative("thrown along a floor: distance until it rests", last.displacement[0], distance, TOLERANCE);
    record.at_most("thrown along a floor: speed after twice the time", last.velocity.norm(), DRIFT * speed);
    record.note(
        "Exact: the motion of a rigid block. Elastic blocks, four times as wide as high; Nitsche's law with gamma_0 = 10, implicit Euler. The blocks are put down without \
         deformation and vibrate at first. Rigid blocks have the augmented Lagrangian. With a parameter of 1000 times the inertia Newton's method does not find \
         the state in which the block sticks in space.",
    );
    Ok(())
}
