//! Time schemes on an oscillator: order, damping, energy; rules against their formulas.

use algebra::time::{GeneralisedAlpha, ImplicitEuler, Level, QuasiStatic, StepRule, TimeScheme};

fn generalised_alpha(rho_inf: f64) -> GeneralisedAlpha {
    GeneralisedAlpha::new(rho_inf).expect("a radius from 0 to 1")
}

/// Returns a level without acceleration; each node is an oscillator.
fn start(displacement: [f64; 2], velocity: [f64; 2]) -> Level<f64> {
    Level { displacement: displacement.to_vec(), velocity: velocity.to_vec(), acceleration: Vec::new() }
}

/// Advances oscillators `a + ω² d = 0` by one step.
fn oscillate(scheme: &dyn TimeScheme, omega: f64, dt: f64, level: Level<f64>) -> Level<f64> {
    let rule = StepRule::new(scheme, &[dt], &[level]);
    let [d, a] = [&rule.stage.displacement, &rule.stage.acceleration];
    let slope = a.slope + omega.powi(2) * d.slope;
    let velocity = (0..2).map(|k| -(a.at(k, 0.0) + omega.powi(2) * d.at(k, 0.0)) / slope);
    rule.level(velocity.collect())
}

fn squared_norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Computes the error of displacement and velocity after a time that is not a multiple of a period.
fn oscillator_error(scheme: &dyn TimeScheme, n_steps: u32) -> f64 {
    let (omega, time) = (3.0_f64, 2.0);
    let dt = time / f64::from(n_steps);
    let end = (0..n_steps).fold(start([1.0, 0.0], [0.0, omega]), |level, _| oscillate(scheme, omega, dt, level));
    let (s, c) = (omega * time).sin_cos();
    let distance = |found: &[f64], exact: [f64; 2]| (found[0] - exact[0]).hypot(found[1] - exact[1]);
    distance(&end.displacement, [c, s]) + distance(&end.velocity, [-s * omega, c * omega]) / omega
}

#[test]
fn orders_on_an_oscillator() {
    let order = |scheme: &dyn TimeScheme| (oscillator_error(scheme, 200) / oscillator_error(scheme, 400)).log2();
    let euler = order(&ImplicitEuler);
    assert!((euler - 1.0).abs() < 0.1, "{euler}");
    for rho_inf in [0.0, 0.5, 0.8, 1.0] {
        let order = order(&generalised_alpha(rho_inf));
        assert!((order - 2.0).abs() < 0.05, "{rho_inf}: {order}");
    }
}

#[test]
fn fast_vibrations_are_damped_by_the_spectral_radius() {
    for rho_inf in [0.3, 0.8, 1.0] {
        let (mut level, mut sizes) = (start([1.0, 0.3], [0.2, -0.5]), Vec::new());
        for _ in 0..100 {
            level = oscillate(&generalised_alpha(rho_inf), 1e6, 1.0, level);
            sizes.push(squared_norm(&level.displacement).sqrt());
        }
        // A double root adds a factor that is linear in the number of steps.
        let radius = (sizes[99] / sizes[49]).powf(1.0 / 50.0);
        assert!((radius - rho_inf).abs() < 0.03 * rho_inf, "{rho_inf}: {radius}");
    }
}

#[test]
fn a_radius_of_one_damps_nothing() {
    let omega = 5.0;
    let energy = |level: &Level<f64>| squared_norm(&level.velocity) + omega * omega * squared_norm(&level.displacement);
    let start = start([1.0, 0.3], [0.2, -0.5]);
    let after = |scheme: &dyn TimeScheme| {
        energy(&(0..100).fold(start.clone(), |level, _| oscillate(scheme, omega, 0.1, level)))
    };
    assert!((after(&generalised_alpha(1.0)) / energy(&start) - 1.0).abs() < 1e-12);
    let (damped, euler) = (after(&generalised_alpha(0.8)), after(&ImplicitEuler));
    assert!(
        euler < 1e-3 * energy(&start) && damped > 0.8 * energy(&start) && damped < energy(&start),
        "{damped} {euler}"
    );
}

#[test]
fn rules_of_first_order_are_their_formulas() {
    let (dt, now) = (1.3e-3, [8.0, -3.0]);
    let known = start([0.4, -0.9], [7.0, 2.0]);
    let euler = StepRule::new(&ImplicitEuler, &[dt], std::slice::from_ref(&known));
    let still = StepRule::new(&QuasiStatic, &[dt], std::slice::from_ref(&known));
    for (k, v) in now.into_iter().enumerate() {
        let displacement = known.displacement[k] + v * dt;
        assert_eq!(euler.stage.displacement.at(k, v), displacement);
        assert_eq!(still.stage.displacement.at(k, v), displacement);
        assert_eq!(euler.stage.acceleration.at(k, v), known.velocity[k] * -dt.recip() + v * dt.recip());
        assert_eq!(still.stage.acceleration.at(k, v), 0.0);
    }
    for rule in [&euler, &still] {
        assert_eq!(rule.stage, rule.end);
        assert_eq!(rule.level(now.to_vec()).displacement, [0, 1].map(|k| rule.end.displacement.at(k, now[k])));
    }
}

#[test]
fn a_step_without_known_acceleration_is_exact_under_constant_acceleration() {
    let (dt, a) = (0.1, -7.0);
    for rho_inf in [0.0, 0.8, 1.0] {
        let mut level = start([0.5, 0.0], [2.0, -1.0]);
        for step in 1..=5 {
            let rule = StepRule::new(&generalised_alpha(rho_inf), &[dt], &[level]);
            let at_rest = &rule.stage.acceleration;
            level = rule.level((0..2).map(|k| (a - at_rest.at(k, 0.0)) / at_rest.slope).collect());
            let time = dt * f64::from(step);
            for (k, (d, v)) in [(0.5, 2.0), (0.0, -1.0)].into_iter().enumerate() {
                assert!((level.displacement[k] - (d + v * time + 0.5 * a * time * time)).abs() < 1e-13);
                assert!((level.velocity[k] - (v + a * time)).abs() < 1e-13);
                assert!((level.acceleration[k] - a).abs() < 1e-11);
            }
        }
    }
}

#[test]
fn radii_out_of_range_are_refused() {
    for rho_inf in [-0.1, 1.1, f64::NAN] {
        assert_eq!(GeneralisedAlpha::new(rho_inf), None);
    }
}
