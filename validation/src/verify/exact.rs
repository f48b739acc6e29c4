//! Solutions that the discrete spaces contain: whatever the cut, nothing but round-off may be left.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::mesh::generate::{BallOptions, ball};
use cutwater::solid_rigid::RigidMotion;
use cutwater::solid_svk::{ElasticBody, ElasticOptions, LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh};
use cutwater::solver::body::Body;
use cutwater::solver::{FluidBoundary, Setup, State};

use super::conservation;
use super::flow::{
    self, Flow, Known, P, Random, T, V, disk, fluid_mut, fluid_of, polygon, rigid_polygon, wet, wet_report,
};
use super::linear_flow::{Linear, SIZE, background, nonagon};
use super::record::Record;
use crate::outcome::Failure;

/// Largest error that counts as round-off of a solved system.
const ROUND_OFF: f64 = 1e-9;
/// Random positions in short and in full.
const POSITIONS: [usize; 2] = [3, 20];

/// Measures all of it, each at random positions of the bodies.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let n = POSITIONS[usize::from(record.full)];
    let worst = |seed: u64, of: fn(P, &mut Random) -> Result<Vec<f64>, Failure>| -> Result<Vec<f64>, Failure> {
        let mut random = Random(seed);
        let mut worst: Vec<f64> = Vec::new();
        for _ in 0..n {
            let centre = P::new(random.between(0.8, 1.2), random.between(0.65, 0.85));
            let errors = of(centre, &mut random)?;
            worst.resize(errors.len(), 0.0);
            // NaN counts as the largest error.
            worst
                .iter_mut()
                .zip(errors)
                .for_each(|(worst, e)| *worst = if e > *worst || e.is_nan() { e } else { *worst });
        }
        Ok(worst)
    };
    let mut add = |names: &[&str], values: Vec<f64>| {
        for (name, value) in names.iter().zip(values) {
            record.at_most(*name, value, ROUND_OFF);
        }
    };
    add(
        &["hydrostatic: velocity", "hydrostatic: pressure", "hydrostatic: buoyancy beside weight of the polygon"],
        worst(1, hydrostatic)?,
    );
    add(
        &["uniform pressure: velocity", "uniform pressure: force on the body", "uniform pressure: moment on the body"],
        worst(2, uniform_pressure)?,
    );
    add(&["linear flow: velocity", "linear flow: pressure"], worst(3, |at, random| linear(at, random, false))?);
    add(
        &["linear flow past a moving interface: velocity", "linear flow past a moving interface: pressure"],
        worst(4, |at, random| linear(at, random, true))?,
    );
    add(&["annulus turning as one: velocity", "annulus turning as one: moment"], worst(5, annulus)?);
    add(
        &["body and fluid in translation: velocity", "body and fluid in translation: pressure", "the same: body"],
        worst(6, translation)?,
    );
    let displaced = [
        ("body that moves and turns in a closed box", worst(7, conservation::closed)?),
        ("body that moves and turns under an open side", worst(12, conservation::open)?),
        ("body that turns, swells and is sheared under an open side", worst(13, conservation::swelling)?),
    ];
    for (name, values) in &displaced {
        let names = [
            "sum of what is missing in the volume balance of each cell",
            "flow out of the box beside growth of the body",
            "change of the covered area beside sweep of the surface",
        ];
        let names = names.map(|what| format!("{name}, every step, over its sweep: {what}"));
        add(&names.each_ref().map(String::as_str), values[..3].to_vec());
    }
    add(
        &["pressurised disk: velocity", "pressurised disk: pressure", "pressurised disk: velocity of the disk"],
        worst(8, pressurised_disk)?,
    );
    add(
        &[
            "neutral rigid body in hydrostatic pressure: velocity",
            "the same: pressure",
            "the same: velocity and spin of the body",
        ],
        worst(10, neutral)?,
    );
    add(
        &["rigid body in fluid that turns about its centre: velocity", "the same: velocity and spin of the body"],
        worst(11, turning)?,
    );
    add(&["pocket: pressure up to its mean", "pocket: mean of the pressure"], worst(9, pocket)?);
    for (name, values) in &displaced {
        record.show(format!("{name}, over its sweep: net flow through the surface, relative to it"), values[3], None);
    }
    record.note(
        "The mesh does not move. Conservation of volume therefore requires that the fluid parts of the cells close, face by face \
         and with the interface, and that the outflow of the box equals the volume that the body displaces. The test function 1 \
         of the equation of continuity makes the sum of divergence and leak zero, not the leak by itself, because the mortar \
         couples velocities weakly.",
    );
    record.note(format!("{n} random positions each, on a mesh of size {SIZE} that is not fitted to the body."));
    Ok(())
}

/// Largest errors of velocity and pressure over the dofs.
fn nodal_errors<F: Flow>(known: &Known<F>, setup: &Setup<2>, state: &State<2>) -> [f64; 2] {
    let mut errors = [0.0_f64; 2];
    for (k, &vertex) in wet(state).space.vertices().iter().enumerate() {
        let x = fluid_of(setup).background.vertex(vertex);
        let t = state.time;
        errors[0] = errors[0].max((wet(state).velocity[k] - known.flow.velocity(&x, t)).norm());
        errors[1] = errors[1].max((wet(state).pressure[k] - known.flow.pressure(&x, t)).abs());
    }
    errors
}

