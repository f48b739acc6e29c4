//! A free elastic disk that vibrates in its own modes.

use std::path::Path;
use std::sync::Arc;

use cutwater::mesh::generate::{BallOptions, ball};
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff, TimeScheme};

use super::Failure;
use super::dry::{P, Run, V, elastic, second_order};
use super::record::Record;

/// The disk of the falling balls: radius, cm; density, g/cm^3; Lame parameters, dyn/cm^2.
const RADIUS: f64 = 4.0;
const DENSITY: f64 = 1.0;
const MU: f64 = 2e6;
const LAMBDA: f64 = 8e6;
/// `n` and `ω R/c_s` of the first mode with `n` waves around the disk: roots of the frequency determinant of a free disk in plane
/// strain with `ν = 0.4`.
const MODES: [(u32, f64); 2] = [(2, 2.35106), (3, 3.63191)];
/// Time steps in a period, and periods that are counted.
const STEPS: f64 = 60.0;
const PERIODS: f64 = 10.0;
/// Largest displacement beside the radius: small enough for linear elasticity.
const STRAIN: f64 = 1e-4;

/// Frequency of a mode beside the exact one.
fn frequency(n: u32, exact: f64, size: f64, scheme: TimeScheme) -> Result<f64, Failure> {
    let omega = exact * (MU / DENSITY).sqrt() / RADIUS;
    let period = std::f64::consts::TAU / omega;
    let mesh = ball::<2>([0.0, 0.0], RADIUS, size, &BallOptions { area_preserving: true })?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(MU, LAMBDA)?);
    let mut body = elastic(mesh, DENSITY, material, V::zeros(), scheme)?;
    // The gradient of Re z^n: close to the mode, and orthogonal to those with other n.
    let shape = move |x: &P| {
        let (r, angle) = (x.norm() / RADIUS, f64::from(n - 1) * x[1].atan2(x[0]));
        V::new(angle.cos(), -angle.sin()) * r.powi(n as i32 - 1)
    };
    body.initial_displacement = Some(Arc::new(move |x| shape(x) * (STRAIN * RADIUS)));
    let shapes: Vec<V> = body.solid.mesh().vertices().iter().map(shape).collect();
    let mut run = Run::new(vec![body], Vec::new(), period / STEPS, 1e-9);
    let amplitude =
        |run: &Run| -> f64 { run.state.bodies[0].displacement.iter().zip(&shapes).map(|(d, s)| d.dot(s)).sum() };
    let (mut before, mut crossings) = ((0.0, amplitude(&run)), Vec::new());
    while run.state.time < (PERIODS + 1.0) * period {
        run.advance()?;
        let now = (run.state.time, amplitude(&run));
        if now.1 * before.1 < 0.0 {
            crossings.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
        }
        before = now;
    }
    let [first, .., last] = crossings[..] else { return Err("the disk does not vibrate".into()) };
    Ok(0.5 * (crossings.len() - 1) as f64 / (last - first) * period)
}

/// Measures.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.8, 0.4, 0.2] } else { &[0.8, 0.4] };
    let scheme = second_order(0.8)?;
    for (n, exact) in MODES {
        let hertz = exact * (MU / DENSITY).sqrt() / RADIUS / std::f64::consts::TAU;
        let mut found = f64::NAN;
        for &size in sizes {
            found = hertz * frequency(n, exact, size, scheme)?;
            record.show(format!("n = {n}, size {size}: frequency [Hz]"), found, Some(hertz));
        }
        record.near_relative(format!("n = {n}: frequency [Hz]"), found, hertz, 0.01);
    }
    record.note(format!(
        "{STEPS} steps of generalised-α (rho_inf = 0.8) in a period, {PERIODS} periods; the finest mesh counts."
    ));
    Ok(())
}
