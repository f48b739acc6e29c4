//! Modes of an elastic disk in plane strain, and the frequency of one of them in a computed motion.

use std::f64::consts::TAU;
use std::sync::Arc;

use cutwater::mesh::generate::{BallOptions, ball};
use cutwater::solid_svk::{SaintVenantKirchhoff, SolidMesh};

use super::dry::{Elastic, LAMBDA, LAME, MU, RADIUS, Scheme, elastic};
use super::signal::passage;
use super::{DirectRun, Failure, P, V};

/// Density of the disk, g/cm³.
const DENSITY: f64 = 1.0;
/// Largest displacement relative to the radius: small enough for linear elasticity.
const STRAIN: f64 = 1e-4;

/// A mode of the disk, `∇φ + curl ψ` with `φ = J_n(κ ω r) cos nθ`, `ψ = B J_n(ω r) sin nθ` and no shear stress
/// on the surface, in units of its radius and of `R/c_s`.
#[derive(Clone, Copy)]
pub(super) struct Mode {
    n: u32,
    /// Wave numbers of φ and ψ.
    waves: [f64; 2],
    /// B.
    shear: f64,
    /// Largest displacement on the surface.
    scale: f64,
}

impl Mode {
    /// Creates the mode with `n` waves around the disk and the frequency `ω R/c_s`.
    pub(super) fn new(n: u32, omega: f64) -> Self {
        let kappa = (MU / (LAMBDA + 2.0 * MU)).sqrt();
        let waves = [kappa * omega, omega];
        let ([phi, d_phi], [psi, d_psi]) = (radial(n, waves[0], 1.0), radial(n, waves[1], 1.0));
        let nn = f64::from(n);
        // Bessel's equation at r = 1.
        let dd_psi = -d_psi - (omega * omega - nn * nn) * psi;
        let shear = 2.0 * nn * (d_phi - phi) / (d_psi - dd_psi - nn * nn * psi);
        Self { n, waves, shear, scale: d_phi + nn * shear * psi }
    }

    /// Returns the frequency of the mode, Hz.
    pub(super) fn hertz(&self) -> f64 {
        self.waves[1] * (MU / DENSITY).sqrt() / RADIUS / TAU
    }

    /// Returns the displacement at a point of the disk relative to that of the surface, at most about one.
    fn at(&self, x: &P) -> V {
        let x = x / RADIUS;
        let n = f64::from(self.n);
        // At the centre, the value next to it replaces the limit.
        let (r, angle) = (x.norm().max(1e-9), x[1].atan2(x[0]));
        let ([phi, d_phi], [psi, d_psi]) = (radial(self.n, self.waves[0], r), radial(self.n, self.waves[1], r));
        let outward = (d_phi + n * self.shear * psi / r) * (n * angle).cos() / self.scale;
        let along = -(n * phi / r + self.shear * d_psi) * (n * angle).sin() / self.scale;
        V::new(angle.cos(), angle.sin()) * outward + V::new(-angle.sin(), angle.cos()) * along
    }

    /// Returns the disk with cells of a size, in the shape of the mode. (A shape that is only close to it contains
    /// other modes with as many waves around the disk, which shift the zero crossings.)
    pub(super) fn disk(&self, size: f64, scheme: Scheme) -> Result<Elastic<2>, Failure> {
        let mesh = ball::<2>([0.0, 0.0], RADIUS, size, &BallOptions { area_preserving: true })?;
        let mut body = elastic(mesh, DENSITY, SaintVenantKirchhoff::new(LAME), V::zeros(), scheme)?;
        let mode = *self;
        body.options.initial_displacement = Some(Arc::new(move |x| mode.at(x) * (STRAIN * RADIUS)));
        Ok(body)
    }

