//! Flows with rotational symmetry around spheres, against exact solutions and fitted computations.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use cutwater::algebra::time::{ImplicitEuler, QuasiStatic};
use cutwater::contact::{ContactForm, NitscheLaw, PenaltyLaw};
use cutwater::mesh::generate::{BallOptions, Region, RegionShape, Size, half_ball, refined_box, structured_box};
use cutwater::mesh::{Coordinates, SimplexMesh};
use cutwater::solid_rigid::RigidBody;
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff};
use cutwater::solver::body::{Body, PrescribedBody, TimeField};
use cutwater::solver::{ConvectionForm, FluidBoundary, Setup, StepReport};

use super::dry::{self, Elastic, GAMMA_0, Scheme, elastic, pushed, second_order};
use super::flow::{
    self, Errors, Flow, KnownFlow, boundary, fluid, fluid_mut, force, open, problem, set_side, wall_below,
};
use super::mode::frequency_of;
use super::orders::{MeasuredErrors, ORDERS, in_space};
use super::signal::passage;
use super::{DirectRun, Failure, P, Record, T, V};

/// Largest relative error of the drag on the finest mesh of the Stokes flow.
const DRAG: f64 = 0.005;
// Largest relative differences of the other forces.
const TUBE: f64 = 0.02;
const WALL: f64 = 0.03;
const ADDED_MASS: f64 = 0.02;
const WAKE: f64 = 0.02;
const MODES: f64 = 0.01;
const HERTZ: [f64; 2] = [0.02, 0.03];
// Ball of radius one on a plane. Displacement of its middle plane; the radius of contact is then a tenth of that of
// the ball.
const APPROACH: f64 = 0.01;
const YOUNG: f64 = 1.0;
const POISSON: f64 = 0.3;
/// Ratio of pressure to penetration, such that the penetration is a thousandth of the approach.
const STIFFNESS: f64 = 1e4;
const LOAD_STEPS: u32 = 4;
/// Edges of the sphere in the length of a cell.
const EDGES_PER_CELL: f64 = 3.0;

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[usize] = if record.full { &[16, 32, 64, 128] } else { &[16, 32, 64] };
    let drags = in_space(record, "Stokes flow past a sphere", sizes, stokes)?;
    let (_, finest) = *drags.last().ok_or("no mesh")?;
    record.at_most("Stokes flow past a sphere, finest mesh: relative error of the drag", finest, DRAG);
    record.order("Stokes flow past a sphere: drag, relative error", "h", &drags, ORDERS[0]);
    in_space(record, "Hill's vortex", sizes, hill)?;
    tube(record)?;
    wall(record)?;
    added_mass(record)?;
    if record.full {
        wake(record)?;
    }
    modes(record)?;
    hertz(record)?;
    record.note(
        "Squares of one size and a sphere of radius 1/2 in Stokes flow and Hill's vortex, with the velocity of the known flow on the sphere and on \
         all outer sides. References: exact solutions for these two; the series of Brenner 1961, doi:10.1016/0009-2509(61)80035-3, for the wall; \
         images of doublets for the added mass (Lamb, Hydrodynamics, art. 98 and 137); a fitted computation with elements of third and second order \
         for tube and wake, whose drag is within 0.6 % of published values.",
    );
    Ok(())
}

/// Returns the half plane of a sphere on the axis: vertices on the sphere, from the lowest point to the highest, closed
/// along the axis.
pub(super) fn sphere(height: f64, radius: f64, cell: f64) -> Vec<P> {
    let n = (PI * radius * EDGES_PER_CELL / cell).ceil() as usize;
    let at = |k: usize| {
        let angle = PI * k as f64 / n as f64;
        // The ends lie on the axis exactly.
        let r = if k == 0 || k == n { 0.0 } else { radius * angle.sin() };
        P::new(r, height - radius * angle.cos())
    };
    (0..=n).map(at).collect()
}

/// Returns a body with a given motion on the axis.
pub(super) fn moving(
    corners: Vec<P>,
    position: impl Fn(&P, f64) -> P + Send + Sync + 'static,
    velocity: TimeField<2>,
) -> Arc<dyn Body<2>> {
    Arc::new(PrescribedBody {
        name: "sphere".to_owned(),
        boundary: boundary(std::slice::from_ref(&corners)).with_coordinates(Coordinates::Axisymmetric),
        reference: corners,
        position: Arc::new(position),
        velocity: Arc::new(move |x, [_, t]| velocity(x, t)),
    })
}

