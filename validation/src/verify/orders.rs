//! Orders of convergence on flows that are known, around bodies at rest and in motion.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{Setup, State};

use super::dry::{Scheme, second_order};
use super::flow::{self, Errors, Flow, KnownFlow, disk, fluid_mut, outside, polygon};
use super::record::Points;
use super::{Failure, P, Record, T, V};

// Required orders of velocity, its gradient and pressure in L2, in h; of the velocity in the time step.
pub(super) const ORDERS: [f64; 3] = [1.9, 0.95, 1.4];
const TIME_ORDER: f64 = 0.95;
/// Required orders in the time step of the velocity and of its gradient with the scheme of second order.
const SECOND_ORDERS: [f64; 2] = [1.8, 1.5];
/// Spectral radius of that scheme, with which it is stable for any number of cells that a body crosses in a step.
const RHO_INF: f64 = 0.0;
/// Length of a step in which inertia is negligible: steady flow.
const STEADY: f64 = 1e9;

/// Errors of a sequence of meshes or steps.
type Sequence = Vec<(f64, Errors)>;

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[usize] = if record.full { &[16, 32, 64, 128] } else { &[16, 32, 64] };
    in_space(record, "Stokes polynomial", sizes, stokes_polynomial)?;
    in_space(record, "Kovasznay", sizes, kovasznay)?;
    let torques = in_space(record, "Couette annulus", sizes, couette)?;
    record.order("torque, relative error", "h", &torques, 1.9);
    in_space(record, "disk vortex", sizes, disk_vortex)?;
    let sizes: &[usize] = if record.full { &[8, 16, 32, 64] } else { &[8, 16, 32] };
    in_space(record, "Taylor-Green past a moving disk, dt ~ h²", sizes, |n| {
        taylor_green(n, 0.05 * (8.0 / n as f64).powi(2))
    })?;
    in_time(record, if record.full { 96 } else { 48 })?;
    past_uncovered_fluid(record)?;
    of_schemes(record)?;
    of_curved_flow(record)?;
    record.note(
        "Boxes of n × n squares, bodies with edges as long as theirs. On the surfaces of bodies there is the velocity of the known \
         flow, and on the sides of the box too but for the right one, where its traction is; annulus and vortex are inside of a \
         body that covers all sides. Steady flows are one step of 1e9 s. In the time step, errors of gradient and pressure past \
         the moving disk are those of the mesh in the end: their orders are only shown.",
    );
    record.note(
        "Past the disk at rest, steps are at least ρ h²/μ = 0.0043: below that, the interior penalty of the pressure, which has the \
         step in it, changes as much as the solution in time.",
    );
    Ok(())
}

/// Results on one mesh: the errors, and an optional additional number, such as the relative error of a force.
pub(super) type MeasuredErrors = (Errors, Option<f64>);

/// Measures the orders in h. Returns the additional numbers with the sizes of their meshes.
pub(super) fn in_space(
    record: &mut Record,
    name: &str,
    sizes: &[usize],
    of: impl Fn(usize) -> Result<MeasuredErrors, Failure>,
) -> Result<Vec<(f64, f64)>, Failure> {
    let (mut sequence, mut numbers) = (Sequence::new(), Vec::new());
    for &n in sizes {
        let (errors, number) = of(n)?;
        let h = 1.0 / n as f64;
        sequence.push((h, errors));
        numbers.extend(number.map(|number| (h, number)));
    }
    let curves = of_quantities(&sequence);
    for ((quantity, order), curve) in QUANTITIES.into_iter().zip(ORDERS).zip(&curves) {
        record.order(&format!("{name}: {quantity} in L2"), "h", curve, order);
    }
    record.log_figure(format!("{name}: errors in L2"), "h", named(curves));
    Ok(numbers)
}

