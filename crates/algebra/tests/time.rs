//! Time schemes on an oscillator: order, damping, energy; rules against their formulas.

use algebra::time::{Affine, GeneralisedAlpha, ImplicitEuler, Level, QuasiStatic, StepRule, TimeScheme};

fn generalised_alpha(rho_inf: f64) -> GeneralisedAlpha {
    GeneralisedAlpha::new(rho_inf).expect("a radius from 0 to 1")
}

/// Returns a level without acceleration; each node is an oscillator.
fn start(displacement: [f64; 2], velocity: [f64; 2]) -> Level<f64> {
    Level { displacement: displacement.to_vec(), velocity: velocity.to_vec(), acceleration: Vec::new() }
}

/// Advances oscillators `a + ω² d = 0` by one step.
fn oscillate(scheme: &dyn TimeScheme, omega: f64, dt: f64, level: Level<f64>) -> Level<f64> {
    let weights = scheme.weights(dt, level.acceleration.is_empty());
    let StepRule { displacement: d, acceleration: a } = StepRule::new(&weights, &level);
    let slope = a.slope + omega.powi(2) * d.slope;
    let velocity: Vec<f64> = (0..2).map(|k| -(a.at(k, 0.0) + omega.powi(2) * d.at(k, 0.0)) / slope).collect();
    weights.end(&level, &velocity)
}

/// Advances `du/dt + λ u = 0` by one step; returns the level at the end and the velocity at the stage.
fn decay(scheme: &dyn TimeScheme, lambda: f64, dt: f64, level: &Level<f64>) -> (Level<f64>, f64) {
    let weights = scheme.weights(dt, level.acceleration.is_empty());
    let acceleration = Affine::new(&weights.stage_acceleration, level);
    let at_stage = -acceleration.at(0, 0.0) / (acceleration.slope + lambda);
    (weights.end(level, &[at_stage]), at_stage)
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
    let euler = StepRule::new(&ImplicitEuler.weights(dt, true), &known);
    let still = StepRule::new(&QuasiStatic.weights(dt, true), &known);
    for (k, v) in now.into_iter().enumerate() {
        let displacement = known.displacement[k] + v * dt;
        assert_eq!(euler.displacement.at(k, v), displacement);
        assert_eq!(still.displacement.at(k, v), displacement);
        assert_eq!(euler.acceleration.at(k, v), known.velocity[k] * -dt.recip() + v * dt.recip());
        assert_eq!(still.acceleration.at(k, v), 0.0);
    }
    let [at_end, of_still] = [&ImplicitEuler as &dyn TimeScheme, &QuasiStatic].map(|scheme| {
        let end = scheme.weights(dt, false).end(&known, &now);
        assert_eq!(end.displacement, [0, 1].map(|k| euler.displacement.at(k, now[k])));
        assert_eq!(end.velocity, now);
        end.acceleration
    });
    assert_eq!(at_end, [0, 1].map(|k| euler.acceleration.at(k, now[k])));
    assert!(of_still.is_empty());
}

