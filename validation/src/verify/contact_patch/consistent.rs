//! Piles of blocks whose contact is consistent: the gap is exact too.

use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::contact::{ContactForm, DeformableObstacle, NitscheLaw};
use cutwater::mesh::generate::structured_box;
use cutwater::mesh::{BodyId, Coordinates, FacetId};
use cutwater::solid_svk::{
    LameParameters, LinearElastic, Load, Material, Order, SaintVenantKirchhoff, SolidMesh, SupportKind,
};
use cutwater::solver::ContactObstacle;

use super::super::dry::{Elastic, GAMMA_0, Touch, elastic_of, floor_by, pushed, run};
use super::super::{Failure, Record, V};

// Tolerances of pressures, relative to the exact one, and of gaps, relative to the height of a block.
const PRESSURE: f64 = 1e-9;
const GAP: f64 = 1e-10;
/// Distance that contact keeps between two blocks. Over the end of the lower block closest points change their
/// direction within the gap.
const OFFSET: f64 = 0.01;

/// Both Lame parameters.
const LAME: f64 = 50.0;
/// Steps in which large or unsupported pushes are applied.
const LOAD_STEPS: u32 = 5;

/// Returns a block of linear elements with its left side on the axis.
fn block(
    ends: [f64; 2],
    width: f64,
    n: [usize; 2],
    material: impl Material<2> + 'static,
) -> Result<Elastic<2>, Failure> {
    block_of((Order::Linear, Coordinates::Cartesian), ends, width, n, material)
}

/// Returns a block of elements of an order in the given coordinates, with its left side on the axis.
fn block_of(
    (order, coordinates): (Order, Coordinates),
    [bottom, top]: [f64; 2],
    width: f64,
    n: [usize; 2],
    material: impl Material<2> + 'static,
) -> Result<Elastic<2>, Failure> {
    let mesh = structured_box::<2>([0.0, bottom], [width, top], n)?.with_coordinates(coordinates)?;
    let solid = SolidMesh::of_order(mesh, order)?;
    let mut body = elastic_of(solid, 1.0, material, V::zeros(), Arc::new(QuasiStatic))?;
    body.hold("left", SupportKind::symmetry(0))?;
    Ok(body)
}

/// Returns the contact of the bottom of a block with the top of the second body.
fn on(upper: &Elastic<2>, lower: &Elastic<2>, gamma_0: f64, offset: f64) -> Result<Touch<2>, Failure> {
    let surface = DeformableObstacle::new(lower.solid.boundary().clone(), lower.part("top")?)?;
    Ok(Touch {
        facets: upper.part("bottom")?,
        form: ContactForm::new(NitscheLaw::new(gamma_0, offset, 0.0)?, 0.1)?,
        obstacle: ContactObstacle::Body { body: BodyId::new(1), surface },
    })
}

/// Solves a pile in steps and records the largest errors of the pressure on the slave's facets and of its gap.
fn record_pile(
    record: &mut Record,
    name: &str,
    (bodies, contact): (Vec<Elastic<2>>, Touch<2>),
    (steps, pressure): (u32, f64),
) -> Result<(), Failure> {
    let offset = contact.form.law.offset();
    let mut run = run(bodies, Some(contact), f64::from(steps).recip(), 1e-13)?;
    let report = run.advance_by(steps)?;
    let found = &report.contacts[0];
    let off = found.slave_pressures.iter().map(|(_, p)| (p / pressure - 1.0).abs()).fold(0.0, f64::max);
    let all = found.slave_pressures.len() == run.setup.contacts[0].facets().len();
    let gap = found.minimum_gap.ok_or("there is an obstacle")? - offset;
    // Points outside of contact would have a larger gap.
    let worst_gap = if all { gap.abs().max(found.largest_penetration.abs()) } else { f64::NAN };
    record.at_most(format!("{name}: error of the pressure, relative"), off, PRESSURE);
    record.at_most(format!("{name}: error of the gap"), worst_gap, GAP);
    Ok(())
}

/// Returns `4 μ (λ + μ)/(λ + 2 μ)`, the modulus of plane strain with free sides.
fn modulus(lame: f64) -> f64 {
    4.0 * lame * (2.0 * lame) / (3.0 * lame)
}

