//! Conservation of the volume that a moving body displaces, in the cut and in the equation of continuity. As the mesh
//! does not move, no velocity of the mesh enters.

use std::sync::Arc;

use cutwater::mesh::facet_normal;
use cutwater::solver::{FluidBoundary, Setup, State};
use cutwater::xfem_space::PartValues;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use super::flow::{fluid_mut, fluid_of, polygon_of_particles, wet, wet_report};
use super::linear_flow::{LinearFlow, SIZE, background, nonagon};
use super::record::{NamedNumbers, worse};
use super::{DirectRun, Failure, P, Record, T, V};

const STEPS: usize = 6;
const DT: f64 = 0.02;
/// Area of the box.
const BOX: f64 = 3.0;

/// Motion of a body.
#[derive(Clone, Copy)]
enum BodyMotion {
    /// Translation, and rotation about a point.
    Rigid { about: P, speed: V, spin: f64 },
    /// Constant velocities `a (X - about) + b` of the points: rotation, growth and shear.
    Swelling { about: P, a: T, b: V },
}

impl BodyMotion {
    fn position(&self, x: &P, t: f64) -> P {
        match self {
            Self::Rigid { about, speed, spin } => {
                let (sin, cos) = (spin * t).sin_cos();
                about + speed * t + T::new(cos, -sin, sin, cos) * (x - about)
            }
            Self::Swelling { about, a, b } => x + (a * (x - about) + b) * t,
        }
    }

    /// Returns the velocity of the point that is at `x` at a time.
    fn velocity(&self, x: &P, t: f64) -> V {
        match self {
            Self::Rigid { about, speed, spin } => {
                let arm = x - about - speed * t;
                speed + V::new(-arm[1], arm[0]) * *spin
            }
            Self::Swelling { about, a, b } => {
                let back = (T::identity() + a * t).try_inverse().unwrap_or_else(T::zeros);
                a * back * (x - about - b * t) + b
            }
        }
    }
}

/// Fluxes of the discrete velocity.
struct Fluxes {
    /// Flow out of the box.
    outflow: f64,
    /// `∫ v·n`, rate at which the body grows by the motion of its surface, and `∫ |v·n|`.
    growth: f64,
    swept: f64,
}

fn fluxes(setup: &Setup<2>, state: &State<2>, motion: &BodyMotion) -> Result<Fluxes, Failure> {
    let (background, fluid) = (&fluid_of(setup)?.background, wet(state)?);
    let (cut, values) = (&fluid.cut, PartValues::new(background, &fluid.cut));
    let (mut growth, mut swept, mut outflow) = (0.0, 0.0, 0.0);
    for piece in cut.interface() {
        let middle = (piece.points[0] + piece.points[1]) * 0.5;
        // The cut is that of the body at the start of the step.
        let rate = motion.velocity(&middle, state.time - setup.dt).dot(&piece.normal) * piece.measure;
        growth += rate;
        swept += rate.abs();
    }
    for piece in cut.boundary() {
        // Velocity of the part, which is linear, in the middle of the piece.
        let arm = (piece.points[0] + piece.points[1]) * 0.5 - background.simplex(cut.part_cell(piece.part)).points()[0];
        let shapes = values.gradients(piece.part).iter().enumerate().map(|(k, g)| g.dot(&arm) + f64::from(k == 0));
        let dofs = fluid.space.dofs(piece.part).iter();
        let velocity: V = dofs.zip(shapes).map(|(&dof, n)| fluid.velocity[dof as usize] * n).sum();
        outflow += velocity.dot(&facet_normal(&background.facet_points(piece.facet)[..2])) * piece.measure;
    }
    Ok(Fluxes { outflow, growth, swept })
}

/// Errors over the steps, relative to the volume that a body sweeps.
struct SweptErrors {
    /// Largest difference of the outflow and the growth of the body.
    outflow: f64,
    /// Largest difference of the change of the covered area and the sweep of the surface.
    area: f64,
    /// Mean absolute flow through the surface.
    leak: f64,
}

