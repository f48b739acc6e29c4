//! A heavy disk sinks in a closed box, as a free rigid body.

use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{Size, graded_box, mirrored};
use cutwater::solid_rigid::RigidMotion;
use cutwater::solver::{FluidBoundary, Setup, Stabilisation};

use super::flow::{disk, fluid_mut, rigid_polygon};
use super::linear_flow::still;
use super::{DirectRun, Failure, P, Record, V, short};
use crate::units::cgs;

/// Width and height of the box, cm.
const BOX: [f64; 2] = [2.0, 6.0];
const DIAMETER: f64 = 0.25;
const START: [f64; 2] = [1.0, 4.0];
/// Density of the disk; that of the fluid is one.
const DENSITY: f64 = 1.25;
const VISCOSITY: f64 = 0.1;
const GRAVITY: f64 = 981.0;
// Published largest Reynolds numbers, with the density of the disk: the middle of 17.15 to 17.45, half of the
// distance, and what is allowed beyond.
const REYNOLDS: f64 = 17.3;
const SPREAD: f64 = 0.15;
const ACCURACY: f64 = 0.03;

/// Measures the sinking disk on several meshes, and with several time steps.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    // Cells across the disk, and time step.
    let runs: &[(f64, f64)] = if record.full {
        &[(8.0, 2e-3), (12.0, 2e-3), (16.0, 2e-3), (16.0, 4e-3), (16.0, 1e-3)]
    } else {
        &[(8.0, 4e-3)]
    };
    let mut curves = Vec::new();
    for &(cells, dt) in runs {
        let fall = sink(DIAMETER / cells, dt, Stabilisation::STANDARD)?;
        let name = format!("{} cells across the disk, dt = {} s", short(cells), short(dt));
        let largest = largest(&fall);
        record.near(
            format!("largest Re, density of the disk, {name}"),
            largest,
            REYNOLDS,
            SPREAD + ACCURACY * REYNOLDS,
        );
        record.show(format!("the same with the density of the fluid, {name}"), largest / DENSITY, None);
        let speed = VISCOSITY / (DENSITY * DIAMETER);
        record.show(cgs(&format!("largest speed [<velocity>], {name}")), speed * largest, Some(speed * REYNOLDS));
        record.show(format!("largest drift to the side over the diameter, {name}"), fall.drift / DIAMETER, Some(0.0));
        record.show(format!("angle turned at the end [rad], {name}"), fall.angle, Some(0.0));
        record.at_most(
            format!("weight, fluid and inertia of the disk: remainder over the weight, {name}"),
            fall.remainder,
            1e-6,
        );
        curves.push((name, fall.reynolds));
    }
    let (cells, dt) = runs[0];
    let fall = sink(DIAMETER / cells, dt, Stabilisation::PAPER_44_2019)?;
    let name = format!("{} cells across the disk, dt = {} s, the paper's set", short(cells), short(dt));
    record.show(format!("largest Re, density of the disk, {name}"), largest(&fall), Some(REYNOLDS));
    curves.push((name, fall.reynolds));
    record.figure("Reynolds number of the sinking disk", "time [s]", curves);
    record.note(
        "Case A of Glowinski et al. 2001, doi:10.1006/jcph.2000.6542: density 1.25, diameter 0.25 cm, viscosity 0.1, \
         box of 2 x 6 cm, g = 981 cm/s² on both phases; until the centre is two and a half diameters above the \
         floor. Published values 17.15 to 17.45; 3 % are allowed beyond.",
    );
    record.note(
        "The Reynolds number is that of the publications, with the density of the *disk*: 3.125 times the largest \
         speed in cm/s, 5.5. With the density of the fluid it is 2.5 times that speed, about 14.1 here, and would \
         miss the published numbers by a fifth. That the disk's is meant follows from case B (density 1.5, viscosity \
         0.01): the fall of Bergmann, Hovnanian, Iollo 2014, Commun. Comput. Phys. 15, 1266, Fig. 19, has the slope \
         13.5 cm/s, which is 506 with the density of the disk and 337 with that of the fluid; published are 438 to \
         503. With that of the fluid, 17.3 would mean a drag coefficient of 2.0, below that of a cylinder without \
         walls.",
    );
    Ok(())
}

struct DiskFall {
    /// Time and Reynolds number.
    reynolds: Vec<(f64, f64)>,
    /// Largest distance of the centre from the axis.
    drift: f64,
    /// Angle at the end.
    angle: f64,
    /// Largest imbalance of forces over the weight.
    remainder: f64,
}

/// Returns the largest Reynolds number of a fall.
fn largest(fall: &DiskFall) -> f64 {
    fall.reynolds.iter().map(|(_, re)| *re).fold(0.0, f64::max)
}

fn sink(h: f64, dt: f64, set: Stabilisation) -> Result<DiskFall, Failure> {
    let mut setup = setup(h, dt)?;
    fluid_mut(&mut setup)?.stabilisation = set;
    let mut run = DirectRun::lagged(setup)?;
    let mut fall = DiskFall { reynolds: Vec::new(), drift: 0.0, angle: 0.0, remainder: 0.0 };
    loop {
        let report = run.advance()?;
        let state = &run.state;
        let motion = RigidMotion::<2>::from_numbers(&state.bodies[0].inner);
        let forces = report.bodies[0].forces.ok_or("and forces")?;
        fall.reynolds.push((state.time, -motion.velocity[1] * DENSITY * DIAMETER / VISCOSITY));
        fall.drift = fall.drift.max((motion.centre[0] - START[0]).abs());
        fall.angle = motion.rotation[(1, 0)].atan2(motion.rotation[(0, 0)]);
        fall.remainder = fall.remainder.max(forces.remainder().norm() / forces.body_force.norm());
        if motion.centre[1] < 2.5 * DIAMETER || state.time > 2.0 {
            return Ok(fall);
        }
    }
}

fn setup(h: f64, dt: f64) -> Result<Setup<2>, Failure> {
    let mut setup = still(background(h)?, VISCOSITY, dt, 1e-8, || FluidBoundary::NoSlip)?;
    let gravity = V::new(0.0, -GRAVITY);
    fluid_mut(&mut setup)?.body_force = Some(Arc::new(move |_, _| gravity));
    let n = (4.0 * std::f64::consts::PI * DIAMETER / h).round() as usize;
    setup.bodies.push(Arc::new(rigid_polygon(disk(P::from(START), 0.5 * DIAMETER, n), DENSITY, gravity)?));
    Ok(setup)
}

/// Returns the mesh of the box, fine where the disk sinks.
fn background(h: f64) -> Result<SimplexMesh<2>, Failure> {
    let [from, until] = [START[0] + 1.2 * DIAMETER, BOX[0] - DIAMETER];
    let size = Size::Graded { fine: h, fine_until: from, coarse: 4.0 * h, coarse_from: until, axis: 0 };
    let half = graded_box::<2>([START[0], 0.0], BOX, &size)?;
    Ok(mirrored(&half, 0, START[0])?)
}
