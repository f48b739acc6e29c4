//! An elastic disk that vibrates in a fluid at rest: what it takes along of the fluid lowers its frequencies.

use std::f64::consts::{SQRT_2, TAU};
use std::path::Path;
use std::sync::Arc;

use cutwater::algebra::{LaggedSettings, LaggedSolver, NewtonSettings, Workspace};
use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{BallOptions, ball, structured_box};
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff};
use cutwater::solver::{Body, BodyKind, FluidBoundary, Setup, State, advance};

use super::Failure;
use super::dry::{self, P, V, mapped, second_order};
use super::exact::Linear;
use super::flow::Known;
use super::record::{Figure, Record, short};

/// Disk and fluid of the falling balls: radius, cm; density of both, g/cm^3; Lame parameters, dyn/cm^2; viscosity, P.
const RADIUS: f64 = 4.0;
const DENSITY: f64 = 1.0;
const MU: f64 = 2e6;
const LAMBDA: f64 = 8e6;
const VISCOSITY: f64 = 1e-2;
/// `n` and `ω R/c_s` of the first mode with `n` waves around the disk: roots of the frequency determinant of a disk in plane
/// strain, `ν = 0.4`, on which an unbounded ideal fluid of its density acts with the pressure `-ρ (R/n) ω² u_r`.
const MODES: [(u32, f64); 2] = [(2, 1.67555), (3, 2.65868)];
/// Largest relative error of the frequency of the finest mesh.
const ACCURACY: f64 = 0.03;
/// Half the width of the box, in radii. The sides are open: for a circle of that radius the added mass of mode `n` is smaller by
/// `2 BOX^{-2n}`, and the frequency of `n = 2` higher by 0.04 %.
const BOX: f64 = 6.0;
/// Penalties `γ_Σ` of the mortar: that of the flows that are known, which lets a fluid of so little viscosity slip as an
/// ideal one does, and that of the cases, which makes it stick.
const GAMMAS: [(f64, &str); 2] = [(1e2, "slips"), (1e5, "sticks")];
/// Time steps in a period, and periods that are counted.
const STEPS: f64 = 40.0;
const PERIODS: f64 = 2.5;
/// Largest displacement beside the radius: small enough for linear elasticity.
const STRAIN: f64 = 1e-4;

/// Measures.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.8, 0.4, 0.2] } else { &[0.8, 0.4] };
    let mut curves = Vec::new();
    for (n, exact) in MODES.into_iter().take(if record.full { 2 } else { 1 }) {
        let hertz = hertz(exact);
        for (gamma, name) in GAMMAS {
            let mut curve = Vec::new();
            for &h in sizes {
                let found = hertz * frequency(n, exact, h, STEPS, gamma)?;
                record.show(format!("n = {n}, fluid {name}, h = {h} cm: frequency [Hz]"), found, Some(hertz));
                curve.push((h, found / hertz));
            }
            let finest = curve.last().map_or(f64::NAN, |(_, ratio)| ratio * hertz);
            record.near_relative(format!("n = {n}, fluid {name}: frequency [Hz]"), finest, hertz, ACCURACY);
            curves.push((format!("n = {n}, fluid {name}"), curve));
        }
    }
    if record.full {
        let (n, exact) = MODES[0];
        for steps in [0.5 * STEPS, 2.0 * STEPS, 4.0 * STEPS] {
            let found = hertz(exact) * frequency(n, exact, 0.4, steps, GAMMAS[0].0)?;
            let quantity = format!("n = {n}, fluid slips, h = 0.4 cm, {steps} steps in a period: frequency [Hz]");
            record.show(quantity, found, Some(hertz(exact)));
        }
    }
    record.figures.push(Figure {
        title: "Frequency over that of a disk in ideal fluid".to_owned(),
        x_title: "h [cm]".to_owned(),
        curves,
        is_log: false,
    });
    record.note(format!(
        "{STEPS} steps in a period, {PERIODS} periods from the shape of the mode at rest; generalised-α (rho_inf = 0.8) for \
         the disk, implicit Euler for the fluid. Open box of {} by {} cm; h at the surface of the disk, in both meshes. The \
         finest mesh counts, without extrapolation. The viscous layer is far thinner than the cells, and the penalty of the \
         mortar decides whether the fluid slips along the disk (γ_Σ = {}), as ideal fluid does, or sticks to it ({}): then a \
         layer of the thickness of cells goes along with it.",
        short(2.0 * BOX * RADIUS),
        short(2.0 * BOX * RADIUS),
        short(GAMMAS[0].0),
        short(GAMMAS[1].0),
    ));
    Ok(())
}

