//! Every contribution of the coupled problem against finite differences, at random states.

mod fixture;

use fixture::*;
use solver::algebra::{NonlinearProblem, check_tangent};
use solver::cutcell::CutMesh;
use solver::mesh::generate::{BallOptions, ball};
use solver::{FsiProblem, Setup, State, StepForms, StepGeometry, StepSystem};

/// Numbers between -1 and 1 that look random.
fn noise(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Checks all contributions of the first step at a state that is random in every field.
fn check(setup: &Setup<2>, speed: f64, names: &mut Vec<&'static str>) {
    let mut previous = State::initial(setup).expect("a cut");
    for (k, u) in previous.fluid.velocity.iter_mut().enumerate() {
        *u = V::new(noise(2 * k), noise(2 * k + 1)) * speed;
    }
    let positions = setup.positions(&previous.bodies);
    let cut = CutMesh::overlay(&setup.background, &setup.surfaces(&positions), &setup.overlay).expect("a cut");
    let geometry = StepGeometry::new(setup, &previous, positions, cut);
    let system = StepSystem::new(setup, &geometry, &previous, setup.dt).expect("a system");
    let forms = StepForms::new(setup, &geometry, &system);
    let problem = FsiProblem::new(setup, &geometry, &system, &forms, &previous).expect("a problem");
    let mut x = problem.initial_guess(&geometry, &previous);
    for (k, value) in x.iter_mut().enumerate() {
        *value += speed * noise(7 * k + 3);
    }
    for contribution in problem.contributions() {
        let worst = check_tangent(contribution, &x, 1e-4 * speed);
        assert!(worst < 1e-6, "{}: {worst:e}", contribution.name());
        if !contribution.is_empty() {
            names.push(contribution.name());
        }
    }
}

#[test]
fn tangents_are_exact() {
    let mut names = Vec::new();
    // Close to the ground, so that many points are in contact; both profiles, with and without the skew part.
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    check(&setup, 3.0, &mut names);
    setup.fluid.cip = solver::fluid_ns::terms::CipProfile::Consistent { gamma_u: 0.1 };
    setup.fluid.convection = Some(true);
    let other = ball::<2>([6.0, 12.0], 1.3, 0.5, &BallOptions { area_preserving: false }).expect("a disk");
    setup.bodies.push(prescribed(&other, |x, _| *x, |x, _| V::new(x[1], -x[0])));
    check(&setup, 3.0, &mut names);
    for name in [
        "fluid cells",
        "fluid convection",
        "fluid faces",
        "open boundary",
        "solid inertia and body force",
        "solid internal work",
        "interface",
        "contact",
    ] {
        assert!(names.contains(&name), "{name} was not checked: {names:?}");
    }
}
