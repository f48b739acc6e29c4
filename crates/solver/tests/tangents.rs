//! Every contribution of the coupled problem against finite differences, at random states.

mod fixture;

use fixture::*;
use solver::algebra::check_tangent;
use solver::contact::{ContactForm, ContactLaw, ContactPoint, ContactTraction, StressSource};
use solver::mesh::BodyId;
use solver::{Contact, Setup, Stabilisation, Stage, State, Step, Substep, advance};

/// Returns a pseudo-random number between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Checks all contributions of the first step at a state that is random in every field.
fn check(setup: &Setup<2>, speed: f64, names: &mut Vec<&'static str>) {
    let mut previous = State::initial(setup).expect("a cut");
    if let Some(fluid) = &mut previous.fluid {
        for (k, u) in fluid.velocity.iter_mut().enumerate() {
            *u = V::new(noise(2 * k), noise(2 * k + 1)) * speed;
        }
    }
    let step = Step::prepare(setup, &previous, previous.step_time(setup, setup.dt)).expect("a cut");
    let problem = step.problem();
    let mut x = step.guess();
    for (k, value) in x.iter_mut().enumerate() {
        *value += speed * noise(7 * k + 3);
    }
    for contribution in &problem.equations.contributions {
        let worst = check_tangent(contribution.as_ref(), &x, 1e-4 * speed);
        assert!(worst < 1e-6, "{}: {worst:e}", contribution.name());
        if !contribution.is_empty() {
            names.push(contribution.name());
        }
    }
}

#[test]
fn tangents_are_exact() {
    let mut names = Vec::new();
    // Close to the ground, so that many points are in contact; both sets of parameters, with and without the skew part.
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    check(&setup, 3.0, &mut names);
    fluid_of(&mut setup).stabilisation = Stabilisation::STANDARD;
    fluid_of(&mut setup).convection = Some(true);
    setup.bodies.push(prescribed(&disk([6.0, 12.0], 1.3, 0.5), |x, _| *x, |x, _| V::new(x[1], -x[0])));
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

#[test]
fn tangents_of_a_ball_of_quadratic_elements_are_exact() {
    let mut names = Vec::new();
    let mut setup = falling_round_ball(0.9, 0.3, 0.6, 0.0);
    check(&setup, 3.0, &mut names);
    contact_with_stress(&mut setup, 0, StressSource::Solid);
    check(&setup, 3.0, &mut names);
    for name in ["solid inertia and body force", "solid internal work", "interface", "contact"] {
        assert!(names.contains(&name), "{name} was not checked: {names:?}");
    }
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

/// The linear part of a Nitsche-like law, everywhere active: `λ = -(ε - Δ) + σ_n`.
#[derive(Debug)]
struct WithStress(StressSource);

impl ContactLaw for WithStress {
    fn traction(&self, at: &ContactPoint) -> ContactTraction {
        let mut traction = ContactTraction::default();
        traction.value[0] = at.gap - self.offset() + at.stress[0];
        traction.by_gap[0] = 1.0;
        traction.by_stress[0][0] = 1.0;
        traction
    }

    fn is_active(&self, _at: &ContactPoint) -> bool {
        true
    }

    fn offset(&self) -> f64 {
        0.6
    }

    fn stress(&self) -> StressSource {
        self.0
    }
}

/// Replaces the contact of a setup by one of body `slave` with the ground.
fn contact_with_stress(setup: &mut Setup<2>, slave: u32, stress: StressSource) {
    let form = ContactForm::new(WithStress(stress), 0.9).expect("a contact");
    let facets = setup.bodies[slave as usize].surface().facets().collect();
    setup.contacts = vec![Contact::new(&setup.bodies, BodyId(slave), facets, form, ground()).expect("a contact")];
}

#[test]
fn tangents_of_laws_with_the_stress_of_solid_and_fluid_are_exact() {
    for stress in [StressSource::Solid, StressSource::Fluid, StressSource::Jump] {
        let (mut setup, mut names) = (falling_ball(0.9, 0.3, 0.6, false), Vec::new());
        contact_with_stress(&mut setup, 0, stress);
        check(&setup, 3.0, &mut names);
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
    assert!(matches!(Step::prepare(&setup, &state, time), Err(Stage::MissingStress { .. })));
}

/// Returns the falling ball with the weight `alpha` of the fluid's traction.
fn with_share(alpha: f64, dt: f64) -> Setup<2> {
    let mut setup = falling_ball(0.9, 0.3, 0.6, false);
    fluid_of(&mut setup).alpha = alpha;
    Setup { dt, ..setup }
}

/// Checks tangents with a share of the solid in the traction, and that consistency and adjoint consistency are transposed: the
/// mortar is symmetric in the velocities.
#[test]
fn the_share_of_the_solid_is_symmetric() {
    for alpha in [0.4, 0.0] {
        let (setup, mut names) = (with_share(alpha, 1e-5), Vec::new());
        check(&setup, 3.0, &mut names);
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
                let mut residual = vec![0.0; x.len()];
                interface.add_residual(&x, &mut residual);
                residual.iter().zip(test).map(|(r, t)| r * t).sum()
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
        Stage::UnstableShare { alpha, penalty, required, .. } => {
            assert!(alpha == 0.5 && penalty < required);
        }
        other => panic!("{other}"),
    }
}
