//! A cylinder between two rigid planes: its lower half, whose middle plane is pushed down.
//!
//! Source: Hertz 1882; Johnson 1985, Contact Mechanics, doi:10.1017/CBO9781139171731, Sec. 4.2(c), and 5.6 for the
//! approach.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::contact::{ContactForm, NitscheLaw, PenaltyLaw};
use cutwater::mesh::VertexId;
use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LinearElastic, Material, SaintVenantKirchhoff, Support, SupportKind};
use cutwater::solver::StepReport;

use super::dry::{GAMMA_0, LAMBDA, LAME, MU, RADIUS, elastic, floor_by, pushed, run};
use super::signal::passage;
use super::{DirectRun, Failure, P, Record, V};
use crate::units::cgs;

/// Displacement of the middle towards the plane, cm. The half-width of contact is then a thirtieth of the radius, and
/// strains are small.
const PUSHED: f64 = 1e-2;
/// `E/(1 - ν²)`, dyn/cm².
const MODULUS: f64 = 4.0 * MU * (LAMBDA + MU) / (LAMBDA + 2.0 * MU);
/// Ratio of pressure to penetration, dyn/cm^3, such that the penetration is below a hundredth of the approach.
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

/// Returns the run of a half cylinder, 2 n by n squares, in contact with the plane, and the report of its last step.
fn press(
    n: usize,
    material: impl Material<2> + 'static,
    form: ContactForm<2>,
) -> Result<(DirectRun, StepReport<2>), Failure> {
    // Across the middle without a change of pattern: where that changes, the pressure of linear triangles has a kink.
    let mesh =
        structured_box::<2>([-1.0, 0.0], [1.0, 1.0], [2 * n, n])?.mapped(|x| half_disk(graded(x[0]), graded(x[1])))?;
    let mut body = elastic(mesh, 1.0, material, V::zeros(), Arc::new(QuasiStatic))?;
    // The plane of symmetry has no shear traction; the vertex in its middle is on the axis.
    body.hold("top", pushed([None, Some(-PUSHED)]))?;
    let centre = VertexId::new(body.solid.mesh().n_vertices() - 1 - n);
    body.options.supports.push(Support { vertices: vec![centre], kind: SupportKind::symmetry(0) });
    let contact = floor_by(body.part("bottom")?, form)?;
    let mut run = run(vec![body], Some(contact), f64::from(LOAD_STEPS).recip(), 1e-10)?;
    let report = run.advance_by(LOAD_STEPS)?;
    Ok((run, report))
}