/// Returns a fluid around the axis without inertia, with one condition on its outer sides.
pub(super) fn slow(
    background: SimplexMesh<2>,
    dt: f64,
    outer: impl Fn(&str) -> FluidBoundary<2>,
) -> Result<Setup<2>, Failure> {
    let mut setup = problem(fluid(background.with_coordinates(Coordinates::Axisymmetric)?, 1e-9, 1.0), dt);
    for side in ["left", "right", "bottom", "top"] {
        set_side(&mut setup, side, if side == "left" { FluidBoundary::symmetry(0) } else { outer(side) })?;
    }
    setup.scheme = Arc::new(QuasiStatic);
    Ok(setup)
}

/// Stokes flow of a sphere of radius `RADIUS` that moves with speed one.
struct Stokes;
const RADIUS: f64 = 0.5;

impl Flow for Stokes {
    fn velocity(&self, x: &P, _: f64) -> V {
        let (r, z, a) = (x[0], x[1], RADIUS);
        let rho = x.norm();
        let radial = 0.75 * a * r * z / rho.powi(3) * (1.0 - a * a / (rho * rho));
        let axial = 0.75 * a / rho * (1.0 + z * z / (rho * rho))
            + 0.25 * a.powi(3) / rho.powi(3) * (1.0 - 3.0 * z * z / (rho * rho));
        V::new(radial, axial)
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        let (r, z, a) = (x[0], x[1], RADIUS);
        let d2 = x.norm_squared();
        let d = d2.sqrt();
        // u_r = 3a/4 (r z d⁻³ - a² r z d⁻⁵), u_z = 3a/4 (d⁻¹ + z² d⁻³) + a³/4 (d⁻³ - 3 z² d⁻⁵).
        let power = |n: i32| d.powi(-n);
        let by = |of_r: f64, of_z: f64| [of_r, of_z];
        let rz = |n: i32| {
            by(
                z * power(n) - f64::from(n) * r * r * z * power(n + 2),
                r * power(n) - f64::from(n) * r * z * z * power(n + 2),
            )
        };
        let zz = |n: i32| {
            by(-f64::from(n) * r * z * z * power(n + 2), 2.0 * z * power(n) - f64::from(n) * z.powi(3) * power(n + 2))
        };
        let one = |n: i32| by(-f64::from(n) * r * power(n + 2), -f64::from(n) * z * power(n + 2));
        let row_r: [f64; 2] = std::array::from_fn(|k| 0.75 * a * (rz(3)[k] - a * a * rz(5)[k]));
        let row_z: [f64; 2] = std::array::from_fn(|k| {
            0.75 * a * (one(1)[k] + zz(3)[k]) + 0.25 * a.powi(3) * (one(3)[k] - 3.0 * zz(5)[k])
        });
        T::new(row_r[0], row_r[1], row_z[0], row_z[1])
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        1.5 * RADIUS * x[1] / x.norm().powi(3)
    }
}

/// Hill's spherical vortex, an exact steady solution of the equations of Navier and Stokes.
struct Hill {
    density: f64,
    viscosity: f64,
}

impl Flow for Hill {
    fn velocity(&self, x: &P, _: f64) -> V {
        V::new(x[0] * x[1], 1.0 - x[1] * x[1] - 2.0 * x[0] * x[0])
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        T::new(x[1], x[0], -4.0 * x[0], -2.0 * x[1])
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        let (r2, z) = (x[0] * x[0], x[1]);
        -self.density * (0.5 * r2 - 0.5 * r2 * r2 - z * z + 0.5 * z.powi(4)) - 10.0 * self.viscosity * z
    }
}

/// Solves for a known steady flow around a sphere at rest in the mesh, on squares of size `1/n`. Returns the force on
/// the sphere along the axis too.
fn known_flow<F: Flow>(known: &KnownFlow<F>, n: usize) -> Result<(Errors, f64), Failure> {
    let background = structured_box::<2>([0.0, -1.0], [1.0, 1.0], [n, 2 * n])?;
    let mut setup = known.setup(background.with_coordinates(Coordinates::Axisymmetric)?, 1e9);
    set_side(&mut setup, "left", FluidBoundary::symmetry(0))?;
    setup.bodies.push(moving(sphere(0.0, RADIUS, 1.0 / n as f64), |x, _| *x, known.velocity()));
    let (state, report) = flow::run(&setup, 1)?;
    Ok((known.errors(&setup, &state)?, force(&state, &report, 0, &P::zeros())?.0[1]))
}

