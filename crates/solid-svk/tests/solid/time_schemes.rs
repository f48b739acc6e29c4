//! Time schemes: order, damping, energy, motions that are exact.

use algebra::Contributions;
use mesh::generate::{BallOptions, ball};
use mesh::{Point, Vector};
use solid_svk::energy::BodyBalance;
use solid_svk::{
    Error, GeneralisedAlpha, LameParameters, LinearElastic, SolidCells, SolidForm, SolidMesh, StepRule, TimeScheme,
};

use crate::setting::{Problem, Random, one_field, unit_box, weightless};

fn generalised_alpha(rho_inf: f64) -> TimeScheme {
    TimeScheme::GeneralisedAlpha(GeneralisedAlpha::new(rho_inf).unwrap())
}

/// Displacement, velocity and acceleration.
#[derive(Clone)]
struct State<const D: usize> {
    d: Vec<Vector<D>>,
    v: Vec<Vector<D>>,
    a: Option<Vec<Vector<D>>>,
}

impl<const D: usize> State<D> {
    fn new(d: Vec<Vector<D>>, v: Vec<Vector<D>>) -> Self {
        Self { d, v, a: None }
    }

    fn rule(&self, scheme: TimeScheme, dt: f64) -> StepRule<D> {
        scheme.step(dt, &self.d, &self.v, self.a.as_deref()).unwrap()
    }

    fn after(rule: &StepRule<D>, v: Vec<Vector<D>>) -> Self {
        let end = rule.end();
        Self { d: end.displacement.values(&v).unwrap(), a: Some(end.acceleration.values(&v).unwrap()), v }
    }
}

/// One step of `a + ω² d = 0`.
fn oscillate(scheme: TimeScheme, omega: f64, dt: f64, state: &State<2>) -> State<2> {
    let rule = state.rule(scheme, dt);
    let [d, a] = [&rule.stage().displacement, &rule.stage().acceleration];
    let v = -(a.predicted()[0] + omega.powi(2) * d.predicted()[0]) / (a.slope() + omega.powi(2) * d.slope());
    State::after(&rule, vec![v])
}

/// Error of displacement and velocity after a time that is no multiple of a period.
fn oscillator_error(scheme: TimeScheme, n_steps: u32) -> f64 {
    let (omega, time) = (3.0_f64, 2.0);
    let mut state = State::new(vec![Vector::<2>::new(1.0, 0.0)], vec![Vector::<2>::new(0.0, omega)]);
    for _ in 0..n_steps {
        state = oscillate(scheme, omega, time / f64::from(n_steps), &state);
    }
    let (s, c) = (omega * time).sin_cos();
    (state.d[0] - Vector::<2>::new(c, s)).norm() + (state.v[0] - Vector::<2>::new(-s, c) * omega).norm() / omega
}

#[test]
fn orders_on_an_oscillator() {
    let order = |scheme| (oscillator_error(scheme, 200) / oscillator_error(scheme, 400)).log2();
    let euler = order(TimeScheme::ImplicitEuler);
    assert!((euler - 1.0).abs() < 0.1, "{euler}");
    for rho_inf in [0.0, 0.5, 0.8, 1.0] {
        let order = order(generalised_alpha(rho_inf));
        assert!((order - 2.0).abs() < 0.05, "{rho_inf}: {order}");
    }
}

#[test]
fn fast_vibrations_are_damped_by_the_spectral_radius() {
    for rho_inf in [0.3, 0.8, 1.0] {
        let mut state = State::new(vec![Vector::<2>::new(1.0, 0.3)], vec![Vector::<2>::new(0.2, -0.5)]);
        let mut sizes = Vec::new();
        for _ in 0..100 {
            state = oscillate(generalised_alpha(rho_inf), 1e6, 1.0, &state);
            sizes.push(state.d[0].norm());
        }
        // A double root adds a factor that is linear in the number of steps.
        let radius = (sizes[99] / sizes[49]).powf(1.0 / 50.0);
        assert!((radius - rho_inf).abs() < 0.03 * rho_inf, "{rho_inf}: {radius}");
    }
}

#[test]
fn nothing_is_damped_where_nothing_shall_be() {
    let omega = 5.0;
    let energy = |s: &State<2>| s.v[0].norm_squared() + omega * omega * s.d[0].norm_squared();
    let start = State::new(vec![Vector::<2>::new(1.0, 0.3)], vec![Vector::<2>::new(0.2, -0.5)]);
    let after = |scheme| (0..100).fold(start.clone(), |state, _| oscillate(scheme, omega, 0.1, &state));
    assert!((energy(&after(generalised_alpha(1.0))) / energy(&start) - 1.0).abs() < 1e-12);
    let (damped, euler) = (energy(&after(generalised_alpha(0.8))), energy(&after(TimeScheme::ImplicitEuler)));
    assert!(
        euler < 1e-3 * energy(&start) && damped > 0.8 * energy(&start) && damped < energy(&start),
        "{damped} {euler}"
    );
}

