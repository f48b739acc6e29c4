//! Contact that transmits a uniform pressure: a block on a plane, and two blocks.
//!
//! Source: the patch test of Taylor and Papadopoulos 1991 in the form of the Tribol library's tests, for two unit
//! squares.

mod consistent;

use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::contact::{ContactForm, DeformableObstacle, PenaltyLaw};
use cutwater::mesh::BodyId;
use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff, SupportKind};
use cutwater::solver::ContactObstacle;

use super::dry::{Elastic, Touch, elastic, floor, pushed, run};
use super::signal::bisect;
use super::{DirectRun, Failure, Record, V};

/// Both Lame parameters.
const LAME: f64 = 50.0;
/// Displacement of the top, downwards.
const PUSHED: f64 = 0.01;
/// Pressure over penetration.
const STIFFNESS: f64 = 1e5;
/// Tolerance for the round-off of a solved system.
const ROUND_OFF: f64 = 1e-9;

/// Returns the pressure on the reference area of a block in plane strain at a vertical stretch, its sides free.
fn pressure(stretch: f64) -> f64 {
    -4.0 * LAME * (2.0 * LAME) / (3.0 * LAME) * stretch * (stretch * stretch - 1.0) / 2.0
}

/// Returns the stretch of `n` unit blocks in a pile that is pushed, with the penetration under or between them.
fn stretch(n: f64) -> f64 {
    // The penetration is the push minus the compression of the blocks.
    bisect([0.9, 1.0], |stretch| pressure(stretch) <= STIFFNESS * (PUSHED - n * (1.0 - stretch)))
}

fn block(bottom: f64, n: usize, top: f64) -> Result<Elastic<2>, Failure> {
    let mesh = structured_box::<2>([0.0, bottom], [1.0, bottom + 1.0], [n, n])?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(LAME, LAME)?);
    let mut body = elastic(mesh, 1.0, material, V::zeros(), Arc::new(QuasiStatic))?;
    body.hold("left", SupportKind::symmetry(0))?;
    if top != 0.0 {
        body.hold("top", pushed([None, Some(-top)]))?;
    } else {
        body.hold("bottom", SupportKind::symmetry(1))?;
    }
    Ok(body)
}

/// Returns the deviation of force and displacement from the uniform state, relative to the pressure and the push, of
/// blocks in a pile with the given bottoms, the highest one first and pushed.
fn deviation(mut run: DirectRun, bottoms: &[f64]) -> Result<[f64; 2], Failure> {
    let report = run.advance()?;
    let stretch = stretch(bottoms.len() as f64);
    let force = (report.contacts[0].force[1] - pressure(stretch)).abs() / pressure(stretch);
    let lateral = (1.0 - (stretch * stretch - 1.0) / 3.0).sqrt();
    let mut displacement = 0.0_f64;
    for (k, (body, state)) in run.setup.bodies.iter().zip(&run.state.bodies).enumerate() {
        // The highest block hangs from its top, the lowest of two stands on its bottom.
        let (fixed, moved) = if k == 0 { (bottoms[0] + 1.0, -PUSHED) } else { (bottoms[k], 0.0) };
        for (x, d) in body.reference().iter().zip(state.displacement()) {
            let exact = V::new((lateral - 1.0) * x[0], moved + (stretch - 1.0) * (x[1] - fixed));
            displacement = displacement.max((d - exact).norm() / PUSHED);
        }
    }
    Ok([force, displacement])
}

fn on_a_plane(n: usize) -> Result<[f64; 2], Failure> {
    let body = block(0.0, n, PUSHED)?;
    let contact = floor(body.part("bottom")?, STIFFNESS, 1.0)?;
    deviation(run(vec![body], Some(contact), 1.0, 1e-11)?, &[0.0])
}

fn two(n_slave: usize, n_master: usize) -> Result<[f64; 2], Failure> {
    let (upper, lower) = (block(1.0, n_slave, PUSHED)?, block(0.0, n_master, 0.0)?);
    let surface = DeformableObstacle::new(lower.solid.boundary().clone(), lower.part("top")?)?;
    let contact = Touch {
        facets: upper.part("bottom")?,
        // The contact size also determines the distance within which obstacles are searched.
        form: ContactForm::new(PenaltyLaw::new(0.1 * STIFFNESS, 0.0)?, 0.1)?,
        obstacle: ContactObstacle::Body { body: BodyId::new(1), surface },
    };
    deviation(run(vec![upper, lower], Some(contact), 1.0, 1e-11)?, &[1.0, 0.0])
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let [force, displacement] = on_a_plane(if record.full { 16 } else { 5 })?;
    record.at_most("block on a plane: error of the force, relative", force, ROUND_OFF);
    record.at_most("block on a plane: error of displacement relative to the push", displacement, ROUND_OFF);
    for (slave, master) in [(3, 3), (8, 4), (4, 3), (3, 4), (16, 3)] {
        let [force, displacement] = two(slave, master)?;
        record.at_most(format!("blocks of {slave} on {master}: force"), force, ROUND_OFF);
        record.at_most(format!("blocks of {slave} on {master}: displacement"), displacement, ROUND_OFF);
    }
    consistent::measure(record)?;
    record.show("two blocks: pressure", pressure(stretch(2.0)), Some(0.66667));
    record.note(
        "The exact states are those of Saint Venant-Kirchhoff blocks with the uniform penetration of the penalty; 0.66667 is the \
         pressure of linear elasticity. Facets of the slave are divided over the edges of the master's, so that meshes need not match.",
    );
    Ok(())
}