fn stokes(n: usize) -> Result<MeasuredErrors, Failure> {
    let known = KnownFlow { flow: Arc::new(Stokes), density: 1.0, viscosity: 1.0, convects: false, open: &[] };
    let (errors, force) = known_flow(&known, n)?;
    Ok((errors, Some((force / (-6.0 * PI * RADIUS) - 1.0).abs())))
}

fn hill(n: usize) -> Result<MeasuredErrors, Failure> {
    let (density, viscosity) = (1.0, 0.05);
    let flow = Arc::new(Hill { density, viscosity });
    let (errors, _) = known_flow(&KnownFlow { flow, density, viscosity, convects: true, open: &[] }, n)?;
    Ok((errors, None))
}

/// Measures the drag of a sphere in a closed tube of twice its radius.
fn tube(record: &mut Record) -> Result<(), Failure> {
    /// Drag over `6 π μ a U`.
    const EXACT: f64 = 5.9474;
    /// Half of the length of the tube over its radius, at which the flow of the sphere has decayed to `exp(-13)`.
    const HALF_LENGTH: f64 = 3.0;
    for cells in if record.full { &[10, 20, 40][..] } else { &[10, 20][..] } {
        // The sphere has radius one.
        let n = [2 * cells, (4.0 * HALF_LENGTH * *cells as f64) as usize];
        let background = structured_box::<2>([0.0, -2.0 * HALF_LENGTH], [2.0, 2.0 * HALF_LENGTH], n)?;
        let h = 1.0 / *cells as f64;
        let mut setup = slow(background, 0.31 * h, |_| FluidBoundary::NoSlip)?;
        setup.bodies.push(moving(sphere(0.0, 1.0, h), |x, t| x + V::new(0.0, t), Arc::new(|_, _| V::new(0.0, 1.0))));
        let mut run = DirectRun::new(setup)?;
        let mut drags = Vec::new();
        for _ in 0..5 {
            let report = run.advance()?;
            drags.push(-force(&run.state, &report, 0, &P::zeros())?.0[1] / (6.0 * PI));
        }
        let mean = drags.iter().sum::<f64>() / drags.len() as f64;
        let name = format!("closed tube of twice the radius, {cells} cells per radius: drag over that without walls");
        if *cells == 20 {
            record.near_relative(name, mean, EXACT, TUBE);
        } else {
            record.show(name, mean, Some(EXACT));
        }
    }
    Ok(())
}

/// Measures the drag of a sphere that approaches a wall, with four cells between them or more.
fn wall(record: &mut Record) -> Result<(), Failure> {
    /// Gap over the radius, and drag over `6 π μ a U`.
    const EXACT: [(f64, f64); 2] = [(0.5, 3.2053903), (0.2, 6.3408867)];
    /// Extent of the fluid in radii. Without an outer boundary drags are lower by less than 1 %.
    const FAR: f64 = 40.0;
    /// Cells per radius of the second mesh of the larger gap.
    const FINE: f64 = 20.0;
    let of_gaps = EXACT.map(|(gap, exact)| (gap, exact, gap / 4.0));
    for (gap, exact, h) in of_gaps.into_iter().chain([(EXACT[0].0, EXACT[0].1, 1.0 / FINE)]) {
        let near = RegionShape::Segment { ends: [P::new(0.0, 0.0), P::new(0.0, gap + 2.0)], within: 1.2 };
        let regions = [Region { shape: near, size: h, growth: 0.25 }];
        let background = refined_box([0.0, 0.0], [FAR, FAR], &Size::uniform(4.0), &regions)?;
        let mut setup = slow(background, 1e-3 * h, wall_below)?;
        let velocity = Arc::new(|_: &P, _| V::new(0.0, -1.0));
        setup.bodies.push(moving(sphere(1.0 + gap, 1.0, h), |x, t| x - V::new(0.0, t), velocity));
        let (state, report) = flow::run(&setup, 1)?;
        let drag = force(&state, &report, 0, &P::zeros())?.0[1] / (6.0 * PI);
        record.near_relative(
            format!("approach to a wall, gap {gap} radii, {:.0} cells across it: drag over that without wall", gap / h),
            drag,
            exact,
            WALL,
        );
    }
    Ok(())
}