/// Measures orders in the time step: of the errors past a moving disk, and of the differences between a step and half
/// of it past one at rest, which are free of the error in space while steps are long enough (see the notes).
fn in_time(record: &mut Record, n: usize) -> Result<(), Failure> {
    const N_AT_REST: usize = 48;
    let steps = |count: i32| (0..count).map(|k| 0.1 * 0.5_f64.powi(k));
    let mut sequence = Sequence::new();
    for dt in steps(4) {
        sequence.push((dt, taylor_green(n, dt)?.0));
    }
    let name = "Taylor-Green past a moving disk";
    let [u, gradient, p] = of_quantities(&sequence);
    record.order(&format!("{name}: u in L2"), "dt", &u, TIME_ORDER);
    record.show_order(&format!("{name}: ∇u in L2"), "dt", &gradient);
    record.show_order(&format!("{name}: p in L2"), "dt", &p);
    record.log_figure(format!("{name}: errors in L2, {n} × {n} squares"), "time step", named([u, gradient, p]));

    let mut sequence = Sequence::new();
    let mut coarser: Option<(f64, State<2>)> = None;
    for dt in steps(5) {
        let (_, setup, state) = taylor_green_past(&euler(), V::zeros(), VISCOSITY, N_AT_REST, dt)?;
        if let Some((dt, coarser)) = &coarser {
            sequence.push((*dt, flow::differences(&setup, coarser, &state)?));
        }
        coarser = Some((dt, state));
    }
    let name = "Taylor-Green past a disk at rest, difference to half of the step";
    let curves = of_quantities(&sequence);
    for (quantity, curve) in QUANTITIES.into_iter().zip(&curves) {
        record.order(&format!("{name}: {quantity} in L2"), "dt", curve, TIME_ORDER);
    }
    record.log_figure(format!("{name}: in L2, {N_AT_REST} × {N_AT_REST} squares"), "time step", named(curves));
    Ok(())
}

/// Time steps and L2 errors of the velocity if uncovered fluid has the exact flow as its history. Measured once, with a
/// modified solver.
const EXACT_CLOSURE: [(f64, f64); 2] = [(0.1, 1.541e-4), (0.05, 1.567e-4)];
/// A viscosity with which the extension of velocities to uncovered fluid shows.
const SMALL_VISCOSITY: f64 = 1e-3;
/// Largest relative difference from this error.
const CLOSURE_ACCURACY: f64 = 0.05;

/// Measures the flow past a disk that crosses several cells in a step. With a small viscosity the error in time is far
/// below that of the mesh, and the extension to uncovered fluid shows.
fn past_uncovered_fluid(record: &mut Record) -> Result<(), Failure> {
    const N: usize = 96;
    let of_second_order = second_order(RHO_INF)?;
    let schemes = [("implicit Euler", &euler()), ("generalised-α", &of_second_order)];
    for ((name, scheme), (dt, exact)) in
        schemes.into_iter().flat_map(|scheme| EXACT_CLOSURE.map(|of_step| (scheme, of_step)))
    {
        let (known, setup, state) = taylor_green_past(scheme, SPEED, SMALL_VISCOSITY, N, dt)?;
        let cells = SPEED.norm() * dt * N as f64;
        let quantity =
            format!("Taylor-Green past a disk that moves {cells:.1} cells per step, viscosity 1e-3, {name}: u in L2");
        record.near_relative(quantity, known.errors(&setup, &state)?.velocity, exact, CLOSURE_ACCURACY);
    }
    Ok(())
}

