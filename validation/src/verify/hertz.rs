//! A cylinder between two rigid planes: its lower half, whose middle plane is pushed down.
//!
//! Source: Hertz 1882; Johnson 1985, Contact Mechanics, doi:10.1017/CBO9781139171731, Sec. 4.2(c), and 5.6 for the approach.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::mesh::VertexId;
use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff, Support, SupportKind};

use super::dry::{elastic, floor, pushed, run};
use super::signal::passage;
use super::{Failure, P, Record, V};

/// Radius, cm.
const RADIUS: f64 = 4.0;
/// Displacement of its middle towards the plane, cm. The half-width of contact is then a thirtieth of the radius, and
/// strains are small.
const PUSHED: f64 = 1e-2;
/// Lame parameters, dyn/cm^2, and `E/(1 - ν²)`, which follows from them.
const MU: f64 = 2e6;
const LAMBDA: f64 = 8e6;
const MODULUS: f64 = 4.0 * MU * (LAMBDA + MU) / (LAMBDA + 2.0 * MU);
/// Pressure over penetration, dyn/cm^3: penetration is below a hundredth of the approach.
const STIFFNESS: f64 = 1e10;
/// Grading of the cells towards the contact.
const GRADING: f64 = 4.0;
/// Steps in which the push is applied.
const LOAD_STEPS: u32 = 3;

/// Returns a coordinate from -1 to 1 whose steps grow with the distance from zero.
fn graded(s: f64) -> f64 {
    (GRADING * s).sinh() / GRADING.sinh()
}

/// Returns a point of the lower half of the disk: `(0, 0)` is the lowest one, 1 in the second coordinate the middle
/// plane, and the other sides of the rectangle lie on the circle. (The map of a square on a disk by ellipses.)
fn half_disk(across: f64, up: f64) -> P {
    let down = 1.0 - up;
    let centred = P::new(across * (1.0 - 0.5 * down * down).sqrt(), -down * (1.0 - 0.5 * across * across).sqrt());
    centred * RADIUS + V::new(0.0, RADIUS)
}

/// Returns the approach of a pole to the middle under a load per length, with the half-width of contact: `P/(π E*) (2
/// ln(4 R/a) - 1)`.
fn approach(load: f64, radius: f64) -> f64 {
    load / (PI * MODULUS) * (2.0 * (4.0 * RADIUS / radius).ln() - 1.0)
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let n = if record.full { 192 } else { 128 };
    // Across the middle without a change of pattern: where that changes, the pressure of linear triangles has a kink.
    let mesh =
        structured_box::<2>([-1.0, 0.0], [1.0, 1.0], [2 * n, n])?.mapped(|x| half_disk(graded(x[0]), graded(x[1])))?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(MU, LAMBDA)?);
    let mut body = elastic(mesh, 1.0, material, V::zeros(), Arc::new(QuasiStatic))?;
    // The plane of symmetry has no shear traction; the vertex in its middle is on the axis.
    body.hold("top", pushed([None, Some(-PUSHED)]))?;
    let centre = VertexId::new(body.solid.mesh().n_vertices() - 1 - n);
    body.options.supports.push(Support { vertices: vec![centre], kind: SupportKind::Symmetry { axis: 0 } });
    let contact = floor(body.part("bottom")?, STIFFNESS, 1.0)?;
    let mut run = run(vec![body], Some(contact), f64::from(LOAD_STEPS).recip(), 1e-10)?;
    let mut load = f64::NAN;
    for _ in 0..LOAD_STEPS {
        load = run.advance()?.contacts[0].force[1];
    }

    let radius = (4.0 * load * RADIUS / (PI * MODULUS)).sqrt();
    let peak = 2.0 * load / (PI * radius);
    let positions = run.state.bodies[0].positions(run.setup.bodies[0].reference());
    let mut surface: Vec<(f64, f64)> = run.setup.contacts[0]
        .facets()
        .iter()
        .flat_map(|&f| run.setup.bodies[0].surface().facet(f))
        .map(|v| (positions[v.index()][0], -positions[v.index()][1] * STIFFNESS))
        // The half to the right; the middle moves by round-off.
        .filter(|at| at.0 > -1e-6)
        .collect();
    surface.sort_by(|a, b| a.0.total_cmp(&b.0));
    surface.dedup();
    let inside = surface.iter().take_while(|at| at.1 > 0.0).count();
    let (Some(lowest), Some(last), Some(next)) = (surface.first(), surface[..inside].last(), surface.get(inside))
    else {
        return Err("there is no contact, or nothing but contact".into());
    };
    // Penetration is linear along a facet.
    let edge = passage([*last, *next], 0.0);
    let exact = |x: f64| peak * (1.0 - (x / radius).powi(2)).max(0.0).sqrt();
    let scatter =
        surface.iter().filter(|at| at.0 < 0.9 * radius).map(|at| (at.1 - exact(at.0)).abs() / peak).fold(0.0, f64::max);
    record.at_least("half-width over the largest cell in contact", radius / (next.0 - last.0), 20.0);
    record.near_relative("half-width a [cm]", edge, radius, 0.05);
    record.near_relative("largest pressure p0 [dyn/cm²]", lowest.1, peak, 0.03);
    let pole = run.state.bodies[0].displacement()[n][1];
    record.near_relative("approach δ of the pole and the middle [cm]", PUSHED + pole, approach(load, radius), 0.05);
    record.show("largest deviation of the pressure within 0.9 a, over p0", scatter, None);
    record.show("load P [dyn/cm]", load, None);
    let pressures: Vec<_> = surface.iter().filter(|at| at.0 < 1.5 * radius).map(|&(x, p)| (x, p.max(0.0))).collect();
    record.figure(
        "contact pressure [dyn/cm²]",
        "distance from the centre [cm]",
        vec![
            ("Hertz".to_owned(), pressures.iter().map(|&(x, _)| (x, exact(x))).collect()),
            ("computed".to_owned(), pressures),
        ],
    );
    record.note(format!(
        "The lower half of a cylinder of radius {RADIUS} cm, twice {n} by {n} squares in two triangles, graded towards the contact. Its middle \
         plane goes down by {PUSHED} cm, which is a plane of symmetry of a cylinder between two planes. a, p0 and δ follow from the \
         computed load; δ is the approach of the pole to the middle, without the penetration of the penalty."
    ));
    Ok(())
}