/// Measures the first acceleration of a free sphere in fluid of a quarter of its density, far from walls and near one.
fn added_mass(record: &mut Record) -> Result<(), Failure> {
    /// Gap between sphere and wall over the radius, and added mass over that of the displaced fluid.
    const EXACT: [(f64, f64); 3] = [(10.0, 0.500141), (1.0, 0.523891), (0.2, 0.624824)];
    const FAR: f64 = 30.0;
    const DENSITY: f64 = 4.0;
    // A step in which the boundary layer has a thickness of 1e-4 radii, and the motion is 1e-8 radii.
    const STEP: f64 = 1e-4;
    const VISCOSITY: f64 = 1e-4;
    for (gap, exact) in EXACT {
        let h = if gap < 0.5 { gap / 6.0 } else { 0.05 };
        let centre = P::new(0.0, 1.0 + gap);
        let near = RegionShape::Segment { ends: [centre, centre], within: 1.2 };
        let regions = [Region { shape: near, size: h, growth: 0.2 }];
        let background = refined_box([0.0, 0.0], [FAR, FAR], &Size::uniform(3.0), &regions)?;
        let on_side = |side: &str| if side == "bottom" { FluidBoundary::symmetry(1) } else { open() };
        let mut setup = slow(background, STEP, on_side)?;
        setup.scheme = Arc::new(ImplicitEuler);
        let fluid = fluid_mut(&mut setup)?;
        (fluid.material.density, fluid.material.viscosity) = (1.0, VISCOSITY);
        let corners = sphere(1.0 + gap, 1.0, h);
        let surface = boundary(std::slice::from_ref(&corners)).with_coordinates(Coordinates::Axisymmetric);
        let body = RigidBody::new("sphere", surface, corners, DENSITY, V::new(0.0, -1.0))?;
        let volume = body.mass.mass / DENSITY;
        setup.bodies.push(Arc::new(body));
        let (_, report) = flow::run(&setup, 1)?;
        let momentum = report.bodies[0].balance.ok_or("no mass")?.momentum[1];
        // Mass times gravity over acceleration, less the mass.
        let added = (volume * DENSITY).powi(2) / (-momentum / STEP) - volume * DENSITY;
        record.near_relative(
            format!("added mass of a sphere at a gap of {gap} radii, over that of the displaced fluid"),
            added / volume,
            exact,
            ADDED_MASS,
        );
    }
    Ok(())
}

/// Measures the drag of a sphere in a stream at a Reynolds number of 100.
fn wake(record: &mut Record) -> Result<(), Failure> {
    /// Drag coefficient on the area `π R²`.
    const EXACT: f64 = 1.0886;
    const CELLS: f64 = 40.0;
    const UPSTREAM: f64 = 20.0;
    const DOWNSTREAM: f64 = 40.0;
    let h = 1.0 / CELLS;
    let segment = |length: f64, within: f64, size: f64, growth: f64| Region {
        shape: RegionShape::Segment { ends: [P::zeros(), P::new(0.0, length)], within },
        size,
        growth,
    };
    let regions = [segment(0.0, 1.2, h, 0.15), segment(4.0, 1.5, 3.0 * h, 0.15), segment(12.0, 1.5, 8.0 * h, 0.15)];
    let background = refined_box([0.0, -UPSTREAM], [UPSTREAM, DOWNSTREAM], &Size::uniform(2.0), &regions)?;
    // Diameter 2, speed 1, Re 100.
    let mut setup = slow(background, 2.0, |side| match side {
        "bottom" => FluidBoundary::Velocity(Arc::new(|_, _| V::new(0.0, 1.0))),
        "right" => FluidBoundary::symmetry(0),
        _ => FluidBoundary::Open { traction: None, backflow: true },
    })?;
    setup.scheme = Arc::new(ImplicitEuler);
    let fluid = fluid_mut(&mut setup)?;
    (fluid.material.density, fluid.material.viscosity) = (1.0, 0.02);
    fluid.convection = Some(ConvectionForm::Standard);
    fluid.initial_velocity = Some(Arc::new(|_| V::new(0.0, 1.0)));
    setup.bodies.push(moving(sphere(0.0, 1.0, h), |x, _| *x, Arc::new(|_, _| V::zeros())));
    let mut run = DirectRun::lagged(setup)?;
    let mut drag = 0.0_f64;
    for step in 0.. {
        let report = run.advance()?;
        let force = force(&run.state, &report, 0, &P::zeros())?.0[1];
        let now = force / (0.5 * PI);
        let is_steady = (now / drag - 1.0).abs() < 1e-5;
        drag = now;
        if is_steady || step == 60 {
            break;
        }
    }
    record.near_relative(
        "stream at a Reynolds number of 100, 40 cells per radius: drag coefficient",
        drag,
        EXACT,
        WAKE,
    );
    Ok(())
}