#[test]
fn a_step_without_known_acceleration_is_exact_under_constant_acceleration() {
    let (dt, a) = (0.1, -7.0);
    for rho_inf in [0.0, 0.8, 1.0] {
        let mut level = start([0.5, 0.0], [2.0, -1.0]);
        for step in 1..=5 {
            let weights = generalised_alpha(rho_inf).weights(dt, level.acceleration.is_empty());
            let at_rest = StepRule::new(&weights, &level).acceleration;
            let velocity: Vec<f64> = (0..2).map(|k| (a - at_rest.at(k, 0.0)) / at_rest.slope).collect();
            level = weights.end(&level, &velocity);
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
fn equations_of_first_order_are_advanced_with_the_same_order() {
    let error = |scheme: &dyn TimeScheme, n: u32| {
        let dt = f64::from(n).recip();
        let start = Level { velocity: vec![1.0], ..Level::default() };
        let end = (0..n).fold(start, |level, _| decay(scheme, 2.0, dt, &level).0);
        (end.velocity[0] - (-2.0_f64).exp()).abs()
    };
    for rho_inf in [0.0, 0.5, 0.8, 1.0] {
        let scheme = generalised_alpha(rho_inf);
        let order = (error(&scheme, 100) / error(&scheme, 200)).log2();
        assert!((order - 2.0).abs() < 0.05, "{rho_inf}: {order}");
    }
    assert!((error(&ImplicitEuler, 100) / error(&ImplicitEuler, 200)).log2() < 1.1);
}

/// Returns the energy of a scheme for oscillators with `ω²`; a level without acceleration gets that of `rates`.
fn scheme_energy(scheme: &dyn TimeScheme, dt: f64, omega: f64, level: &Level<f64>, rates: &Level<f64>) -> f64 {
    let motions = scheme.weights(dt, false).of_energy.map(|rows| level.at_rows(rates, &rows));
    let energy =
        |motion: Level<f64>| squared_norm(&motion.velocity) + omega.powi(2) * squared_norm(&motion.displacement);
    0.25 * motions.map(energy).iter().sum::<f64>()
}

/// With `r = (1 - ρ_∞)/(1 + ρ_∞)` and `w = Δt a`, inertia times velocity at the stage is the change of the energy of
/// the scheme plus `3/4 r³ (w^{n+1} - w^n)²`, whatever the force.
#[test]
fn the_power_of_inertia_is_a_change_of_energy_and_a_loss() {
    for (rho_inf, lambda) in [(0.0, 3.0), (0.5, 300.0), (0.8, -2.0)] {
        let (scheme, dt) = (generalised_alpha(rho_inf), 0.1);
        let r = (1.0 - rho_inf) / (1.0 + rho_inf);
        let mut level = Level { velocity: vec![1.0], acceleration: vec![0.7], ..Level::default() };
        for _ in 0..5 {
            let energy = |level: &Level<f64>| scheme_energy(&scheme, dt, 0.0, level, level);
            let (end, at_stage) = decay(&scheme, lambda, dt, &level);
            let loss = 0.75 * r.powi(3) * (dt * (end.acceleration[0] - level.acceleration[0])).powi(2);
            let power = -lambda * at_stage * at_stage * dt;
            assert!((energy(&end) - energy(&level) + loss - power).abs() < 1e-12 * energy(&level));
            level = end;
        }
    }
}

#[test]
fn oscillators_lose_energy_of_the_scheme_by_its_formula() {
    for (rho_inf, omega, dt) in [(0.0, 3.0, 0.1), (0.5, 40.0, 0.1), (0.8, 7.0, 0.3), (1.0, 5.0, 0.2)] {
        let scheme = generalised_alpha(rho_inf);
        let r = (1.0 - rho_inf) / (1.0 + rho_inf);
        let mut level = start([1.0, 0.3], [0.2, -0.5]);
        for step in 0..6 {
            let end = oscillate(&scheme, omega, dt, level.clone());
            // In the first step the acceleration is constant.
            let rates = if level.acceleration.is_empty() { &end } else { &level };
            let energy = |level, rates| scheme_energy(&scheme, dt, omega, level, rates);
            let loss = |k: usize| {
                let of_inertia = dt * (end.acceleration[k] - rates.acceleration[k]);
                let of_stiffness = omega * dt * (end.velocity[k] - level.velocity[k] - 0.5 * r * of_inertia);
                0.75 * r.powi(3) * of_inertia.powi(2) + 0.25 * r.powi(3) * of_stiffness.powi(2)
            };
            let (before, after) = (energy(&level, rates), energy(&end, &end));
            assert!((before - after - loss(0) - loss(1)).abs() < 1e-12 * before, "{rho_inf} {step}: {before} {after}");
            level = end;
        }
    }
}

#[test]
fn shifted_displacements_change_by_the_velocity_of_the_stage() {
    let schemes: [&dyn TimeScheme; 3] = [&generalised_alpha(0.3), &ImplicitEuler, &QuasiStatic];
    let known = Level { acceleration: vec![-40.0, 3.0], ..start([0.4, -0.9], [7.0, 2.0]) };
    for (scheme, starts) in schemes.into_iter().flat_map(|scheme| [(scheme, false), (scheme, true)]) {
        let level = if starts { start([0.4, -0.9], [7.0, 2.0]) } else { known.clone() };
        let weights = scheme.weights(0.2, starts);
        let [from, to] = weights.shifted.map(|row| Affine::new(&row, &level));
        for (k, v) in [8.0, -3.0].into_iter().enumerate() {
            assert!((to.at(k, v) - from.at(k, v) - 0.2 * v).abs() < 1e-14, "{scheme:?}");
        }
        // In the next step, which has the same length, the shifted displacement at the start is the one at this end.
        if !starts {
            let end = weights.end(&level, &[8.0, -3.0]);
            let again = Affine::new(&weights.shifted[0], &end);
            assert!((0..2).all(|k| (again.at(k, 0.0) - to.at(k, [8.0, -3.0][k])).abs() < 1e-13), "{scheme:?}");
        }
    }
}

#[test]
fn radii_out_of_range_are_refused() {
    for rho_inf in [-0.1, 1.1, f64::NAN] {
        assert_eq!(GeneralisedAlpha::new(rho_inf), None);
    }
}