/// Measures orders in the time step on a flow that the elements contain: all of the error is that of the scheme, and
/// the flow passes a disk that moves through several cells.
fn of_schemes(record: &mut Record) -> Result<(), Failure> {
    const N: usize = 16;
    let schemes: [(&str, Scheme, [f64; 2]); 2] = [
        ("implicit Euler", Arc::new(ImplicitEuler), [TIME_ORDER; 2]),
        ("generalised-α", second_order(RHO_INF)?, SECOND_ORDERS),
    ];
    for (scheme_name, scheme, orders) in schemes {
        let mut sequence = Sequence::new();
        for dt in (0..6).map(|k| 0.1 * 0.5_f64.powi(k)) {
            let flow = Arc::new(Swaying);
            let known = KnownFlow { flow, density: 1.0, viscosity: VISCOSITY, convects: true, open: &["right"] };
            let (setup, state) = past_moving_disk(&known, &scheme, SPEED, N, dt)?;
            sequence.push((dt, known.errors(&setup, &state)?));
        }
        let curves = of_quantities(&sequence);
        let name = format!("swaying linear flow past a moving disk, {scheme_name}");
        for ((quantity, order), curve) in QUANTITIES.into_iter().zip(orders).zip(&curves) {
            record.order(&format!("{name}: {quantity} in L2"), "dt", curve, order);
        }
        record.show_order(&format!("{name}: p in L2"), "dt", &curves[2]);
        record.log_figure(format!("{name}: errors in L2, {N} × {N} squares"), "time step", named(curves));
    }
    Ok(())
}

/// Measures orders in the time step on a curved flow that changes fast. The extension to uncovered fluid is not exact
/// there. Differences between a step and half of it do not contain the error of the mesh, which limits the errors of
/// the gradient.
fn of_curved_flow(record: &mut Record) -> Result<(), Failure> {
    let (n, n_steps) = if record.full { (96, 5) } else { (48, 4) };
    let scheme = second_order(RHO_INF)?;
    let (mut errors, mut differences) = (Sequence::new(), Sequence::new());
    let mut coarser: Option<(f64, State<2>)> = None;
    for dt in (0..n_steps).map(|k| 0.1 * 0.5_f64.powi(k)) {
        let flow = Arc::new(TaylorGreen { viscosity: SMALL_VISCOSITY, pulse: 0.5 });
        let known = KnownFlow { flow, density: 1.0, viscosity: SMALL_VISCOSITY, convects: true, open: &["right"] };
        let (setup, state) = past_moving_disk(&known, &scheme, SPEED, n, dt)?;
        errors.push((dt, known.errors(&setup, &state)?));
        if let Some((dt, coarser)) = &coarser {
            differences.push((*dt, flow::differences(&setup, coarser, &state)?));
        }
        coarser = Some((dt, state));
    }
    let cells = SPEED.norm() * 0.1 * n as f64;
    let name =
        format!("pulsating vortices past a disk that moves {cells:.1} cells in 0.1, viscosity 1e-3, generalised-α");
    let [errors, differences] = [of_quantities(&errors), of_quantities(&differences)];
    for (k, quantity) in QUANTITIES.into_iter().enumerate() {
        let difference = format!("{name}, difference to half of the step: {quantity} in L2");
        match SECOND_ORDERS.get(k) {
            Some(&order) => record.order(&difference, "dt", &differences[k], order),
            None => record.show_order(&difference, "dt", &differences[k]),
        }
        record.show_order(&format!("{name}: {quantity} in L2"), "dt", &errors[k]);
    }
    record.log_figure(format!("{name}: differences to half of the step in L2"), "time step", named(differences));
    Ok(())
}

const QUANTITIES: [&str; 3] = ["u", "∇u", "p"];

/// Returns the errors of each quantity.
fn of_quantities(sequence: &Sequence) -> [Points; 3] {
    let pick = |of: fn(&Errors) -> f64| sequence.iter().map(|(size, e)| (*size, of(e))).collect();
    [pick(|e| e.velocity), pick(|e| e.gradient), pick(|e| e.pressure)]
}

fn named(curves: [Points; 3]) -> Vec<(&'static str, Points)> {
    ["velocity", "its gradient", "pressure"].into_iter().zip(curves).collect()
}

fn square(n: usize) -> Result<SimplexMesh<2>, Failure> {
    Ok(structured_box::<2>([-0.5; 2], [0.5; 2], [n; 2])?)
}

/// Returns the centre of the bodies, which is not near a vertex of any mesh.
fn centre() -> P {
    P::new(0.041_421_356_237_309_5, 0.073_205_080_756_887_7)
}

