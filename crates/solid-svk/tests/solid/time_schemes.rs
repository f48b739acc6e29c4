//! Bodies advanced by time schemes: motions that are exact, energy.

use algebra::time::{GeneralisedAlpha, ImplicitEuler, Level, TimeScheme};
use mesh::generate::{BallOptions, ball};
use mesh::{Point, Vector};
use solid_svk::energy::balance;
use solid_svk::{LinearElastic, SolidForm, SolidMesh};

use crate::setting::{advance, ball_material, curved, level, round_disk, unit_body};

fn generalised_alpha(rho_inf: f64) -> GeneralisedAlpha {
    GeneralisedAlpha::new(rho_inf).unwrap()
}

fn translates_and_falls_exactly<const D: usize>(mesh: &SolidMesh<D>) {
    let n = mesh.nodes().len();
    let velocity = Vector::<D>::from_fn(|a, _| 1.0 + a as f64);
    // After n steps of length dt, implicit Euler has fallen by n (n + 1)/2 dt² g.
    let schemes: [(&dyn TimeScheme, f64); 2] = [(&generalised_alpha(0.8), 12.5e-4), (&ImplicitEuler, 15e-4)];
    for (scheme, fallen) in schemes {
        for gravity in [Vector::zeros(), Vector::<D>::repeat(-981.0)] {
            let form = SolidForm::new(2.5, ball_material(), gravity).unwrap();
            let mut now = level(vec![Vector::zeros(); n], vec![velocity; n]);
            for _ in 0..5 {
                now = advance(mesh, &form, scheme, 1e-2, 1e-12, &now);
            }
            let (moved, speed) = (velocity * 0.05 + gravity * fallen, velocity + gravity * 0.05);
            for (d, v) in now.displacement.iter().zip(&now.velocity) {
                assert!((d - moved).norm() < 1e-9 && (v - speed).norm() < 1e-8, "{d} {v}");
            }
        }
    }
}

#[test]
fn translates_and_falls_exactly_in_2d_and_3d() {
    translates_and_falls_exactly(&unit_body::<2>(2));
    translates_and_falls_exactly(&unit_body::<3>(2));
    translates_and_falls_exactly(&curved::<2>(2));
    translates_and_falls_exactly(&curved::<3>(1));
}

#[test]
fn a_linear_body_keeps_its_energy() {
    let mesh = || ball([0.0, 0.0], 4.0, 1.0, &BallOptions::default()).unwrap();
    keeps_its_energy(&SolidMesh::new(mesh()).unwrap(), 0.05);
    // Quadratic elements have higher frequencies, which the scheme dissipates.
    keeps_its_energy(&round_disk(mesh(), 4.0), 0.1);
}

fn keeps_its_energy(mesh: &SolidMesh<2>, most_lost: f64) {
    let material = LinearElastic::new(ball_material().lame);
    let form = SolidForm::new(1.0, material, Vector::zeros()).unwrap();
    let stretched = |x: &Point<2>| Vector::<2>::new(0.1 * x[0], -0.1 * x[1]);
    let start =
        level(mesh.nodes().iter().map(stretched).collect(), vec![Vector::<2>::new(3.0, -20.0); mesh.nodes().len()]);
    let of = |level: &Level<Vector<2>>| balance(mesh, &form, &level.displacement, &level.velocity);
    for (scheme, loss) in [(generalised_alpha(1.0), 0.0), (generalised_alpha(0.5), most_lost)] {
        let mut now = start.clone();
        for _ in 0..20 {
            now = advance(mesh, &form, &scheme, 2e-4, 1e-12, &now);
        }
        let (before, after) = (of(&start), of(&now));
        let lost = 1.0 - after.energy() / before.energy();
        assert!(lost > -1e-10 && lost < loss + 1e-10 && (lost > 1e-6) == (loss > 0.0), "{scheme:?}: {lost:e}");
        assert!((after.momentum - before.momentum).norm() < 1e-10 * before.momentum.norm());
    }
}
