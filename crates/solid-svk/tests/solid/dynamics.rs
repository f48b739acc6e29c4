//! Balances in time: energy, momentum, rigid motion, free fall.

use crate::setting::{Problem, Random, ball_material, one_field, residual, unit_box, weightless};
use algebra::Contributions;
use mesh::generate::{BallOptions, ball};
use mesh::{Point, Vector};
use solid_svk::energy::BodyBalance;
use solid_svk::{Error, SolidCells, SolidForm, SolidMesh, StepRule};

/// Displacement and velocity of all vertices.
type State<const D: usize> = (Vec<Vector<D>>, Vec<Vector<D>>);

fn advance<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    dt: f64,
    tolerance: f64,
    state: &State<D>,
) -> State<D> {
    let (layout, field) = one_field(mesh);
    let step = StepRule::implicit_euler(dt, &state.0, &state.1).unwrap();
    let cells = SolidCells::new(mesh, form, &step, &layout, field).unwrap();
    let (linear, work) = (cells.linear(), cells.internal_work());
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &state.1, &mut x).unwrap();
    let contributions: Vec<&dyn Contributions> = vec![&linear, &work];
    let idle = (0..5).map(|k| (algebra::DofId(k), 0.0));
    Problem::new(&layout, contributions, idle).solve(&mut x, tolerance);
    let velocity = mesh.velocity(&layout, field, &x).unwrap();
    (step.end().displacement.values(&velocity).unwrap(), velocity)
}

#[test]
fn free_vibration_loses_energy_and_keeps_momentum() {
    let mesh = SolidMesh::<2>::new(ball([0.0, 0.0], 4.0, 1.0, &BallOptions::default()).unwrap()).unwrap();
    let form = weightless();
    let n = mesh.mesh().n_vertices();
    let stretched: Vec<_> = mesh.mesh().vertices().iter().map(|x| Vector::<2>::new(0.1 * x[0], -0.1 * x[1])).collect();
    let mut state = (stretched, vec![Vector::<2>::new(3.0, -20.0); n]);
    let mut before = BodyBalance::new(&mesh, &form, &state.0, &state.1);
    let momentum = before.momentum;
    let start = before.energy();
    for _ in 0..20 {
        state = advance(&mesh, &form, 1e-4, 1e-12, &state);
        let now = BodyBalance::new(&mesh, &form, &state.0, &state.1);
        assert!(now.energy() < before.energy() && now.smallest_volume_ratio > 0.8);
        assert!((now.momentum - momentum).norm() < 1e-11 * momentum.norm(), "{}", now.momentum - momentum);
        let moved = now.centre_of_mass - before.centre_of_mass;
        assert!((moved - momentum / now.mass * 1e-4).norm() < 1e-12);
        before = now;
    }
    assert!(before.energy() > 0.3 * start);
}

fn falls_freely<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let mut gravity = Vector::<D>::zeros();
    gravity[D - 1] = -981.0;
    let form = SolidForm::new(2.5, ball_material(), gravity).unwrap();
    let n = mesh.mesh().n_vertices();
    let mut state = (vec![Vector::zeros(); n], vec![Vector::zeros(); n]);
    for _ in 0..5 {
        state = advance(&mesh, &form, 1e-2, 1e-12, &state);
    }
    // Implicit Euler: v = n dt g, d = n (n + 1)/2 dt² g.
    for (d, v) in state.0.iter().zip(&state.1) {
        assert!((v - gravity * 0.05).norm() < 1e-8 && (d - gravity * 15e-4).norm() < 1e-9);
    }
}

#[test]
fn falls_freely_in_2d() {
    falls_freely::<2>();
}

#[test]
fn falls_freely_in_3d() {
    falls_freely::<3>();
}