/// Returns the corners of a disk with edges of length 1/n.
fn hole(centre: P, radius: f64, n: usize) -> Vec<P> {
    disk(centre, radius, (std::f64::consts::TAU * radius * n as f64).round() as usize)
}

fn steady<F: Flow>(known: &KnownFlow<F>, setup: &Setup<2>) -> Result<MeasuredErrors, Failure> {
    let (state, _) = flow::run(setup, 1)?;
    Ok((known.errors(setup, &state)?, None))
}

/// Measures a steady flow past a disk at rest.
fn past_disk<F: Flow>(known: &KnownFlow<F>, n: usize) -> Result<MeasuredErrors, Failure> {
    let mut setup = known.setup(square(n)?, STEADY);
    setup.bodies.push(polygon(&[hole(centre(), 0.2, n)], |x, _| *x, known.velocity()));
    steady(known, &setup)
}

pub(super) struct StokesPolynomial;

impl Flow for StokesPolynomial {
    fn velocity(&self, x: &P, _: f64) -> V {
        let (x, y) = (x[0], x[1]);
        V::new(20.0 * x * y.powi(3), 5.0 * (x.powi(4) - y.powi(4)))
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        let (x, y) = (x[0], x[1]);
        T::new(20.0 * y.powi(3), 60.0 * x * y * y, 20.0 * x.powi(3), -20.0 * y.powi(3))
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        60.0 * x[0] * x[0] * x[1] - 20.0 * x[1].powi(3)
    }
}

fn stokes_polynomial(n: usize) -> Result<MeasuredErrors, Failure> {
    let flow = Arc::new(StokesPolynomial);
    let known = KnownFlow { flow, density: 1.0, viscosity: 1.0, convects: false, open: &["right"] };
    past_disk(&known, n)
}

/// Kovasznay 1948, doi:10.1017/S0305004100023999, at Re = 40.
struct Kovasznay {
    lambda: f64,
}

const REYNOLDS: f64 = 40.0;

impl Flow for Kovasznay {
    fn velocity(&self, x: &P, _: f64) -> V {
        let (e, (s, c)) = ((self.lambda * x[0]).exp(), (2.0 * PI * x[1]).sin_cos());
        V::new(1.0 - e * c, self.lambda / (2.0 * PI) * e * s)
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        let (l, e, (s, c)) = (self.lambda, (self.lambda * x[0]).exp(), (2.0 * PI * x[1]).sin_cos());
        T::new(-l * e * c, 2.0 * PI * e * s, l * l / (2.0 * PI) * e * s, l * e * c)
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        -0.5 * (2.0 * self.lambda * x[0]).exp()
    }
}

fn kovasznay(n: usize) -> Result<MeasuredErrors, Failure> {
    let half = 0.5 * REYNOLDS;
    let flow = Kovasznay { lambda: half - half.hypot(2.0 * PI) };
    let known =
        KnownFlow { flow: Arc::new(flow), density: 1.0, viscosity: 1.0 / REYNOLDS, convects: true, open: &["right"] };
    past_disk(&known, n)
}

/// Flow between cylinders of radii 0.25 and 0.5, of which the inner one turns with speed 1.
pub(super) struct Couette {
    centre: P,
}

impl Couette {
    const A: f64 = -1.0 / 3.0;
    const B: f64 = 1.0 / 12.0;
    /// Moment of the fluid on the inner cylinder, `-4 π μ Ω r1² r2²/(r2² - r1²)`.
    pub(super) const TORQUE: f64 = -PI / 3.0;
}

impl Flow for Couette {
    fn velocity(&self, x: &P, _: f64) -> V {
        let d = x - self.centre;
        V::new(-d[1], d[0]) * (Self::A + Self::B / d.norm_squared())
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        let d = x - self.centre;
        let r2 = d.norm_squared();
        let turn = V::new(-d[1], d[0]);
        T::new(0.0, -1.0, 1.0, 0.0) * (Self::A + Self::B / r2) - turn * d.transpose() * (2.0 * Self::B / (r2 * r2))
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        let r2 = (x - self.centre).norm_squared();
        0.5 * Self::A * Self::A * r2 + Self::A * Self::B * r2.ln() - 0.5 * Self::B * Self::B / r2
    }
}

