//! Exact solutions that are in the discrete spaces. For any cut, errors must be round-off.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::mesh::generate::{BallOptions, ball};
use cutwater::solid_rigid::RigidMotion;
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff};
use cutwater::solver::body::Body;
use cutwater::solver::{FluidBoundary, Setup, State};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use super::conservation;
use super::dry::elastic;
use super::flow::{
    self, Flow, KnownFlow, area, disk, fluid_mut, fluid_of, outside, polygon, rigid_polygon, set_sides, wet, wet_report,
};
use super::linear_flow::{LinearFlow, SIZE, background, nonagon};
use super::record::{NamedNumbers, worse};
use super::{Failure, P, Record, T, V};

/// Largest error of a solved system that is round-off.
const ROUND_OFF: f64 = 1e-9;
/// Number of random positions, in short and in full.
const POSITIONS: [usize; 2] = [3, 20];

/// A problem with bodies at a random place.
type RandomProblem = fn(P, &mut SplitMix64) -> Result<NamedNumbers, Failure>;

/// Problems with the seeds of their random numbers.
const PROBLEMS: [(u64, RandomProblem); 12] = [
    (1, hydrostatic),
    (2, uniform_pressure),
    (3, |at, random| linear(at, random, "linear flow", false)),
    (4, |at, random| linear(at, random, "linear flow past a moving interface", true)),
    (5, annulus),
    (6, translation),
    (12, conservation::open),
    (13, conservation::swelling),
    (8, pressurised_disk),
    (10, neutral),
    (11, turning),
    (9, pocket),
];

/// Measures the errors of all problems, each at random positions of the bodies.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let n = POSITIONS[usize::from(record.full)];
    for (seed, problem) in PROBLEMS {
        let mut random = SplitMix64::seed_from_u64(seed);
        let mut largest = NamedNumbers::new();
        for _ in 0..n {
            let centre = P::new(random.random_range(0.8..1.2), random.random_range(0.65..0.85));
            let errors = problem(centre, &mut random)?;
            largest.resize(errors.len(), (String::new(), 0.0));
            for (largest, (name, error)) in largest.iter_mut().zip(errors) {
                *largest = (name, worse(largest.1, error));
            }
        }
        for (name, error) in largest {
            record.at_most(name, error, ROUND_OFF);
        }
    }
    conservation::leak(record)?;
    record.note(
        "The mesh does not move. Conservation of volume therefore requires that the outflow of the box equals the volume that \
         the body displaces. The test function 1 of the equation of continuity makes the sum of divergence and leak zero, not \
         the leak by itself, because the mortar couples velocities weakly.",
    );
    record.note(format!("{n} random positions each, on a mesh of size {SIZE} that is not fitted to the body."));
    Ok(())
}

/// Returns errors with the names of the problem and of its quantities.
fn named<const N: usize>(problem: &str, errors: [(&str, f64); N]) -> NamedNumbers {
    errors.map(|(quantity, error)| (format!("{problem}: {quantity}"), error)).into()
}

/// Returns the largest errors of velocity and pressure over the dofs.
fn nodal_errors<F: Flow>(known: &KnownFlow<F>, setup: &Setup<2>, state: &State<2>) -> Result<[f64; 2], Failure> {
    let (background, fluid, t) = (&fluid_of(setup)?.background, wet(state)?, state.time);
    let mut errors = [0.0_f64; 2];
    for (k, &vertex) in fluid.space.vertices().iter().enumerate() {
        let x = background.vertex(vertex);
        errors[0] = errors[0].max((fluid.velocity[k] - known.flow.velocity(&x, t)).norm());
        errors[1] = errors[1].max((fluid.pressure[k] - known.flow.pressure(&x, t)).abs());
    }
    Ok(errors)
}