    /// Returns the projection of displacements of a disk on the mode. Other modes are orthogonal to it, with the mass
    /// of the vertices.
    pub(super) fn projection(&self, solid: &SolidMesh<2>) -> impl Fn(&[V]) -> f64 + use<> {
        let mut weights: Vec<V> = solid.nodes().iter().map(|x| self.at(x)).collect();
        let mut mass = vec![0.0; weights.len()];
        for cell in solid.mesh().cells() {
            solid.cell(cell).iter().for_each(|v| mass[v.index()] += solid.volume(cell));
        }
        weights.iter_mut().zip(&mass).for_each(|(weight, mass)| *weight *= *mass);
        move |displacement| displacement.iter().zip(&weights).map(|(d, w)| d.dot(w)).sum()
    }
}

/// Computes the frequency of the oscillation of the first body until a time, Hz. `amplitude` maps its displacements to
/// a number.
pub(super) fn frequency_of(mut run: DirectRun, end: f64, amplitude: impl Fn(&[V]) -> f64) -> Result<f64, Failure> {
    let mut samples = Vec::new();
    while run.state.time < end {
        run.advance()?;
        samples.push((run.state.time, amplitude(run.state.bodies[0].displacement())));
    }
    frequency(&samples)
}

/// Returns the frequency of a sampled oscillation around zero, by linear regression of the times of its zero crossings.
///
/// # Errors
/// It passes zero less than three times.
fn frequency(samples: &[(f64, f64)]) -> Result<f64, Failure> {
    let passages = samples.windows(2).filter(|w| w[0].1 * w[1].1 < 0.0);
    let times: Vec<f64> = passages.map(|w| passage([w[0], w[1]], 0.0)).collect();
    if times.len() < 3 {
        return Err("the disk does not vibrate".into());
    }
    let middle = 0.5 * (times.len() - 1) as f64;
    let (mut slope, mut squares) = (0.0, 0.0);
    for (k, time) in times.iter().enumerate() {
        slope += (k as f64 - middle) * time;
        squares += (k as f64 - middle).powi(2);
    }
    Ok(0.5 * squares / slope)
}

/// Returns `J_n(k r)` and its derivative in r, by their series; for arguments of a few units.
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

    /// Radial stress on the surface: none for a free disk, the pressure `-(ρ/n) ω² u_r` of a fluid of its density.
    #[test]
    fn modes_balance_what_acts_on_the_surface() {
        let modes = [(2, 2.35106, 0.0), (3, 3.63191, 0.0), (2, 1.67555, 1.0), (3, 2.65868, 1.0)];
        for (n, omega, fluid) in modes {
            let mode = Mode::new(n, omega);
            let (e, angle) = (1e-4, 0.2);
            let x = P::new(f64::cos(angle), f64::sin(angle));
            let column = |d: V| (mode.at(&((x + d * e) * RADIUS)) - mode.at(&((x - d * e) * RADIUS))) / (2.0 * e);
            let (dx, dy) = (column(V::new(1.0, 0.0)), column(V::new(0.0, 1.0)));
            let (lambda, shear) = (LAMBDA / MU * (dx[0] + dy[1]), dx[1] + dy[0]);
            let traction =
                V::new((lambda + 2.0 * dx[0]) * x[0] + shear * x[1], shear * x[0] + (lambda + 2.0 * dy[1]) * x[1]);
            // In units of μ, with ρ = R = c_s = 1.
            let unit = omega * omega / f64::from(n) * mode.at(&(x * RADIUS)).dot(&x);
            assert!((traction - x * (unit * fluid)).norm() < 1e-3 * unit.abs(), "n = {n}: {traction} {unit}");
        }
    }

    #[test]
    fn a_sine_has_its_frequency() {
        let samples: Vec<_> = (0..400).map(|k| 0.01 * f64::from(k)).map(|t| (t, (TAU * 3.0 * t + 0.3).cos())).collect();
        assert!((frequency(&samples).unwrap() - 3.0).abs() < 1e-3);
        assert!(frequency(&samples[..20]).is_err());
    }
}
