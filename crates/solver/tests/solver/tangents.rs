//! Every contribution of the coupled problem against finite differences, at random states.

use crate::fixture::*;
use solver::algebra::for_each_residual;
use solver::contact::StressSource;
use solver::mesh::Vector;
use solver::mesh::generate::structured_box;
use solver::{Error, Setup, Stabilisation, State, Step, Substep, advance};

#[test]
fn tangents_are_exact() {
    // Close to the ground, so that many points are in contact; both sets of parameters, with and without the skew part.
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    let mut names = check_tangents(&setup, 3.0);
    fluid_of(&mut setup).stabilisation = Stabilisation::STANDARD;
    fluid_of(&mut setup).convection = Some(solver::ConvectionForm::Skew);
    setup.bodies.push(prescribed(&disk([6.0, 12.0], 1.3, 0.5), |x, _| *x, |x, _| V::new(x[1], -x[0])));
    names.extend(check_tangents(&setup, 3.0));
    assert_contain(&names, &CONTRIBUTIONS);
}

#[test]
fn tangents_of_a_ball_of_quadratic_elements_are_exact() {
    let mut setup = falling_round_ball(0.9, 0.3, 0.6, 0.0);
    let mut names = check_tangents(&setup, 3.0);
    contact_with_stress(&mut setup, 0, StressSource::Solid);
    names.extend(check_tangents(&setup, 3.0));
    setup.scheme = second_order(0.2);
    contact_with_stress(&mut setup, 0, StressSource::Jump);
    names.extend(check_tangents(&setup, 3.0));
    let expected = ["solid inertia and body force", "solid internal work", "interface", "contact", "moved surface"];
    assert_contain(&names, &expected);
}

#[test]
fn a_ball_of_quadratic_elements_moves_as_one_of_twice_as_many_linear_ones() {
    let [round, fine] = [falling_round_ball(0.9, 1.5, 0.6, 0.0), falling_ball(0.9, 1.5, 0.6, false)].map(|setup| {
        let (_, reports) = run(&setup, 3);
        reports[2].bodies[0].balance.expect("a mass")
    });
    // Both have the same number of facets on the surface.
    assert!((round.mass / (8.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4, "{}", round.mass);
    assert!((round.momentum[1] / fine.momentum[1] - 1.0).abs() < 0.05, "{} {}", round.momentum, fine.momentum);
    assert!(round.momentum[1] < -0.01 && round.smallest_volume_ratio > 0.99);
}

#[test]
fn tangents_of_laws_with_the_stress_of_solid_and_fluid_are_exact() {
    for stress in [StressSource::Solid, StressSource::Fluid, StressSource::Jump] {
        let mut setup = falling_ball(0.9, 0.3, 0.6, false);
        contact_with_stress(&mut setup, 0, stress);
        let names = check_tangents(&setup, 3.0);
        assert!(names.contains(&"contact"), "{names:?}");
    }
}

#[test]
fn tangents_of_laws_with_stress_are_exact_in_space() {
    for stress in [StressSource::Solid, StressSource::Fluid, StressSource::Jump] {
        let background = structured_box::<3>([0.0; 3], [3.0, 3.0, 2.0], [3, 3, 2]).expect("a box");
        let brick = structured_box::<3>([0.8, 0.9, 0.2], [2.1, 2.2, 1.3], [1; 3]).expect("a brick");
        let mut setup = setup(fluid(background, 1.1, 0.2), 0.02);
        setup.bodies.push(elastic("brick", brick, 1.0, 2e3, 8e3, Vector::zeros()).body());
        contact_with_stress(&mut setup, 0, stress);
        let names = check_tangents(&setup, 1.0);
        assert!(names.contains(&"contact"), "{names:?}");
    }
}

#[test]
fn a_law_without_its_stress_is_an_error() {
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    setup.bodies.push(prescribed(&disk([6.0, 12.0], 1.3, 0.5), |x, _| *x, |_, _| V::zeros()));
    contact_with_stress(&mut setup, 1, StressSource::Solid);
    let state = State::initial(&setup).expect("a cut");
    let time = state.step_time(&setup, setup.dt);
    let slave = setup.bodies[1].name().to_owned();
    assert!(matches!(Step::prepare(&setup, &state, time), Err(Error::MissingStress { body, .. }) if body == slave));
}

/// Returns the falling ball with the weight `alpha` of the fluid's traction.
fn with_share(alpha: f64, dt: f64) -> Setup<2> {
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    fluid_of(&mut setup).alpha = alpha;
    Setup { dt, ..setup }
}

/// Checks tangents with a share of the solid in the traction, and that consistency and adjoint consistency are
/// transposed: the mortar is symmetric in the velocities.
#[test]
fn the_share_of_the_solid_is_symmetric() {
    for alpha in [0.4, 0.0] {
        let setup = with_share(alpha, 1e-5);
        let names = check_tangents(&setup, 3.0);
        assert!(names.contains(&"interface"), "{names:?}");
        let previous = State::initial(&setup).expect("a cut");
        let step = Step::prepare(&setup, &previous, previous.step_time(&setup, setup.dt)).expect("a cut");
        let problem = step.problem();
        let points = problem.interface.as_ref().expect("a fluid");
        let pressures = step.layout.range(points.fields.pressure);
        let interface = problem.equations.contributions.iter().find(|terms| terms.name() == "interface");
        let interface = interface.expect("a mortar");
        let direction = |seed: usize| -> Vec<f64> {
            let value = |k: usize| if pressures.contains(&k) { 0.0 } else { noise(3 * k + seed) };
            (0..step.layout.len()).map(value).collect()
        };
        let (y, z, guess) = (direction(1), direction(2), step.guess());
        let times = |along: &[f64], test: &[f64]| {
            let power = |sign: f64| -> f64 {
                let x: Vec<f64> = guess.iter().zip(along).map(|(x, d)| x + sign * d).collect();
                let mut power = 0.0;
                for_each_residual(
                    interface.as_ref(),
                    0..interface.len(),
                    &x,
                    |_| true,
                    |_, dofs, residual| {
                        power += dofs.iter().zip(residual).map(|(dof, r)| r * test[dof.index()]).sum::<f64>();
                    },
                );
                power
            };
            0.5 * (power(1.0) - power(-1.0))
        };
        let (a, b) = (times(&y, &z), times(&z, &y));
        assert!((a - b).abs() < 1e-8 * a.abs(), "{alpha}: {a} {b}");
    }
}

#[test]
fn a_share_beyond_the_penalty_is_an_error() {
    let found = |alpha: f64, dt: f64| {
        let setup = with_share(alpha, dt);
        let state = State::initial(&setup).expect("a cut");
        advance(&setup, &state, Substep::whole(dt), &mut solver::algebra::Workspace::new())
            .map_err(|error| error.source)
    };
    assert!(found(1.0, 1e-3).is_ok() && found(0.5, 1e-5).is_ok());
    match found(0.5, 1e-3).expect_err("unstable") {
        Error::UnstableShare { alpha, penalty, required, .. } => {
            assert!(alpha == 0.5 && penalty < required);
        }
        other => panic!("{other}"),
    }
}