fn hydrostatic(centre: P, _: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let g = V::new(0.0, -2.5);
    let known = LinearFlow::at_rest(g).known(0.1, &["top"]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    let corners = disk(centre, 0.37, 23);
    let weight = area(&corners) * g;
    setup.bodies.push(polygon(&[corners], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 2)?;
    let [u, p] = nodal_errors(&known, &setup, &state)?;
    let (force, _) = flow::force(&state, &report, 0, &centre)?;
    let buoyancy = (force + weight).norm();
    Ok(named(
        "hydrostatic",
        [("velocity", u), ("pressure", p), ("buoyancy compared with weight of the polygon", buoyancy)],
    ))
}

/// Measures the errors for a free body of the density of the fluid under gravity, which the pressure carries.
fn neutral(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let g = V::new(0.4, -2.5);
    let known = LinearFlow::at_rest(g).known(0.1, &["top"]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    setup.bodies.push(Arc::new(rigid_polygon(nonagon(centre, random), known.density, g / known.density)?));
    let (state, _) = flow::run(&setup, 3)?;
    let [u, p] = nodal_errors(&known, &setup, &state)?;
    let motion = RigidMotion::<2>::from_numbers(&state.bodies[0].inner);
    let mut errors = named("neutral rigid body in hydrostatic pressure", [("velocity", u)]);
    let of_body = motion.velocity.norm().max(motion.spin[0].abs());
    errors.extend(named("the same", [("pressure", p), ("velocity and spin of the body", of_body)]));
    Ok(errors)
}

/// Measures the errors for fluid that turns as a rigid body, and for a free body of any shape that turns in it about
/// its centre of mass.
fn turning(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let spin = 1.3;
    let mut body = rigid_polygon(nonagon(centre, random), 0.8, V::zeros())?;
    body.initial_spin[0] = spin;
    let (turn, about) = (T::new(0.0, -spin, spin, 0.0), body.mass.centre);
    let linear = LinearFlow { a: turn, b: -(turn * about), g: V::zeros(), p: 0.0, density: 1.2, convects: false };
    let known = linear.known(0.7, &[]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    setup.bodies.push(Arc::new(body));
    let (state, _) = flow::run(&setup, 4)?;
    let motion = RigidMotion::<2>::from_numbers(&state.bodies[0].inner);
    let error = motion.velocity.norm().max((motion.spin[0] - spin).abs());
    let [u, _] = nodal_errors(&known, &setup, &state)?;
    let mut errors = named("rigid body in fluid that turns about its centre", [("velocity", u)]);
    errors.extend(named("the same", [("velocity and spin of the body", error)]));
    Ok(errors)
}

fn uniform_pressure(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let known = LinearFlow::at_rest(V::zeros()).known(0.1, &["right", "top"]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    setup.bodies.push(polygon(&[nonagon(centre, random)], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 2)?;
    let (force, moment) = flow::force(&state, &report, 0, &centre)?;
    let [u, _] = nodal_errors(&known, &setup, &state)?;
    Ok(named(
        "uniform pressure",
        [("velocity", u), ("force on the body", force.norm()), ("moment on the body", moment.abs())],
    ))
}

fn linear(centre: P, random: &mut SplitMix64, name: &str, moves: bool) -> Result<NamedNumbers, Failure> {
    let mut entry = || random.random_range(-1.0..1.0);
    let (a, b, c) = (entry(), entry(), entry());
    let linear = LinearFlow {
        a: T::new(a, b, c, -a),
        b: V::new(entry(), entry()),
        g: V::new(entry(), entry()),
        p: 1.7,
        density: 1.2,
        convects: true,
    };
    let known = linear.known(if moves { 0.1 } else { 1.0 }, &["top"]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    let speed = if moves { V::new(2.0, -1.0) } else { V::zeros() };
    setup.bodies.push(polygon(&[disk(centre, 0.3, 19)], move |x, t| x + speed * t, known.velocity()));
    let (state, _) = flow::run(&setup, 3)?;
    let [u, p] = nodal_errors(&known, &setup, &state)?;
    Ok(named(name, [("velocity", u), ("pressure", p)]))
}

/// Measures the errors for fluid between a disk and a ring that turn with the same angular velocity. The velocity is
/// linear, and no moment acts.
fn annulus(centre: P, _: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let turn = T::new(0.0, -1.3, 1.3, 0.0);
    let linear = LinearFlow { a: turn, b: -(turn * centre), g: V::zeros(), p: 0.0, density: 1.0, convects: false };
    let known = linear.known(0.7, &[]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    setup.bodies.push(polygon(&[disk(centre, 0.25, 17)], |x, _| *x, known.velocity()));
    setup.bodies.push(polygon(&outside(disk(centre, 0.5, 31), centre, 3.0), |x, _| *x, known.velocity()));
    fluid_mut(&mut setup)?.boundary.clear();
    let (state, report) = flow::run(&setup, 2)?;
    // Dofs of cut cells lie in the bodies, where the flow is continued.
    let [u, _] = nodal_errors(&known, &setup, &state)?;
    let (_, moment) = flow::force(&state, &report, 0, &centre)?;
    Ok(named("annulus turning as one", [("velocity", u), ("moment", moment.abs())]))
}

/// Returns an elastic disk, with a displacement and a velocity at the start.
fn elastic_disk(
    centre: P,
    radius: f64,
    displacement: impl Fn(&P) -> V + Send + Sync + 'static,
    velocity: V,
) -> Result<Arc<dyn Body<2>>, Failure> {
    let mesh = ball::<2>([centre[0], centre[1]], radius, 0.1, &BallOptions { area_preserving: false })?;
    let material = SaintVenantKirchhoff::new(LameParameters { mu: MU, lambda: LAMBDA });
    let mut body = elastic(mesh, 0.7, material, V::zeros(), Arc::new(ImplicitEuler))?;
    body.options.initial_displacement = Some(Arc::new(displacement));
    body.options.initial_velocity = Some(Arc::new(move |_| velocity));
    body.body("disk")
}

const MU: f64 = 2e3;
const LAMBDA: f64 = 8e3;

fn translation(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let u = V::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
    let linear = LinearFlow { b: u, p: 0.0, ..LinearFlow::at_rest(V::zeros()) };
    let known = linear.known(0.05, &["top"]);
    let mut setup = known.setup(background(SIZE)?, 0.02);
    setup.bodies.push(elastic_disk(centre, 0.3, |_| V::zeros(), u)?);
    let (state, _) = flow::run(&setup, 10)?;
    let body = &state.bodies[0];
    let drift = body.velocity().iter().zip(body.displacement());
    let drift = drift.map(|(v, d)| (v - u).norm() + (d - u * state.time).norm()).fold(0.0, f64::max);
    let [u, p] = nodal_errors(&known, &setup, &state)?;
    let mut errors = named("body and fluid in translation", [("velocity", u), ("pressure", p)]);
    errors.extend(named("the same", [("body", drift)]));
    Ok(errors)
}

/// Measures the errors for a disk `x = s X` that with `(λ + μ)(s² - 1) = -p` balances the pressure p.
fn pressurised_disk(centre: P, random: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let pressure = random.random_range(1.0..100.0);
    let scale = (1.0 - pressure / (LAMBDA + MU)).sqrt();
    let known = LinearFlow::at_rest(V::zeros()).known(0.1, &[]);
    let mut setup = known.setup(background(SIZE)?, 1e-2);
    set_sides(&mut setup, || FluidBoundary::Open {
        traction: Some(Arc::new(move |_, n, _| n * -pressure)),
        backflow: true,
    })?;
    setup.bodies.push(elastic_disk(centre, 0.4, move |x| (x - centre) * (scale - 1.0), V::zeros())?);
    let (state, _) = flow::run(&setup, 2)?;
    let largest = |values: &[V]| values.iter().map(V::norm).fold(0.0, f64::max);
    let fluid = wet(&state)?;
    let p = fluid.pressure.iter().map(|p| (p / pressure - 1.0).abs()).fold(0.0, f64::max);
    let [u, v] = [largest(&fluid.velocity), largest(state.bodies[0].velocity())];
    Ok(named("pressurised disk", [("velocity", u), ("pressure", p), ("velocity of the disk", v)]))
}

/// Measures the errors for fluid enclosed by a ring, whose pressure has mean zero, and for fluid outside with an open
/// side.
fn pocket(centre: P, _: &mut SplitMix64) -> Result<NamedNumbers, Failure> {
    let g = V::new(3.0, -2.0);
    let known = LinearFlow::at_rest(g).known(0.1, &["right"]);
    let mut setup = known.setup(background(SIZE)?, 0.05);
    let mut hole = disk(centre, 0.35, 31);
    hole.reverse();
    setup.bodies.push(polygon(&[disk(centre, 0.5, 37), hole], |x, _| *x, Arc::new(|_, _| V::zeros())));
    let (state, report) = flow::run(&setup, 1)?;
    let n_pockets = wet_report(&report)?.n_pockets;
    if n_pockets != 1 {
        return Err(format!("{n_pockets} pockets in place of one").into());
    }
    let (background, fluid) = (&fluid_of(&setup)?.background, wet(&state)?);
    let cut = &fluid.cut;
    let inside = |part| (background.simplex(cut.part_cell(part)).centroid() - centre).norm() < 0.42;
    let (mut error, mut mean, mut shift) = (0.0_f64, 0.0, None);
    for part in cut.all_parts().filter(|part| inside(*part)) {
        let dofs = fluid.space.dofs(part);
        let difference = |dof: u32| {
            let x = background.vertex(fluid.space.vertex(dof));
            fluid.pressure[dof as usize] - g.dot(&(x - centre))
        };
        let shift = *shift.get_or_insert(difference(dofs[0]));
        dofs.iter().for_each(|&dof| error = error.max((difference(dof) - shift).abs()));
        mean += shift * cut.part_volume(part);
    }
    // The mean of a linear function over the polygon of 31 corners is its value at the centre, up to round-off.
    Ok(named("pocket", [("pressure up to its mean", error), ("mean of the pressure", mean.abs())]))
}