#[test]
fn balances_of_a_turning_and_rising_square() {
    let mesh = unit_box::<2>(4);
    let form = SolidForm::new(3.0, ball_material(), Vector::<2>::new(0.0, -10.0)).unwrap();
    let centre = Point::<2>::new(0.5, 0.5);
    let velocity: Vec<_> = mesh
        .mesh()
        .vertices()
        .iter()
        .map(|x| Vector::<2>::new(-(x[1] - centre[1]), x[0] - centre[0]) * 2.0 + Vector::<2>::new(0.0, 7.0))
        .collect();
    let displacement = vec![Vector::<2>::new(1.0, 2.0); velocity.len()];
    let balance = BodyBalance::new(&mesh, &form, &displacement, &velocity);
    // Moment of inertia m/6, so 1/2 (m/6) 2² + 1/2 m 7².
    assert!((balance.kinetic_energy - (3.0 / 3.0 + 1.5 * 49.0)).abs() < 1e-12);
    assert!((balance.momentum - Vector::<2>::new(0.0, 21.0)).norm() < 1e-12);
    assert!((balance.centre_of_mass - Point::<2>::new(1.5, 2.5)).norm() < 1e-13);
    assert!((balance.potential_energy - 3.0 * 10.0 * 2.5).abs() < 1e-11);
    assert!((balance.volume - 1.0).abs() < 1e-13 && (balance.mass - 3.0).abs() < 1e-12);
    assert!(balance.elastic_energy.abs() < 1e-20);
}

#[test]
fn kinetic_energy_is_that_of_the_mass_matrix() {
    let mesh = unit_box::<3>(2);
    let form = weightless();
    let (layout, field) = one_field(&mesh);
    let n = mesh.mesh().n_vertices();
    let rest = vec![Vector::<3>::zeros(); n];
    let velocity = Random::new(5).vectors::<3>(n, 10.0);
    let step = StepRule::implicit_euler(0.5, &rest, &rest).unwrap();
    let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &velocity, &mut x).unwrap();
    // The residual is M v/dt.
    let power: f64 = residual(&[&cells.linear()], &x).iter().zip(&x).map(|(r, v)| r * v).sum();
    let balance = BodyBalance::new(&mesh, &form, &rest, &velocity);
    assert!((0.5 * 0.5 * power - balance.kinetic_energy).abs() < 1e-12 * balance.kinetic_energy);
}

#[test]
fn nonsense_is_refused() {
    let mesh = unit_box::<2>(1);
    let rest = vec![Vector::<2>::zeros(); 4];
    assert!(matches!(StepRule::implicit_euler(0.0, &rest, &rest), Err(Error::Parameter { .. })));
    assert!(matches!(StepRule::implicit_euler(0.1, &rest, &rest[1..]), Err(Error::Length { .. })));
    assert!(SolidForm::new(-1.0, ball_material(), Vector::<2>::zeros()).is_err());
    let short = StepRule::implicit_euler(0.1, &rest[1..], &rest[1..]).unwrap();
    let (layout, field) = one_field(&mesh);
    let form = weightless();
    assert!(SolidCells::new(&mesh, &form, &short, &layout, field).is_err());
    assert!(solid_svk::boundary::tagged_facets(&mesh, "nowhere").is_err());
}

/// The ovalisation of the paper's ball in vacuum: ω r/c_s = 2.35106 for ν = 0.4 (root of the frequency determinant of a
/// free disk in plane strain), which is 132.29 Hz.
#[test]
fn disk_oscillates_with_its_own_frequency() {
    let options = BallOptions { area_preserving: true };
    let mesh = SolidMesh::<2>::new(ball([0.0, 0.0], 4.0, 0.6, &options).unwrap()).unwrap();
    let form = weightless();
    let n = mesh.mesh().n_vertices();
    let oval = |x: &Point<2>| Vector::<2>::new(x[0], -x[1]) * 1e-3;
    let mut state = (mesh.mesh().vertices().iter().map(oval).collect(), vec![Vector::<2>::zeros(); n]);
    // Implicit Euler damps the higher modes that the start contains as well; the last period is nearly pure.
    let dt = 8e-5;
    // Second moments tell width from height; their difference oscillates.
    let ovalisation = |state: &State<2>| -> f64 {
        mesh.mesh().vertices().iter().zip(&state.0).map(|(x, d)| x[0] * d[0] - x[1] * d[1]).sum()
    };
    let (mut before, mut crossings) = (ovalisation(&state), Vec::new());
    for k in 1..=450 {
        state = advance(&mesh, &form, dt, 1e-9, &state);
        let now = ovalisation(&state);
        if now * before < 0.0 {
            crossings.push(dt * (f64::from(k) - now / (now - before)));
        }
        before = now;
    }
    let [.., first, _, last] = crossings[..] else { panic!("{crossings:?}") };
    let frequency = 1.0 / (last - first);
    assert!((frequency - 132.29).abs() < 0.01 * 132.29, "{frequency}");
}
