//! An elastic disk and an elastic ball that rest on the floor of a tank, under two ambient pressures.
//!
//! Source: balance of forces. The contact force is the weight minus that of the displaced fluid.

use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::algebra::time::QuasiStatic;
use cutwater::contact::{ContactForm, ContactLaw, NitscheLaw, PenaltyLaw};
use cutwater::mesh::generate::{BallOptions, Size, graded_box, half_ball};
use cutwater::mesh::{BodyId, Coordinates};
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff, SupportKind};
use cutwater::solver::{Contact, FluidBoundary};

use super::dry::{elastic, floor_by};
use super::flow::{fluid, problem};
use super::{DirectRun, Failure, P, Record, V};

// Radius, cm, and densities, g/cm³.
const RADIUS: f64 = 1.0;
const SOLID: f64 = 1.25;
const FLUID: f64 = 1.0;
/// Gravity, cm/s².
const GRAVITY: f64 = 981.0;
// Lame parameters, dyn/cm²: the weight flattens the body by some facets.
const MU: f64 = 1e5;
const LAMBDA: f64 = 4e5;
/// Size of the cells, cm.
const SIZE: f64 = 0.1;
/// Ambient pressures, dyn/cm². The second is ten times that of the weight of the body on its diameter.
const AMBIENT: [f64; 2] = [0.0, 1e4];
/// Largest error of the contact force relative to the weight minus buoyancy.
const TOLERANCE: f64 = 1e-8;
/// Viscosity, g/(cm s): with the first steps the body takes its shape in several of them.
const VISCOSITY: f64 = 1e2;
// Length of the first step, s, factor by which steps grow, and their number. The body comes to rest slowly, as the
// film at the rim of the contact fills.
const STEP: f64 = 0.02;
const GROWTH: f64 = 1.3;
const STEPS: u32 = 50;
/// Pressure over penetration, dyn/cm³, for comparison.
const STIFFNESS: f64 = 1e8;

/// Returns the contact force over the weight minus buoyancy, and the smallest gap.
fn at_rest(coordinates: Coordinates, law: impl ContactLaw + 'static, ambient: f64) -> Result<[f64; 2], Failure> {
    // The body starts inside the floor by a hundredth of its radius.
    let centre = [0.0, 0.99 * RADIUS];
    let ball =
        half_ball::<2>(centre, RADIUS, SIZE, &BallOptions { area_preserving: false })?.with_coordinates(coordinates)?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(MU, LAMBDA)?);
    let mut ball = elastic(ball, SOLID, material, V::new(0.0, -GRAVITY), Arc::new(QuasiStatic))?;
    ball.hold("left", SupportKind::symmetry(0))?;
    let touch = floor_by(ball.part("surface")?, ContactForm::new(law, SIZE)?)?;

    let background = graded_box::<2>([0.0, 0.0], [2.0 * RADIUS, 3.0 * RADIUS], &Size::uniform(1.3 * SIZE))?
        .with_coordinates(coordinates)?;
    let sides = ["left", "right", "bottom", "top"].map(|side| background.tag(side).ok_or("a box has four sides"));
    let [left, right, bottom, top] = sides;
    let mut fluid = fluid(background, FLUID, VISCOSITY);
    fluid.body_force = Some(Arc::new(|_, _| V::new(0.0, -FLUID * GRAVITY)));
    let traction = move |_: &P, n: &V, _: f64| n * -ambient;
    fluid.boundary = vec![
        (left?, FluidBoundary::symmetry(0)),
        (right?, FluidBoundary::NoSlip),
        (bottom?, FluidBoundary::NoSlip),
        (top?, FluidBoundary::Open { traction: Some(Arc::new(traction)), backflow: false }),
    ];
    let mut setup = problem(fluid, STEP);
    setup.scheme = Arc::new(QuasiStatic);
    setup.newton = NewtonSettings::new(1e-8);
    setup.bodies = vec![ball.body("ball")?];
    let contact = Contact::new(&setup.bodies, BodyId::new(0), touch.facets, touch.form, touch.obstacle)?;
    setup.contacts = vec![contact];
    let mut run = DirectRun::new(setup)?;
    let mut report = run.advance()?;
    for _ in 1..STEPS {
        run.setup.dt *= GROWTH;
        report = run.advance()?;
    }
    let balance = run.setup.bodies[0].balance(&run.state.bodies[0]).ok_or("the body is elastic")?;
    let expected = GRAVITY * (balance.mass - FLUID * balance.volume);
    let contact = &report.contacts[0];
    Ok([contact.force[1] / expected, contact.minimum_gap.unwrap_or(f64::NAN)])
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    for (coordinates, shape) in [(Coordinates::Cartesian, ""), (Coordinates::Axisymmetric, "ball, ")] {
        for ambient in AMBIENT {
            let name = format!("{shape}Nitsche, ambient pressure {ambient}");
            let [force, gap] = at_rest(coordinates, NitscheLaw::new(10.0, 0.0, 0.0)?, ambient)?;
            record.near(format!("{name}: contact force over weight minus buoyancy"), force, 1.0, TOLERANCE);
            record.show(format!("{name}: smallest gap over the radius"), gap / RADIUS, Some(0.0));
            let [force, gap] = at_rest(coordinates, PenaltyLaw::new(STIFFNESS, 0.0)?, ambient)?;
            let name = format!("{shape}penalty, ambient pressure {ambient}");
            record.show(format!("{name}: contact force over weight minus buoyancy"), force, Some(1.0));
            record.show(format!("{name}: smallest gap over the radius"), gap / RADIUS, Some(0.0));
        }
    }
    record.note(
        "An elastic disk in a tank, and a ball, with rotational symmetry, in equilibrium. Buoyancy is that of the deformed body. Where it touches the floor no fluid borders. With Nitsche's method \
         the pressure at the rim of the contact acts there, and contact carries the rest of the stress; with the penalty nothing but contact acts there, and \
         its force grows with the ambient pressure on the closed facets.",
    );
    Ok(())
}