/// Records two blocks of equal width.
fn two_blocks(record: &mut Record) -> Result<(), Failure> {
    let linear = || Ok::<_, Failure>(LinearElastic::new(LameParameters::new(LAME, LAME)?));
    let gamma_0 = GAMMA_0[0];
    let law = |name: &str| format!("Nitsche, gamma_0 = {gamma_0}, {name}");
    // The modulus of plane strain, and Young's.
    let plane = ("", Coordinates::Cartesian, modulus(LAME));
    let around_axis = ("around the axis, ", Coordinates::Axisymmetric, 2.5 * LAME);
    for ((place, coordinates, modulus), order) in
        [plane, around_axis].into_iter().flat_map(|of| [Order::Linear, Order::Quadratic].map(|order| (of, order)))
    {
        let [mut upper, mut lower] = [
            block_of((order, coordinates), [1.0 + OFFSET, 2.0 + OFFSET], 1.0, [4, 4], linear()?)?,
            block_of((order, coordinates), [0.0, 1.0], 1.0, [3, 3], linear()?)?,
        ];
        upper.hold("top", pushed([None, Some(-0.01)]))?;
        lower.hold("bottom", SupportKind::symmetry(1))?;
        let contact = on(&upper, &lower, gamma_0, OFFSET)?;
        let name = format!("two blocks of order {}, {place}4 on 3", order.degree());
        record_pile(record, &law(&name), (vec![upper, lower], contact), (1, modulus * 0.005))?;
    }

    let stiff = || Ok::<_, Failure>(LinearElastic::new(LameParameters::from_young_poisson(2e6, 0.0)?));
    let [mut upper, mut lower] =
        [block([1.0 + OFFSET, 2.0 + OFFSET], 1.0, [4, 4], stiff()?)?, block([0.0, 1.0], 1.0, [7, 3], stiff()?)?];
    upper.hold("top", pushed([None, Some(-0.1)]))?;
    lower.hold("bottom", SupportKind::symmetry(1))?;
    let contact = on(&upper, &lower, gamma_0, OFFSET)?;
    record_pile(record, &law("two blocks without lateral strain, 4 on 7"), (vec![upper, lower], contact), (1, 1e5))?;
    Ok(())
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let linear = || Ok::<_, Failure>(LinearElastic::new(LameParameters::new(LAME, LAME)?));
    for gamma_0 in GAMMA_0 {
        let law = |name: &str| format!("Nitsche, gamma_0 = {gamma_0}, {name}");
        let form = || Ok::<_, Failure>(ContactForm::new(NitscheLaw::new(gamma_0, 0.0, 0.0)?, 0.1)?);

        // A block above the plane by less than its top is pushed.
        let (push, distance) = (0.01, 0.004);
        let mut body = block([distance, 1.0 + distance], 1.0, [5, 4], linear()?)?;
        body.hold("top", pushed([None, Some(-push)]))?;
        let contact = floor_by(body.part("bottom")?, form()?)?;
        let pressure = modulus(LAME) * (push - distance);
        record_pile(record, &law("block on a plane"), (vec![body], contact), (1, pressure))?;

        let mut body = block([0.0, 1.0], 1.0, [5, 4], SaintVenantKirchhoff::new(LameParameters::new(LAME, LAME)?))?;
        body.hold("top", pushed([None, Some(-0.1)]))?;
        let contact = floor_by(body.part("bottom")?, form()?)?;
        let stretch = 0.9_f64;
        // Contact acts on the area at the start of the step.
        let before = 1.0 - 0.1 * f64::from(LOAD_STEPS - 1) / f64::from(LOAD_STEPS);
        let area = (1.0 + (1.0 - before * before) / 3.0).sqrt();
        let pressure = modulus(LAME) * stretch * (1.0 - stretch * stretch) / 2.0 / area;
        let name = "Saint Venant-Kirchhoff block on a plane, compressed to 0.9";
        record_pile(record, &law(name), (vec![body], contact), (LOAD_STEPS, pressure))?;

        // A small block on a foundation, the same pressure on both; the end of the block is over a vertex. It starts
        // inside the foundation, because nothing but contact holds it.
        let pressure = 0.5;
        let (mut upper, mut lower) =
            (block([0.999, 1.999], 1.0, [3, 4], linear()?)?, block([0.0, 1.0], 2.0, [8, 3], linear()?)?);
        lower.hold("bottom", SupportKind::symmetry(1))?;
        let load = |facets: Vec<FacetId>| Load::traction(facets, Arc::new(move |_, _| V::new(0.0, -pressure)));
        upper.options.loads.push(load(upper.part("top")?));
        let vertices = lower.solid.nodes();
        let is_free =
            |f: &FacetId| lower.solid.boundary().facet(*f).iter().all(|v| vertices[v.index()][0] > 1.0 - 1e-9);
        let uncovered = lower.part("top")?.into_iter().filter(is_free).collect();
        lower.options.loads.push(load(uncovered));
        let contact = on(&upper, &lower, gamma_0, 0.0)?;
        record_pile(record, &law("small block on a foundation"), (vec![upper, lower], contact), (1, pressure))?;
    }
    two_blocks(record)?;
    record.note(format!(
        "With Nitsche's method the gap is exact and the exact states are those of the blocks alone. Two blocks of equal width keep a distance of {OFFSET}; with gamma_0 = 1000 Newton's \
         method does not find their state, in which closest points turn around the ends. The small block on \
         a foundation is the test of Taylor and Papadopoulos, with the pressure on the uncovered part of the foundation too. Materials are linear unless stated."
    ));
    Ok(())
}