/// Frequency from `ω R/c_s`.
fn hertz(omega: f64) -> f64 {
    omega * (MU / DENSITY).sqrt() / RADIUS / TAU
}

/// Frequency of a mode over the exact one.
fn frequency(n: u32, exact: f64, h: f64, steps: f64, gamma: f64) -> Result<f64, Failure> {
    let period = 1.0 / hertz(exact);
    let mut setup = fluid(h, period / steps, gamma)?;
    let mesh = ball::<2>([0.0, 0.0], RADIUS, h, &BallOptions { area_preserving: true })?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(MU, LAMBDA)?);
    let mut body = dry::elastic(mesh, DENSITY, material, V::zeros(), second_order(0.8)?)?;
    let mode = Mode::new(n, exact);
    body.initial_displacement = Some(Arc::new(move |x| mode.at(&(x / RADIUS)) * (STRAIN * RADIUS)));
    let shapes: Vec<V> = body.solid.mesh().vertices().iter().map(|x| mode.at(&(x / RADIUS))).collect();
    setup.bodies.push(Body { name: "disk".to_owned(), kind: BodyKind::Elastic(Box::new(body)) });
    let amplitude =
        |state: &State<2>| -> f64 { state.bodies[0].displacement.iter().zip(&shapes).map(|(d, s)| d.dot(s)).sum() };
    let mut work = Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
    let mut state = State::initial(&setup)?;
    let (mut before, mut crossings) = ((0.0, amplitude(&state)), Vec::new());
    while state.time < (PERIODS + 0.5) * period {
        state = advance(&setup, &state, &mut work)?.0;
        let now = (state.time, amplitude(&state));
        if now.1 * before.1 < 0.0 {
            crossings.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
        }
        before = now;
    }
    let [first, .., last] = crossings[..] else { return Err("the disk does not vibrate".into()) };
    Ok(0.5 * (crossings.len() - 1) as f64 / (last - first) * period)
}

/// The fluid, at rest, in a box with open sides whose cells have size `h` at the disk and grow with the distance.
fn fluid(h: f64, dt: f64, gamma: f64) -> Result<Setup<2>, Failure> {
    let flow = Arc::new(Linear::at_rest(V::zeros()));
    let fluid = Known { flow, density: DENSITY, viscosity: VISCOSITY, convects: true, open: &[] };
    let mut setup = fluid.setup(background(h)?, dt);
    setup.newton = NewtonSettings::new(1e-9);
    setup.gamma_sigma = gamma;
    for (_, condition) in &mut setup.fluid.boundary {
        *condition = FluidBoundary::Open { traction: None, backflow: false };
    }
    Ok(setup)
}

fn background(h: f64) -> Result<SimplexMesh<2>, Failure> {
    // x = R sinh(b s): cells of size b sqrt(R² + x²)/n.
    let b = BOX.asinh();
    let n = (SQRT_2 * b * RADIUS / h).ceil() as usize;
    let even = structured_box::<2>([-1.0; 2], [1.0; 2], [2 * n; 2])?;
    mapped(&even, |s| P::new(RADIUS * (b * s[0]).sinh(), RADIUS * (b * s[1]).sinh()))
}