/// Returns the half plane of an elastic ball of radius one.
fn elastic_ball(size: f64, lame: LameParameters, scheme: Scheme) -> Result<Elastic<2>, Failure> {
    let options = BallOptions { area_preserving: false };
    let mesh = half_ball::<2>([0.0, 1.0], 1.0, size, &options)?.with_coordinates(Coordinates::Axisymmetric)?;
    elastic(mesh, 1.0, SaintVenantKirchhoff::new(lame), V::zeros(), scheme)
}

/// Measures the frequency of the lowest mode of a free elastic ball: an ellipsoid that is long and flat in turns.
fn modes(record: &mut Record) -> Result<(), Failure> {
    /// Poisson's ratio, and `ω R/c_s`: roots of the frequency determinant of a free ball (Lamb 1881,
    /// doi:10.1112/plms/s1-13.1.189).
    const EXACT: [(f64, f64); 2] = [(0.25, 2.63987), (0.4, 2.65694)];
    const PERIODS: f64 = 6.0;
    const STEPS: f64 = 96.0;
    for (poisson, omega) in EXACT {
        // Shear modulus and density one: the shear waves have the speed one.
        let lame = LameParameters::from_young_poisson(2.0 * (1.0 + poisson), poisson)?;
        let period = TAU / omega;
        let size = if record.full { 0.05 } else { 0.1 };
        let mut body = elastic_ball(size, lame, second_order(0.8)?)?;
        // Close to the shape of the mode: no change of volume. The amplitude is the difference of its moments of
        // inertia.
        let strain = |x: &P| V::new(-0.5 * x[0], x[1] - 1.0) * 1e-4;
        body.options.initial_displacement = Some(Arc::new(strain));
        let weights: Vec<V> = body.solid.nodes().iter().map(strain).collect();
        let mut mass = vec![0.0; weights.len()];
        for cell in body.solid.mesh().cells() {
            let nodes = body.solid.cell(cell);
            for (node, row) in nodes.iter().zip(body.solid.mass(cell).chunks_exact(nodes.len())) {
                mass[node.index()] += row.iter().sum::<f64>();
            }
        }
        let run = dry::run(vec![body], None, period / STEPS, 1e-9)?;
        let amplitude = |d: &[V]| d.iter().zip(&weights).zip(&mass).map(|((d, w), m)| d.dot(w) * m).sum();
        let found = frequency_of(run, PERIODS * period, amplitude)? * TAU;
        record.near_relative(
            format!("elastic ball, Poisson's ratio {poisson}: ω R/c_s of its lowest mode"),
            found,
            omega,
            MODES,
        );
    }
    Ok(())
}

/// Returns the run of an elastic ball that is pressed on a rigid plane, n by n squares in its lower half.
fn pressed_ball(n: usize, form: ContactForm<2>) -> Result<(DirectRun, StepReport<2>), Failure> {
    // The lower half of the ball, graded towards its lowest point.
    let graded = |s: f64| (4.0 * s).sinh() / 4.0_f64.sinh();
    let map = |x: &P| {
        let (across, down) = (graded(x[0]), 1.0 - graded(x[1]));
        P::new(across * (1.0 - 0.5 * down * down).sqrt(), 1.0 - down * (1.0 - 0.5 * across * across).sqrt())
    };
    let mesh = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [n, n])?.mapped(map)?;
    let material = SaintVenantKirchhoff::new(LameParameters::from_young_poisson(YOUNG, POISSON)?);
    let mesh = mesh.with_coordinates(Coordinates::Axisymmetric)?;
    let mut body = elastic(mesh, 1.0, material, V::zeros(), Arc::new(QuasiStatic))?;
    body.hold("top", pushed([None, Some(-APPROACH)]))?;
    let contact = dry::floor_by(body.part("bottom")?, form)?;
    let mut run = dry::run(vec![body], Some(contact), f64::from(LOAD_STEPS).recip(), 1e-10)?;
    let report = run.advance_by(LOAD_STEPS)?;
    Ok((run, report))
}