/// Returns the middle of each facet in contact and the pressure on it, in order.
fn pressures(run: &DirectRun, report: &StepReport<2>) -> Vec<(f64, f64)> {
    let surface = run.setup.bodies[0].surface();
    let positions = run.state.bodies[0].positions(run.setup.bodies[0].reference());
    let middle = |facet| surface.facet(facet).iter().map(|v| positions[v.index()][0]).sum::<f64>() / 2.0;
    let of_facets = report.contacts[0].slave_pressures.iter();
    let mut points: Vec<(f64, f64)> = of_facets.map(|&(facet, pressure)| (middle(facet), pressure)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Records load and pressure of Nitsche's method with two parameters.
fn nitsche(record: &mut Record, n: usize) -> Result<(), Failure> {
    let mut found = Vec::new();
    for gamma_0 in GAMMA_0 {
        let material = LinearElastic::new(LAME);
        let (run, report) = press(n, material, ContactForm::new(NitscheLaw::new(gamma_0, 0.0, 0.0)?, 1.0)?)?;
        let (load, points) = (report.contacts[0].force[1], pressures(&run, &report));
        let (radius, peak) = hertz(load);
        let [middle, size] = in_the_middle(&points)?;
        let moments =
            |power: i32| points.iter().zip(sizes(&points)).map(|(at, h)| at.1 * h * at.0.powi(power)).sum::<f64>();
        let name = format!("Nitsche, gamma_0 = {gamma_0}");
        record.at_least(format!("{name}: half-width over the size of cells in the middle"), radius / size, 20.0);
        record.near_relative(cgs(&format!("{name}: largest pressure p0 [<pressure>]")), middle, peak, 0.01);
        let half_width = 2.0 * (moments(2) / moments(0)).sqrt();
        record.near_relative(
            cgs(&format!("{name}: half-width from the second moment of the pressure [<length>]")),
            half_width,
            radius,
            0.03,
        );
        let pole = PUSHED + run.state.bodies[0].displacement()[n][1];
        record.near_relative(
            cgs(&format!("{name}: approach of the pole [<length>]")),
            pole,
            approach(load, radius),
            0.05,
        );
        let scatter = points.iter().filter(|at| at.0.abs() < 0.9 * radius);
        let exact = |x: f64| peak * (1.0 - (x / radius).powi(2)).max(0.0).sqrt();
        let scatter = scatter.map(|at| (at.1 - exact(at.0)).abs() / peak).fold(0.0, f64::max);
        record.show(format!("{name}: largest deviation of the pressure within 0.9 a, over p0"), scatter, None);
        found.push([load, middle, half_width, pole]);
    }
    let material = SaintVenantKirchhoff::new(LAME);
    let (run, report) = press(n, material, ContactForm::new(NitscheLaw::new(GAMMA_0[0], 0.0, 0.0)?, 1.0)?)?;
    let (name, peak) = (
        cgs("Saint Venant-Kirchhoff, Nitsche: largest pressure p0 [<pressure>]"),
        hertz(report.contacts[0].force[1]).1,
    );
    record.near_relative(name, in_the_middle(&pressures(&run, &report))?[0], peak, 0.01);
    for (k, what) in ["load", "largest pressure", "half-width", "approach"].into_iter().enumerate() {
        let change = (found[1][k] / found[0][k] - 1.0).abs();
        record.at_most(format!("Nitsche, gamma_0 times 100: change of the {what}, relative"), change, 0.005);
    }
    Ok(())
}

/// Returns the half-width of contact and the largest pressure under a load per length.
fn hertz(load: f64) -> (f64, f64) {
    let radius = (4.0 * load * RADIUS / (PI * MODULUS)).sqrt();
    (radius, 2.0 * load / (PI * radius))
}

/// Returns the pressure in the middle of the contact, and the size of cells there.
fn in_the_middle(points: &[(f64, f64)]) -> Result<[f64; 2], Failure> {
    // Facets that the edge of the contact does not divide.
    let near = points.iter().position(|at| at.0 > 0.0).ok_or("there is no contact")?;
    Ok([0.5 * (points[near - 1].1 + points[near].1), points[near].0 - points[near - 1].0])
}

/// Returns the sizes of cells around points, half of the distance between the neighbours.
fn sizes(points: &[(f64, f64)]) -> impl Iterator<Item = f64> + '_ {
    let last = points.len() - 1;
    (0..points.len()).map(move |k| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (points[after].0 - points[before].0) / (after - before) as f64
    })
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let n = if record.full { 192 } else { 128 };
    let (run, report) =
        press(n, SaintVenantKirchhoff::new(LAME), ContactForm::new(PenaltyLaw::new(STIFFNESS, 0.0)?, 1.0)?)?;
    let load = report.contacts[0].force[1];
    let (radius, peak) = hertz(load);
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
    record.near_relative(cgs("half-width a [<length>]"), edge, radius, 0.05);
    record.near_relative(cgs("largest pressure p0 [<pressure>]"), lowest.1, peak, 0.03);
    let pole = run.state.bodies[0].displacement()[n][1];
    record.near_relative(
        cgs("approach δ of the pole and the middle [<length>]"),
        PUSHED + pole,
        approach(load, radius),
        0.05,
    );
    record.show("largest deviation of the pressure within 0.9 a, over p0", scatter, None);
    record.show(cgs("load P [<force>]"), load, None);
    nitsche(record, if record.full { 128 } else { 64 })?;
    let pressures: Vec<_> = surface.iter().filter(|at| at.0 < 1.5 * radius).map(|&(x, p)| (x, p.max(0.0))).collect();
    record.figure(
        cgs("contact pressure [<pressure>]"),
        &cgs("distance from the centre [<length>]"),
        vec![
            ("Hertz".to_owned(), pressures.iter().map(|&(x, _)| (x, exact(x))).collect()),
            ("computed".to_owned(), pressures),
        ],
    );
    record.note(format!(
        "The lower half of a cylinder of radius {RADIUS} cm, twice {n} by {n} squares in two triangles, graded towards the contact. Its middle \
         plane goes down by {PUSHED} cm, which is a plane of symmetry of a cylinder between two planes. a, p0 and δ follow from the \
         computed load; δ is the approach of the pole to the middle, without the penetration of the penalty. Rows without a law are those of the penalty and of the Saint Venant-Kirchhoff \
         material, which softens in compression: by 1.5 times the strain, here 2.5 %. Rows of Nitsche's method are those of linear elasticity, with half or a third of the cells. The half-width \
         of Nitsche's method is that of a semi-elliptic pressure with the same second moment, 2 sqrt(∫ p x²/∫ p)."
    ));
    Ok(())
}