/// Moves a body of given motion through a box with cells of size `h` that is open at the top.
fn displaced(corners: Vec<P>, motion: BodyMotion, h: f64) -> Result<SweptErrors, Failure> {
    let known = LinearFlow::at_rest(V::zeros()).known(0.05, &["top"]);
    let mut setup = known.setup(background(h)?, DT);
    for (_, condition) in &mut fluid_mut(&mut setup)?.boundary {
        if matches!(condition, FluidBoundary::Velocity(_)) {
            *condition = FluidBoundary::NoSlip;
        }
    }
    let velocity = Arc::new(move |x: &P, [t, _]: [f64; 2]| motion.velocity(x, t));
    setup.bodies.push(polygon_of_particles(&[corners], move |x, t| motion.position(x, t), velocity));
    let mut run = DirectRun::new(setup)?;
    let mut errors = SweptErrors { outflow: 0.0, area: 0.0, leak: 0.0 };
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..STEPS {
        let report = run.advance()?;
        let flow = fluxes(&run.setup, &run.state, &motion)?;
        let covered = BOX - wet(&run.state)?.cut.fluid_volume();
        // Velocities at corners are constant or turn: rates are linear in time or zero, and the trapezoidal rule is
        // exact.
        let of_area = before.map_or(0.0, |(area, growth)| (covered - area) / DT - 0.5 * (growth + flow.growth));
        errors.outflow = worse(errors.outflow, (flow.outflow - flow.growth).abs() / flow.swept);
        errors.area = worse(errors.area, of_area.abs() / flow.swept);
        errors.leak += wet_report(&report)?.flow.leak_absolute / flow.swept / STEPS as f64;
        before = Some((covered, flow.growth));
    }
    Ok(errors)
}

fn named(name: &str, errors: &SweptErrors) -> NamedNumbers {
    vec![
        (format!("{name}, every step, over its sweep: outflow minus growth of the body"), errors.outflow),
        (format!("{name}, every step, over its sweep: change of the covered area minus sweep"), errors.area),
    ]
}

/// Measures the errors of a body that moves and turns under an open side.
pub(super) fn open(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let motion = rigid(centre, random);
    Ok(named("body that moves and turns under an open side", &displaced(nonagon(centre, random), motion, SIZE)?))
}

/// Measures the flow through the surface of such a body on three meshes.
pub(super) fn leak(record: &mut Record) -> Result<(), Failure> {
    let errors: Vec<(f64, f64)> = [SIZE, 0.5 * SIZE, 0.25 * SIZE]
        .into_iter()
        .map(|h| {
            let (mut random, centre) = (SplitMix64::seed_from_u64(12), P::new(1.0, 0.75));
            let motion = rigid(centre, &mut random);
            Ok((h, displaced(nonagon(centre, &mut random), motion, h)?.leak))
        })
        .collect::<Result<_, Failure>>()?;
    // No equation makes the leak zero; it is an error of the coupling and falls with the mesh, at corners of the body
    // slowly.
    record.order("mean absolute leak of a nonagon over its sweep", "h", &errors, 0.5);
    Ok(())
}

fn rigid(about: P, random: &mut SplitMix64) -> BodyMotion {
    let speed = V::new(random.random_range(-0.7..0.7), random.random_range(-0.7..0.7));
    BodyMotion::Rigid { about, speed, spin: random.random_range(1.0..4.0) }
}

/// Measures the errors of a body that turns, swells and is sheared under an open side.
pub(super) fn swelling(about: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let mut entry = || random.random_range(-0.5..0.5);
    let (shear, b) = (T::new(entry(), entry(), entry(), entry()), V::new(entry(), entry()));
    let motion = BodyMotion::Swelling { about, a: shear + T::new(0.6, -1.0, 1.0, 0.6), b };
    let name = "body that turns, swells and is sheared under an open side";
    Ok(named(name, &displaced(nonagon(about, random), motion, SIZE)?))
}