/// One step of a body without supports.
fn advance<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    scheme: TimeScheme,
    dt: f64,
    state: &State<D>,
) -> State<D> {
    let (layout, field) = one_field(mesh);
    let rule = state.rule(scheme, dt);
    let cells = SolidCells::new(mesh, form, &rule, &layout, field).unwrap();
    let (linear, work) = (cells.linear(), cells.internal_work());
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &state.v, &mut x).unwrap();
    let contributions: Vec<&dyn Contributions> = vec![&linear, &work];
    let idle = (0..5).map(|k| (algebra::DofId(k), 0.0));
    Problem::new(&layout, contributions, idle).solve(&mut x, 1e-12);
    State::after(&rule, mesh.velocity(&layout, field, &x).unwrap())
}

fn translates_and_falls_exactly<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let n = mesh.mesh().n_vertices();
    let mut form = weightless();
    let velocity = Vector::<D>::from_fn(|a, _| 1.0 + a as f64);
    for gravity in [Vector::zeros(), Vector::<D>::repeat(-7.0)] {
        form.body_force.acceleration = gravity;
        let mut state = State::new(vec![Vector::zeros(); n], vec![velocity; n]);
        for _ in 0..5 {
            state = advance(&mesh, &form, generalised_alpha(0.8), 1e-2, &state);
        }
        let (moved, speed) = (velocity * 0.05 + gravity * (0.5 * 0.05_f64.powi(2)), velocity + gravity * 0.05);
        for (d, v) in state.d.iter().zip(&state.v) {
            assert!((d - moved).norm() < 1e-10 && (v - speed).norm() < 1e-9, "{d} {v}");
        }
    }
}

#[test]
fn translates_and_falls_exactly_in_2d() {
    translates_and_falls_exactly::<2>();
}

#[test]
fn translates_and_falls_exactly_in_3d() {
    translates_and_falls_exactly::<3>();
}

#[test]
fn a_linear_body_keeps_its_energy() {
    let mesh = SolidMesh::<2>::new(ball([0.0, 0.0], 4.0, 1.0, &BallOptions::default()).unwrap()).unwrap();
    let material = LinearElastic::new(LameParameters::new(2e6, 8e6).unwrap());
    let form = SolidForm::new(1.0, material, Vector::zeros()).unwrap();
    let stretched = |x: &Point<2>| Vector::<2>::new(0.1 * x[0], -0.1 * x[1]);
    let start = State::new(
        mesh.mesh().vertices().iter().map(stretched).collect(),
        vec![Vector::<2>::new(3.0, -20.0); mesh.mesh().n_vertices()],
    );
    let balance = |state: &State<2>| BodyBalance::new(&mesh, &form, &state.d, &state.v);
    for (scheme, loss) in [(generalised_alpha(1.0), 0.0), (generalised_alpha(0.5), 0.05)] {
        let mut state = start.clone();
        for _ in 0..20 {
            state = advance(&mesh, &form, scheme, 2e-4, &state);
        }
        let (before, after) = (balance(&start), balance(&state));
        let lost = 1.0 - after.energy() / before.energy();
        assert!(lost > -1e-10 && lost < loss + 1e-10 && (lost > 1e-6) == (loss > 0.0), "{scheme:?}: {lost:e}");
        assert!((after.momentum - before.momentum).norm() < 1e-10 * before.momentum.norm());
    }
}

#[test]
fn implicit_euler_is_what_it_was() {
    let mut random = Random::new(3);
    let (d, v, now) = (random.vectors::<3>(4, 1.0), random.vectors::<3>(4, 9.0), random.vectors::<3>(4, 9.0));
    let dt = 1.3e-3;
    let rule = TimeScheme::default().step(dt, &d, &v, Some(&now)).unwrap();
    for k in 0..4 {
        assert_eq!(rule.stage().displacement.at(k, &now[k]), d[k] + dt * now[k]);
        assert_eq!(rule.stage().acceleration.at(k, &now[k]), (1.0 / dt) * now[k] - v[k] / dt);
        assert_eq!(rule.velocity_to_reach(k, &now[k]), (now[k] - d[k]) / dt);
    }
    assert_eq!(rule.stage(), rule.end());
}

#[test]
fn parameters_out_of_range_are_refused() {
    for rho_inf in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(GeneralisedAlpha::new(rho_inf), Err(Error::Parameter { .. })));
    }
    let rest = vec![Vector::<2>::zeros(); 3];
    let scheme = generalised_alpha(0.5);
    assert!(matches!(scheme.step(0.0, &rest, &rest, None), Err(Error::Parameter { .. })));
    assert!(matches!(scheme.step(0.1, &rest, &rest[1..], None), Err(Error::Length { .. })));
    assert!(matches!(scheme.step(0.1, &rest, &rest, Some(&rest[1..])), Err(Error::Length { .. })));
}