/// Returns the flow in an annulus and its setup, in a box of squares of size 1/n.
pub(super) fn couette_setup(n: usize, centre: P) -> Result<(KnownFlow<Couette>, Setup<2>), Failure> {
    let known =
        KnownFlow { flow: Arc::new(Couette { centre }), density: 1.0, viscosity: 1.0, convects: true, open: &[] };
    let background = structured_box::<2>([-0.6; 2], [0.7; 2], [13 * n / 10; 2])?;
    let mut setup = known.setup(background, STEADY);
    setup.bodies.push(polygon(&[hole(centre, 0.25, n)], |x, _| *x, known.velocity()));
    setup.bodies.push(polygon(&outside(hole(centre, 0.5, n), P::zeros(), 2.0), |x, _| *x, known.velocity()));
    fluid_mut(&mut setup)?.boundary.clear();
    Ok((known, setup))
}

fn couette(n: usize) -> Result<MeasuredErrors, Failure> {
    let (known, setup) = couette_setup(n, centre())?;
    let (state, report) = flow::run(&setup, 1)?;
    let (_, torque) = flow::force(&state, &report, 0, &centre())?;
    Ok((known.errors(&setup, &state)?, Some((torque / Couette::TORQUE - 1.0).abs())))
}

/// A vortex in a disk of radius 0.4 whose wall is at rest: `u_θ = c (r³ - R² r)`.
struct DiskVortex;

impl DiskVortex {
    const RADIUS: f64 = 0.4;
    const C: f64 = 20.0;
}

impl Flow for DiskVortex {
    fn velocity(&self, x: &P, _: f64) -> V {
        let d = x - centre();
        V::new(-d[1], d[0]) * (Self::C * (d.norm_squared() - Self::RADIUS * Self::RADIUS))
    }
    fn gradient(&self, x: &P, _: f64) -> T {
        let d = x - centre();
        let turn = V::new(-d[1], d[0]);
        let rate = Self::C * (d.norm_squared() - Self::RADIUS * Self::RADIUS);
        T::new(0.0, -1.0, 1.0, 0.0) * rate + turn * d.transpose() * (2.0 * Self::C)
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        let (s, q) = ((x - centre()).norm_squared(), Self::RADIUS * Self::RADIUS);
        Self::C * Self::C * s * (s * s / 6.0 - q * s / 2.0 + q * q / 2.0)
    }
    fn force(&self, x: &P, _: f64) -> V {
        let d = x - centre();
        V::new(d[1], -d[0]) * (8.0 * Self::C)
    }
}

fn disk_vortex(n: usize) -> Result<MeasuredErrors, Failure> {
    let known = KnownFlow { flow: Arc::new(DiskVortex), density: 1.0, viscosity: 1.0, convects: true, open: &[] };
    let mut setup = known.setup(square(n)?, STEADY);
    // Inscribed in the circle it would be smaller than the disk; that of the same area is in error by h² too.
    let wall = outside(hole(centre(), DiskVortex::RADIUS, n), P::zeros(), 2.0);
    setup.bodies.push(polygon(&wall, |x, _| *x, Arc::new(|_, _| V::zeros())));
    fluid_mut(&mut setup)?.boundary.clear();
    steady(&known, &setup)
}

/// Taylor and Green's decaying vortices, with density 1, times `1 + pulse sin 8 t`.
struct TaylorGreen {
    viscosity: f64,
    pulse: f64,
}

impl TaylorGreen {
    fn decay(&self, t: f64) -> f64 {
        (-2.0 * self.viscosity * PI * PI * t).exp()
    }

    fn factor(&self, t: f64) -> f64 {
        self.decay(t) * (1.0 + self.pulse * (8.0 * t).sin())
    }
}