/// Area of a polygon.
fn area(corners: &[P]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

fn hydrostatic(centre: P, _: &mut Random) -> Result<Vec<f64>, Failure> {
    let g = V::new(0.0, -2.5);
    let known = Linear::at_rest(g).known(0.1, &["top"]);
    let mut setup = known.setup(background()?, 0.05);
    let corners = disk(centre, 0.37, 23);
    let weight = area(&corners) * g;
    setup.bodies.push(polygon(&[corners], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 2)?;
    let [u, p] = nodal_errors(&known, &setup, &state);
    let (force, _) = flow::force(&state, &report, 0, &centre);
    Ok(vec![u, p, (force + weight).norm()])
}

/// A free body of the density of the fluid under gravity: the pressure carries it.
fn neutral(centre: P, random: &mut Random) -> Result<Vec<f64>, Failure> {
    let g = V::new(0.4, -2.5);
    let known = Linear::at_rest(g).known(0.1, &["top"]);
    let mut setup = known.setup(background()?, 0.05);
    setup.bodies.push(Arc::new(rigid_polygon(nonagon(centre, random), known.density, g / known.density)?));
    let (state, _) = flow::run(&setup, 3)?;
    let [u, p] = nodal_errors(&known, &setup, &state);
    let motion = RigidMotion::<2>::from_numbers(&state.bodies[0].inner);
    Ok(vec![u, p, motion.velocity.norm().max(motion.spin[0].abs())])
}

/// Fluid that turns as one, and a free body that turns in it about its centre of mass, whatever its shape.
fn turning(centre: P, random: &mut Random) -> Result<Vec<f64>, Failure> {
    let spin = 1.3;
    let mut body = rigid_polygon(nonagon(centre, random), 0.8, V::zeros())?;
    body.initial_spin[0] = spin;
    let (turn, about) = (T::new(0.0, -spin, spin, 0.0), body.mass.centre);
    let linear = Linear { a: turn, b: -(turn * about), g: V::zeros(), p: 0.0, density: 1.2, convects: false };
    let known = linear.known(0.7, &[]);
    let mut setup = known.setup(background()?, 0.05);
    setup.bodies.push(Arc::new(body));
    let (state, _) = flow::run(&setup, 4)?;
    let motion = RigidMotion::<2>::from_numbers(&state.bodies[0].inner);
    let error = motion.velocity.norm().max((motion.spin[0] - spin).abs());
    Ok(vec![nodal_errors(&known, &setup, &state)[0], error])
}

fn uniform_pressure(centre: P, random: &mut Random) -> Result<Vec<f64>, Failure> {
    let known = Linear::at_rest(V::zeros()).known(0.1, &["right", "top"]);
    let mut setup = known.setup(background()?, 0.05);
    setup.bodies.push(polygon(&[nonagon(centre, random)], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 2)?;
    let (force, moment) = flow::force(&state, &report, 0, &centre);
    Ok(vec![nodal_errors(&known, &setup, &state)[0], force.norm(), moment.abs()])
}

fn linear(centre: P, random: &mut Random, moves: bool) -> Result<Vec<f64>, Failure> {
    let mut entry = || random.between(-1.0, 1.0);
    let (a, b, c) = (entry(), entry(), entry());
    let linear = Linear {
        a: T::new(a, b, c, -a),
        b: V::new(entry(), entry()),
        g: V::new(entry(), entry()),
        p: 1.7,
        density: 1.2,
        convects: true,
    };
    let known = linear.known(if moves { 0.1 } else { 1.0 }, &["top"]);
    let mut setup = known.setup(background()?, 0.05);
    let speed = if moves { V::new(2.0, -1.0) } else { V::zeros() };
    setup.bodies.push(polygon(&[disk(centre, 0.3, 19)], move |x, t| x + speed * t, known.velocity()));
    let (state, _) = flow::run(&setup, 3)?;
    Ok(nodal_errors(&known, &setup, &state).to_vec())
}

/// Fluid between a disk and a ring that turn as one: the velocity is linear, and no moment acts.
fn annulus(centre: P, _: &mut Random) -> Result<Vec<f64>, Failure> {
    let turn = T::new(0.0, -1.3, 1.3, 0.0);
    let linear = Linear { a: turn, b: -(turn * centre), g: V::zeros(), p: 0.0, density: 1.0, convects: false };
    let known = linear.known(0.7, &[]);
    let mut setup = known.setup(background()?, 0.05);
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| centre + P::new(x, y) * 3.0);
    let mut hole = disk(centre, 0.5, 31);
    hole.reverse();
    setup.bodies.push(polygon(&[disk(centre, 0.25, 17)], |x, _| *x, known.velocity()));
    setup.bodies.push(polygon(&[square.to_vec(), hole], |x, _| *x, known.velocity()));
    fluid_mut(&mut setup).boundary.clear();
    let (state, report) = flow::run(&setup, 2)?;
    // Dofs of cut cells lie in the bodies, where the flow goes on.
    let [u, _] = nodal_errors(&known, &setup, &state);
    Ok(vec![u, flow::force(&state, &report, 0, &centre).1.abs()])
}

/// An elastic disk, with a displacement and a velocity at the start.
fn elastic(
    centre: P,
    radius: f64,
    displacement: impl Fn(&P) -> V + Send + Sync + 'static,
    velocity: V,
) -> Result<Arc<dyn Body<2>>, Failure> {
    let mesh = ball::<2>([centre[0], centre[1]], radius, 0.1, &BallOptions { area_preserving: false })?;
    let material = SaintVenantKirchhoff::new(LameParameters { mu: MU, lambda: LAMBDA });
    let form = SolidForm::new(0.7, material, V::zeros())?;
    let options = ElasticOptions {
        scheme: Arc::new(ImplicitEuler),
        initial_displacement: Some(Arc::new(displacement)),
        initial_velocity: Some(Arc::new(move |_| velocity)),
        ..ElasticOptions::default()
    };
    Ok(Arc::new(ElasticBody::new("disk", SolidMesh::new(mesh)?, form, options)?))
}

const MU: f64 = 2e3;
const LAMBDA: f64 = 8e3;

fn translation(centre: P, random: &mut Random) -> Result<Vec<f64>, Failure> {
    let u = V::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let linear = Linear { b: u, p: 0.0, ..Linear::at_rest(V::zeros()) };
    let known = linear.known(0.05, &["top"]);
    let mut setup = known.setup(background()?, 0.02);
    setup.bodies.push(elastic(centre, 0.3, |_| V::zeros(), u)?);
    let (state, _) = flow::run(&setup, 10)?;
    let body = &state.bodies[0];
    let drift = body.velocity().iter().zip(body.displacement());
    let drift = drift.map(|(v, d)| (v - u).norm() + (d - u * state.time).norm()).fold(0.0, f64::max);
    let [u, p] = nodal_errors(&known, &setup, &state);
    Ok(vec![u, p, drift])
}

/// The disk `x = s X` with `(λ + μ)(s² - 1) = -p` balances the pressure p.
fn pressurised_disk(centre: P, random: &mut Random) -> Result<Vec<f64>, Failure> {
    let pressure = random.between(1.0, 100.0);
    let scale = (1.0 - pressure / (LAMBDA + MU)).sqrt();
    let known = Linear::at_rest(V::zeros()).known(0.1, &[]);
    let mut setup = known.setup(background()?, 1e-2);
    for (_, condition) in &mut fluid_mut(&mut setup).boundary {
        *condition = FluidBoundary::Open { traction: Some(Arc::new(move |_, n, _| n * -pressure)), backflow: true };
    }
    setup.bodies.push(elastic(centre, 0.4, move |x| (x - centre) * (scale - 1.0), V::zeros())?);
    let (state, _) = flow::run(&setup, 2)?;
    let largest = |values: &[V]| values.iter().map(V::norm).fold(0.0, f64::max);
    let p = wet(&state).pressure.iter().map(|p| (p / pressure - 1.0).abs()).fold(0.0, f64::max);
    Ok(vec![largest(&wet(&state).velocity), p, largest(state.bodies[0].velocity())])
}

/// Fluid shut in by a ring has a pressure of mean zero, beside fluid with an open side.
fn pocket(centre: P, _: &mut Random) -> Result<Vec<f64>, Failure> {
    let g = V::new(3.0, -2.0);
    let known = Linear::at_rest(g).known(0.1, &["right"]);
    let mut setup = known.setup(background()?, 0.05);
    let mut hole = disk(centre, 0.35, 31);
    hole.reverse();
    setup.bodies.push(polygon(&[disk(centre, 0.5, 37), hole], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 1)?;
    if wet_report(&report).n_pockets != 1 {
        return Err(format!("{} pockets in place of one", wet_report(&report).n_pockets).into());
    }
    let cut = &wet(&state).cut;
    let inside = |part| (fluid_of(&setup).background.simplex(cut.part_cell(part)).centroid() - centre).norm() < 0.42;
    let (mut error, mut mean, mut shift) = (0.0_f64, 0.0, None);
    for part in cut.all_parts().filter(|part| inside(*part)) {
        let dofs = wet(&state).space.dofs(part);
        let difference = |dof: u32| {
            let x = fluid_of(&setup).background.vertex(wet(&state).space.vertex(dof));
            wet(&state).pressure[dof as usize] - g.dot(&(x - centre))
        };
        let shift = *shift.get_or_insert(difference(dofs[0]));
        dofs.iter().for_each(|&dof| error = error.max((difference(dof) - shift).abs()));
        mean += shift * cut.part_volume(part);
    }
    // The polygon is symmetric enough for a linear function to have the mean of its centre: 31 corners, to round-off.
    Ok(vec![error, mean.abs()])
}