/// Records force and radius of contact of an elastic ball that is pressed on a rigid plane.
fn hertz(record: &mut Record) -> Result<(), Failure> {
    let n = if record.full { 96 } else { 48 };
    let (run, report) = pressed_ball(n, ContactForm::new(PenaltyLaw::new(STIFFNESS, 0.0)?, 1.0)?)?;
    let load = report.contacts[0].force[1];
    let modulus = YOUNG / (1.0 - POISSON * POISSON);
    let facets = run.setup.contacts[0].facets();
    let surface = run.setup.bodies[0].surface();
    let positions = run.state.bodies[0].positions(run.setup.bodies[0].reference());
    let mut below: Vec<(f64, f64)> =
        surface.vertices_of(facets).iter().map(|v| (positions[v.index()][0], positions[v.index()][1])).collect();
    below.sort_by(|a, b| a.0.total_cmp(&b.0));
    let inside = below.iter().take_while(|at| at.1 < 0.0).count();
    let (Some(last), Some(next)) = (below[..inside].last(), below.get(inside)) else {
        return Err("there is no contact, or nothing but contact".into());
    };
    let radius = passage([*last, *next], 0.0);
    // The displacement of the pole is the penetration of the penalty.
    let pole = below[0].1;
    let approach = APPROACH + pole.min(0.0);
    let name = "elastic ball on a plane, approach of a hundredth of its radius";
    record.near_relative(format!("{name}: force"), load, 4.0 / 3.0 * modulus * approach.powf(1.5), HERTZ[0]);
    record.near_relative(format!("{name}: radius of contact"), radius, approach.sqrt(), HERTZ[1]);
    record.show(format!("{name}: facets in that radius"), inside as f64, None);
    let mut found = Vec::new();
    for gamma_0 in GAMMA_0 {
        let (run, report) = pressed_ball(n, ContactForm::new(NitscheLaw::new(gamma_0, 0.0, 0.0)?, 1.0)?)?;
        let (contact, surface) = (&report.contacts[0], run.setup.bodies[0].surface());
        let positions = run.state.bodies[0].positions(run.setup.bodies[0].reference());
        let moment = |power: i32| -> f64 {
            let of_facet = |&(facet, pressure)| {
                let [a, b] = [0, 1].map(|k| positions[surface.facet(facet)[k].index()][0]);
                pressure * (b - a).abs() * (0.5 * (a + b)).powi(power)
            };
            contact.slave_pressures.iter().map(of_facet).sum()
        };
        // The second moment of the pressure of Hertz on a disk is 2/5 of the square of its radius.
        let (load, radius) = (contact.force[1], (2.5 * moment(3) / moment(1)).sqrt());
        let approach = APPROACH + run.state.bodies[0].displacement()[0][1].min(0.0);
        let name = format!("{name}, Nitsche with gamma_0 = {gamma_0}");
        record.near_relative(format!("{name}: force"), load, 4.0 / 3.0 * modulus * approach.powf(1.5), HERTZ[0]);
        record.near_relative(format!("{name}: radius from the second moment"), radius, approach.sqrt(), HERTZ[1]);
        found.push([load, radius]);
    }
    for (k, what) in ["force", "radius"].into_iter().enumerate() {
        let change = (found[1][k] / found[0][k] - 1.0).abs();
        record.at_most(format!("{name}, Nitsche, gamma_0 times 100: change of the {what}, relative"), change, 0.005);
    }
    Ok(())
}

/// Returns the force on a sphere of radius one that approaches a wall at a gap, over that without wall: Brenner 1961,
/// doi:10.1016/0009-2509(61)80035-3.
pub(super) fn brenner(gap: f64) -> f64 {
    let a = (1.0 + gap).acosh();
    let term = |n: f64| {
        // Both hyperbolic functions are scaled by exp(-(2n + 1) a).
        let m = 2.0 * n + 1.0;
        let decay = (-2.0 * m * a).exp();
        let scale = (-m * a).exp();
        let above = (1.0 - decay) + m * (2.0 * a).sinh() * scale;
        let sinh = (-0.5 * m * a).exp() * (0.5 * m * a).sinh();
        let below = 4.0 * sinh * sinh - m * m * a.sinh().powi(2) * scale;
        n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * (above / below - 1.0)
    };
    let n = (60.0 / a).ceil() as usize + 1;
    4.0 / 3.0 * a.sinh() * (1..=n).map(|n| term(n as f64)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_has_its_tabulated_values() {
        for (gap, force) in [(10.0, 1.1135032), (1.0, 2.1255356), (0.1, 11.459157), (0.001, 1002.3533)] {
            assert!((brenner(gap) / force - 1.0).abs() < 1e-6, "{gap}: {}", brenner(gap));
        }
    }
}