impl Flow for TaylorGreen {
    fn velocity(&self, x: &P, t: f64) -> V {
        let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
        V::new(-cx * sy, sx * cy) * self.factor(t)
    }
    fn gradient(&self, x: &P, t: f64) -> T {
        let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
        T::new(sx * sy, -cx * cy, cx * cy, -sx * sy) * (PI * self.factor(t))
    }
    fn pressure(&self, x: &P, t: f64) -> f64 {
        -0.25 * ((2.0 * PI * x[0]).cos() + (2.0 * PI * x[1]).cos()) * self.factor(t).powi(2)
    }
    fn force(&self, x: &P, t: f64) -> V {
        let rate_over_factor = 8.0 * self.pulse * (8.0 * t).cos() / (1.0 + self.pulse * (8.0 * t).sin());
        self.velocity(x, t) * rate_over_factor
    }
}

// Velocity of the moving disk, and viscosity of the fluid.
const SPEED: V = V::new(-0.4, 0.15);
const VISCOSITY: f64 = 0.1;

fn euler() -> Scheme {
    Arc::new(ImplicitEuler)
}

/// Measures the error at time 0.4, past a disk that moves through several cells.
fn taylor_green(n: usize, dt: f64) -> Result<MeasuredErrors, Failure> {
    let (known, setup, state) = taylor_green_past(&euler(), SPEED, VISCOSITY, n, dt)?;
    Ok((known.errors(&setup, &state)?, None))
}

/// Computes the flow past a disk of any speed to time 0.4.
fn taylor_green_past(
    scheme: &Scheme,
    speed: V,
    viscosity: f64,
    n: usize,
    dt: f64,
) -> Result<(KnownFlow<TaylorGreen>, Setup<2>, State<2>), Failure> {
    let flow = TaylorGreen { viscosity, pulse: 0.0 };
    let known = KnownFlow { flow: Arc::new(flow), density: 1.0, viscosity, convects: true, open: &["right"] };
    let (setup, state) = past_moving_disk(&known, scheme, speed, n, dt)?;
    Ok((known, setup, state))
}

/// Computes a flow past a disk of any speed to time 0.4.
fn past_moving_disk<F: Flow>(
    known: &KnownFlow<F>,
    scheme: &Scheme,
    speed: V,
    n: usize,
    dt: f64,
) -> Result<(Setup<2>, State<2>), Failure> {
    const END: f64 = 0.4;
    let mut setup = Setup { scheme: Arc::clone(scheme), ..known.setup(square(n)?, dt) };
    setup.bodies.push(polygon(&[hole(centre(), 0.2, n)], move |x, t| x + speed * t, known.velocity()));
    let (state, _) = flow::run(&setup, (END / dt).round() as usize)?;
    Ok((setup, state))
}

/// Velocity `a(t) x + b(t)` without pressure, with density 1.
struct Swaying;

impl Swaying {
    /// Returns `a` and `b`, and their rates.
    fn coefficients(t: f64) -> [(T, V); 2] {
        let (turning, straining) = (T::new(0.3, -1.0, 1.0, -0.3), T::new(0.0, 0.7, 0.7, 0.0));
        let ((s, c), (s2, c2)) = ((8.0 * t).sin_cos(), (5.0 * t).sin_cos());
        let value = (turning * c + straining * s2, V::new(0.5 * s, 0.3 * c2));
        let rate = (turning * (-8.0 * s) + straining * (5.0 * c2), V::new(4.0 * c, -1.5 * s2));
        [value, rate]
    }
}

impl Flow for Swaying {
    fn velocity(&self, x: &P, t: f64) -> V {
        let [(a, b), _] = Self::coefficients(t);
        a * x + b
    }
    fn gradient(&self, _: &P, t: f64) -> T {
        Self::coefficients(t)[0].0
    }
    fn pressure(&self, _: &P, _: f64) -> f64 {
        0.0
    }
    fn force(&self, x: &P, t: f64) -> V {
        let [(a, b), (a_rate, b_rate)] = Self::coefficients(t);
        a_rate * x + b_rate + a * (a * x + b)
    }
}