/// A mode of the disk of radius one, `∇φ + curl ψ` with `φ = J_n(κ ω r) cos nθ`, `ψ = B J_n(ω r) sin nθ` and no shear stress
/// on the surface.
#[derive(Clone, Copy)]
struct Mode {
    n: u32,
    /// Wave numbers of φ and ψ.
    waves: [f64; 2],
    /// B.
    shear: f64,
    /// Largest displacement on the surface.
    scale: f64,
}

impl Mode {
    fn new(n: u32, omega: f64) -> Self {
        let kappa = (MU / (LAMBDA + 2.0 * MU)).sqrt();
        let waves = [kappa * omega, omega];
        let ([phi, d_phi], [psi, d_psi]) = (radial(n, waves[0], 1.0), radial(n, waves[1], 1.0));
        let nn = f64::from(n);
        // Bessel's equation at r = 1.
        let dd_psi = -d_psi - (omega * omega - nn * nn) * psi;
        let shear = 2.0 * nn * (d_phi - phi) / (d_psi - dd_psi - nn * nn * psi);
        Self { n, waves, shear, scale: d_phi + nn * shear * psi }
    }

    /// Displacement, at most about one.
    fn at(&self, x: &P) -> V {
        let n = f64::from(self.n);
        // The limit at the centre is as good as the value near it.
        let (r, angle) = (x.norm().max(1e-9), x[1].atan2(x[0]));
        let ([phi, d_phi], [psi, d_psi]) = (radial(self.n, self.waves[0], r), radial(self.n, self.waves[1], r));
        let outward = (d_phi + n * self.shear * psi / r) * (n * angle).cos() / self.scale;
        let along = -(n * phi / r + self.shear * d_psi) * (n * angle).sin() / self.scale;
        V::new(angle.cos(), angle.sin()) * outward + V::new(-angle.sin(), angle.cos()) * along
    }
}

/// `J_n(k r)` and its derivative in r, by their series; for arguments of a few units.
fn radial(n: u32, k: f64, r: f64) -> [f64; 2] {
    let half = 0.5 * k * r;
    let mut term = (1..=n).fold(1.0, |product, i| product * half / f64::from(i));
    let mut sum = [0.0; 2];
    for i in 0..30 {
        sum[0] += term;
        sum[1] += term * f64::from(n + 2 * i) / r;
        term *= -half * half / f64::from((i + 1) * (n + i + 1));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_are_those_of_tables() {
        // J_2(2), J_3(5), and J_2' = J_1 - 2 J_2/x at 2, times the wave number.
        let (j1, j2) = (0.576_724_807_756_873_4, 0.352_834_028_615_637_7);
        assert!((radial(2, 2.0, 1.0)[0] - j2).abs() < 1e-14);
        assert!((radial(3, 5.0, 1.0)[0] - 0.364_831_230_613_667).abs() < 1e-13);
        assert!((radial(2, 2.0, 1.0)[1] - 2.0 * (j1 - j2)).abs() < 1e-14);
    }

    /// The frequencies are those at which the stress on the surface is the pressure of the fluid.
    #[test]
    fn modes_balance_the_pressure_of_the_fluid() {
        for (n, omega) in MODES {
            let mode = Mode::new(n, omega);
            let (e, angle) = (1e-4, 0.2);
            let x = P::new(f64::cos(angle), f64::sin(angle));
            let column = |d: V| (mode.at(&(x + d * e)) - mode.at(&(x - d * e))) / (2.0 * e);
            let (dx, dy) = (column(V::new(1.0, 0.0)), column(V::new(0.0, 1.0)));
            let (lambda, shear) = (LAMBDA / MU * (dx[0] + dy[1]), dx[1] + dy[0]);
            let traction =
                V::new((lambda + 2.0 * dx[0]) * x[0] + shear * x[1], shear * x[0] + (lambda + 2.0 * dy[1]) * x[1]);
            // In units of μ, with ρ = R = c_s = 1.
            let expected = x * (omega * omega / f64::from(n) * mode.at(&x).dot(&x));
            assert!((traction - expected).norm() < 1e-3 * expected.norm(), "n = {n}: {traction} {expected}");
        }
    }
}
