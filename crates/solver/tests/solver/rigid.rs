//! Rigid bodies, alone, in contact and in the fluid, against exact solutions.

use std::sync::Arc;

use crate::fixture::*;
use solid_rigid::RigidBody;
use solver::algebra::{
    BlockGaussSeidel, BlockGaussSeidelSettings, LaggedSettings, LaggedSolver, LinearError, LinearReport, LinearSolver,
    LinearSystem, NewtonSettings, Workspace,
};
use solver::body::Body;
use solver::contact::{AugmentedLagrangianLaw, CollisionLaw, ContactForm, PenaltyLaw, RigidPlane, RigidSurface};
use solver::mesh::generate::{Size, graded_box, structured_box};
use solver::mesh::{BodyId, FacetId, SimplexMesh, Vector};
use solver::{Contact, ContactObstacle, Error, FluidBoundary, Setup, State, Substep, TimeLoop, advance};

#[test]
fn a_free_body_falls_and_turns_by_the_scheme() {
    let mut body = rigid("block", &structured_box::<2>([1.0, 2.0], [3.0, 3.0], [2, 1]).expect("a box"), 2.0, {
        V::new(0.0, -10.0)
    });
    body.initial_velocity = V::new(3.0, 1.0);
    body.initial_spin = [4.0, 0.0, 0.0];
    let (n, dt) = (25, 0.01);
    let (state, _) = run(&dry(vec![Arc::new(body)], dt), n);
    let motion = motion(&state, 0);
    let time = n as f64 * dt;
    // Implicit Euler: v_n = v_0 + g n dt, and the sum of it.
    let fallen = V::new(3.0, 1.0) * time + V::new(0.0, -10.0) * (dt * dt * (n * (n + 1) / 2) as f64);
    assert!((motion.centre - P::new(2.0, 2.5) - fallen).norm() < 1e-12);
    assert!((motion.rotation[(1, 0)] - (4.0 * time).sin()).abs() < 1e-12, "angles add up exactly");
    let corner = P::new(1.0, 2.0) + state.bodies[0].displacement()[0];
    assert!(((corner - motion.centre).norm() - 1.25_f64.sqrt()).abs() < 1e-12, "and nothing is stretched");
}

#[test]
fn a_body_bounces_off_a_plane_as_a_mass_on_a_spring() {
    // A box whose whole bottom is on the plane: stiffness k per area, width 2, mass 6.
    let mesh = structured_box::<2>([0.0, 0.0], [2.0, 1.0], [4, 2]).expect("a box");
    let mut body = rigid("box", &mesh, 3.0, V::zeros());
    body.initial_velocity = V::new(0.7, -1.0);
    let stiffness = 3e4;
    // Without the sides: their weight in the direction of the normal of the plane would be another spring.
    let boundary = body.boundary.clone();
    let bottom = |f: &solver::mesh::FacetId| boundary.facet(*f).iter().all(|v| mesh.vertices()[v.index()][1] == 0.0);
    let mut setup = dry(vec![Arc::new(body)], 1e-5);
    let facets = boundary.facets().filter(bottom).collect();
    setup.contacts.push(contact_of(&setup.bodies, 0, facets, (stiffness, 0.0, 1.0), ground()));
    let half_period = std::f64::consts::PI / (stiffness * 2.0 / 6.0_f64).sqrt();
    let (state, reports) = run(&setup, (1.2 * half_period / setup.dt) as usize);
    let active = reports.iter().filter(|r| r.contacts[0].is_active()).count() as f64 * setup.dt;
    assert!((active / half_period - 1.0).abs() < 2e-3, "{active} {half_period}");
    let motion = motion(&state, 0);
    let impulse: V = reports.iter().map(|r| r.contacts[0].force * setup.dt).sum();
    assert!(((motion.velocity - V::new(0.7, -1.0)) * 6.0 - impulse).norm() < 1e-9);
    assert!((motion.velocity - V::new(0.7, 1.0)).norm() < 5e-3, "{}", motion.velocity);
    assert!(motion.spin[0].abs() < 1e-9, "hit in the middle");
}

#[test]
fn two_bodies_that_collide_off_centre_keep_momentum_and_angular_momentum() {
    let mut ball = rigid("ball", &disk([-1.1, 0.3], 1.0, 0.2), 2.0, V::zeros());
    ball.initial_velocity = V::new(5.0, 0.0);
    let brick = rigid("brick", &structured_box::<2>([0.0, -1.0], [0.8, 1.0], [2, 5]).expect("a box"), 1.0, V::zeros());
    let mut setup = dry(vec![Arc::new(ball), Arc::new(brick)], 1e-4);
    setup.contacts.push(contact(&setup.bodies, 0, (1e4, 0.0, 1.0), against(1, &setup.bodies)));
    let whole = |state: &State<2>| {
        let (mut momentum, mut angular, mut energy) = (V::zeros(), 0.0, 0.0);
        for b in 0..state.bodies.len() {
            let motion = motion(state, b);
            let p = setup.bodies[b].balance(&state.bodies[b]).expect("rigid").momentum;
            momentum += p;
            angular += motion.angular_momentum[0] + motion.centre[0] * p[1] - motion.centre[1] * p[0];
            energy += setup.bodies[b].balance(&state.bodies[b]).expect("rigid").energy();
        }
        (momentum, angular, energy)
    };
    let (before, (state, reports)) = (whole(&State::initial(&setup).expect("bodies")), run(&setup, 2000));
    assert!(reports.iter().any(|r| r.contacts[0].is_active()) && !reports[1999].contacts[0].is_active());
    let after = whole(&state);
    assert!((after.0 - before.0).norm() < 1e-9 * before.0.norm());
    // To the motion within steps: a moment of the force about positions half a step apart.
    assert!((after.1 - before.1).abs() < 1e-3 * before.0.norm(), "{} {}", before.1, after.1);
    assert!(after.2 < before.2 && after.2 > 0.9 * before.2, "{} {}", before.2, after.2);
    assert!(motion(&state, 1).spin[0].abs() > 0.1, "the brick turns");
}

/// Returns the contact of the facets of a body at the height zero, by an augmented Lagrangian with offset and friction.
fn augmented<const D: usize>(
    bodies: &[Arc<dyn Body<D>>],
    slave: usize,
    (gamma, offset, friction): (f64, f64, f64),
    obstacle: ContactObstacle<D>,
) -> Contact<D> {
    let body = &bodies[slave];
    let (surface, positions) = (body.surface(), body.reference());
    let lowest = positions.iter().map(|x| x[D - 1]).fold(f64::INFINITY, f64::min);
    let is_base = |f: &FacetId| surface.facet(*f).iter().all(|v| positions[v.index()][D - 1] < lowest + 1e-9);
    let tolerance = if friction > 0.0 { 1e-8 } else { 1e-9 };
    let law = AugmentedLagrangianLaw::new(gamma, offset, friction, tolerance).expect("a law");
    let form = ContactForm::new(law, 1.0).expect("a contact");
    Contact::new(bodies, BodyId(slave as u32), surface.facets().filter(is_base).collect(), form, obstacle).expect("one")
}

#[test]
fn augmented_contact_has_exact_gaps_and_forces_whatever_its_parameter() {
    // A box falls on a box that rests on the ground; masses are 6 and 4, gravity is 10.
    let box_of = |min: [f64; 2], max: [f64; 2], name: &str| {
        rigid(name, &structured_box::<2>(min, max, [3, 1]).expect("a box"), 2.0, V::new(0.0, -10.0))
    };
    let offset = 0.01;
    let mut solves = Vec::new();
    for gamma in [3e4, 3e7] {
        let lower: Arc<dyn Body<2>> = Arc::new(box_of([0.0, 0.02], [3.0, 1.02], "lower"));
        let upper: Arc<dyn Body<2>> = Arc::new(box_of([0.5, 1.1], [2.5, 2.1], "upper"));
        let mut setup = dry(vec![lower, upper], 0.01);
        setup.newton = NewtonSettings::new(1e-9);
        setup.contacts.push(augmented(&setup.bodies, 0, (gamma, offset, 0.0), ground()));
        setup.contacts.push(augmented(&setup.bodies, 1, (gamma, offset, 0.0), against(0, &setup.bodies)));
        let (state, reports) = run(&setup, 30);
        let last = &reports[29];
        let [force, between] = [0, 1].map(|k| last.contacts[k].force[1]);
        assert!((force - 100.0).abs() < 1e-6 && (between - 40.0).abs() < 1e-6, "{gamma}: {force} {between}");
        let gaps = [0, 1].map(|k| last.contacts[k].minimum_gap.expect("a gap") - offset);
        assert!(gaps.iter().all(|gap| gap.abs() < 1e-8), "{gamma}: {gaps:?}");
        assert!((0..2).all(|b| motion(&state, b).velocity.norm() < 1e-6));
        assert!(reports.iter().all(|r| r.contacts.iter().all(|c| c.largest_penetration < 1e-8)));
        solves.push(last.newton.iterations);
    }
    // A penalty of the smaller parameter is penetrated by 100/(3e4 * 3), and the multipliers take more solves.
    assert!(solves[0] > solves[1], "{solves:?}");
}

/// Checks a rigid box on a slope of 30 degrees that sticks, and one that slides.
fn slope<const D: usize>(along: Vector<D>) {
    let (sin, cos, n, dt) = (0.5, 0.75_f64.sqrt(), 50, 0.01);
    let mut down = along * (10.0 * sin);
    down[D - 1] = -10.0 * cos;
    let mesh = structured_box::<D>([0.0; D], std::array::from_fn(|a| if a == D - 1 { 0.5 } else { 2.0 }), [2; D]);
    for friction in [0.3, 0.7] {
        let mut setup = dry(vec![Arc::new(rigid("box", &mesh.clone().expect("a box"), 1.0, down))], dt);
        setup.newton = NewtonSettings::new(1e-9);
        setup.contacts.push(augmented(&setup.bodies, 0, (1e6, 0.0, friction), ground()));
        let (state, reports) = run(&setup, n);
        let velocity = motion(&state, 0).velocity;
        let exact = along * (10.0 * (sin - friction * cos).max(0.0) * dt * n as f64);
        assert!((velocity - exact).norm() < 1e-6, "{friction}: {velocity} {exact}");
        assert!(motion(&state, 0).spin.iter().all(|spin| spin.abs() < 1e-6));
        let force = reports[n - 1].contacts[0].force / down.norm();
        let mass = 2_f64.powi(D as i32 - 1) * 0.5;
        assert!(
            (force[D - 1] / mass - cos).abs() < 1e-6
                && (force.dot(&along) / mass + (friction * cos).min(sin)).abs() < 1e-6
        );
    }
}

#[test]
fn a_rigid_box_on_a_slope_sticks_or_slides_by_the_law_of_coulomb() {
    slope(V::new(1.0, 0.0));
    slope(Vector::<3>::new(0.8, -0.6, 0.0));
}

/// A block on a floor with a load across it that is a tenth larger than what tips it. The block turns about its lower
/// edge. Contact is one point there, and the slowest factor of the iteration of multipliers is nearly one.
#[test]
fn a_rigid_block_tips_over_its_edge() {
    let (width, height, dt, n) = (0.3, 1.0, 0.002, 50);
    let across = 1.1 * 10.0 * width / height;
    let block = structured_box::<2>([0.0, 0.0], [width, height], [3, 10]).expect("a box");
    let mut setup = dry(vec![Arc::new(rigid("block", &block, 1000.0, V::new(across, -10.0)))], dt);
    setup.newton = NewtonSettings::new(1e-9);
    setup.contacts.push(augmented(&setup.bodies, 0, (1e10, 0.0, 0.8), ground()));
    let (state, _) = run(&setup, n);
    // The moment about the edge, which grows with the angle, over the moment of inertia about it.
    let inertia = (width * width + height * height) / 3.0;
    let (acceleration, growth) =
        ((across * height - 10.0 * width) / 2.0 / inertia, ((10.0 * height + across * width) / 2.0 / inertia).sqrt());
    let (spin, time) = (motion(&state, 0).spin[0].abs(), dt * n as f64);
    let expected = acceleration * (growth * time).sinh() / growth;
    assert!((spin - expected).abs() < 2e-3 * expected, "{spin} {expected}");
    let edge = state.bodies[0].positions(setup.bodies[0].reference())[3];
    assert!((edge - V::new(width, 0.0)).norm() < 1e-4, "{edge}");
}

/// Returns a brick between two planes that are closer to each other than its height.
fn brick_between_planes() -> Setup<2> {
    let brick = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [1, 1]).expect("a box");
    let mut setup = dry(vec![Arc::new(rigid("brick", &brick, 1.0, V::zeros()))], 0.01);
    setup.newton = NewtonSettings::new(1e-9);
    let facets: Vec<_> = setup.bodies[0].surface().facets().collect();
    for (height, up) in [(0.1, -1.0), (0.95, 1.0)] {
        let plane = RigidPlane::new(P::new(0.0, height), V::new(0.0, up)).expect("a plane");
        let law = AugmentedLagrangianLaw::new(1e4, 0.0, 0.0, 1e-6).expect("a law");
        let (form, obstacle) = (ContactForm::new(law, 1.0).expect("one"), ContactObstacle::Rigid(Box::new(plane)));
        setup.contacts.push(Contact::new(&setup.bodies, BodyId(0), facets.clone(), form, obstacle).expect("a contact"));
    }
    setup
}

#[test]
fn a_body_that_does_not_fit_between_its_obstacles_is_an_error_with_a_remedy() {
    let setup = brick_between_planes();
    let state = State::initial(&setup).expect("bodies");
    let Err(error) = advance(&setup, &state, Substep::whole(0.01), &mut Workspace::new()) else {
        panic!("the planes are 0.85 apart, and the brick is 1 high")
    };
    assert!(matches!(error.source, Error::Multipliers { .. }), "{error:?}");
    assert!(error.source.to_string().contains("check that the body fits between its obstacles"), "{error:?}");
    assert!(error.source.newton_report().is_some_and(|report| report.iterations > 200));
}

/// The iteration without acceleration leaves the factor `K/(K + 300)` of the error in each solve, with `K = 6/0.01²`.
#[test]
fn a_parameter_that_is_far_too_small_costs_few_solves() {
    let brick = structured_box::<2>([0.0, -0.01], [3.0, 0.99], [3, 1]).expect("a box");
    let mut setup = dry(vec![Arc::new(rigid("brick", &brick, 2.0, V::new(1.0, 0.0)))], 0.01);
    setup.newton = NewtonSettings::new(1e-9);
    setup.contacts.push(augmented(&setup.bodies, 0, (100.0, 0.0, 0.0), ground()));
    let state = State::initial(&setup).expect("bodies");
    let (_, report) = advance(&setup, &state, Substep::whole(0.01), &mut Workspace::new()).expect("a soft contact");
    assert!(report.contacts[0].minimum_gap.is_some_and(|gap| gap.abs() < 1e-10), "{report:?}");
    assert!(report.newton.iterations < 20, "{report:?}");
}

/// Linear solver that fails after some solves.
struct Failing {
    solver: LaggedSolver,
    n_left: usize,
}

impl LinearSolver for Failing {
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError> {
        self.solver.factorize(system)
    }

    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<LinearReport, LinearError> {
        self.n_left = self.n_left.checked_sub(1).ok_or(LinearError::NotFinite { row: 0 })?;
        self.solver.solve(system, rhs, x, tolerance)
    }

    fn n_factorizations(&self) -> usize {
        self.solver.n_factorizations()
    }
}

#[test]
fn a_later_solve_that_fails_keeps_the_counts_of_the_solves_before() {
    let setup = brick_between_planes();
    let state = State::initial(&setup).expect("bodies");
    let failing = Failing { solver: LaggedSolver::new(LaggedSettings::default()), n_left: 6 };
    let mut work = Workspace::with_solver(Box::new(failing));
    let Err(error) = advance(&setup, &state, Substep::whole(0.01), &mut work) else { panic!("the solver fails") };
    assert!(matches!(error.source, Error::Newton(_)), "{error:?}");
    assert_eq!(error.source.newton_report().map(|report| report.iterations), Some(6));
}

#[test]
fn held_bodies_stay_where_they_are_held() {
    let mut body =
        rigid("box", &structured_box::<2>([0.0; 2], [1.0; 2], [1, 1]).expect("a box"), 1.0, V::new(2.0, -3.0));
    body.held_axes = [false, true];
    body.holds_rotation = true;
    let (state, _) = run(&dry(vec![Arc::new(body)], 0.1), 5);
    let motion = motion(&state, 0);
    assert_eq!((motion.velocity[1], motion.spin[0]), (0.0, 0.0));
    assert!((motion.velocity[0] - 1.0).abs() < 1e-12);
}

#[test]
fn a_plate_that_moves_as_prescribed_pushes_a_body() {
    // Without gravity, the body takes the speed of the plate and, the penalty being elastic, twice that when it leaves.
    let block = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [2, 2]).expect("a box");
    let plate = structured_box::<2>([-0.5, -1.0], [1.5, 0.0], [2, 1]).expect("a box");
    let upwards = prescribed(&plate, |x, t| x + V::new(0.0, 2.0 * t), |_, _| V::new(0.0, 2.0));
    let mut setup = dry(vec![Arc::new(rigid("block", &block, 1.0, V::zeros())), upwards], 2e-5);
    setup.contacts.push(contact(&setup.bodies, 0, (1e4, 0.0, 1.0), against(1, &setup.bodies)));
    let (state, reports) = run(&setup, 3000);
    assert!(reports[0].contacts[0].is_active() && !reports[2999].contacts[0].is_active());
    let velocity = motion(&state, 0).velocity;
    assert!((velocity - V::new(0.0, 4.0)).norm() < 0.05, "{velocity}");
}

fn background() -> SimplexMesh<2> {
    graded_box::<2>([0.0; 2], [2.0; 2], &Size::uniform(0.21)).expect("a box")
}

/// Returns the setup of a closed box of Stokes fluid with a body in it, and the velocity `u(x, t)` on the walls.
fn in_a_box(body: RigidBody<2>, dt: f64, u: impl Fn(&P, f64) -> V + Send + Sync + 'static) -> Setup<2> {
    let mut setup = setup(fluid(background(), 1.3, 0.7), dt);
    fluid_of(&mut setup).convection = None;
    setup.bodies.push(Arc::new(body));
    let u = Arc::new(u);
    fluid_of(&mut setup).initial_velocity = Some(Arc::new({
        let u = u.clone();
        move |x| u(x, 0.0)
    }));
    on_sides(&mut setup, &SIDES, || FluidBoundary::Velocity(u.clone()));
    setup
}

/// Checks a body of the fluid's density in a fluid that moves as a rigid body: `u = U + ω × (x - c)`, `c` moving with
/// `U`. There is no stress, and the acceleration is `-ω × U`, which a body force makes. Returns the number of uncovered
/// dofs.
fn neutral(velocity: V, omega: f64, n: usize) -> usize {
    let (dt, centre) = (0.02, P::new(0.7, 1.2));
    let mesh = structured_box::<2>([0.5, 0.95], [0.9, 1.45], [2, 3]).expect("a box");
    let mut body = rigid("square", &mesh, 1.3, V::zeros());
    body.initial_velocity = velocity;
    body.initial_spin = [omega, 0.0, 0.0];
    // Positions of the step to time t are those at t - dt.
    let u = move |x: &P, t: f64| {
        let arm = x - centre - velocity * (t - dt);
        velocity + V::new(-arm[1], arm[0]) * omega
    };
    let mut setup = in_a_box(body, dt, u);
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| V::new(velocity[1], -velocity[0]) * (1.3 * omega)));
    let (state, reports) = run(&setup, n);
    let time = state.time;
    let motion = motion(&state, 0);
    assert!((motion.centre - centre - velocity * time).norm() < 1e-10, "{}", motion.centre);
    assert!((motion.spin[0] - omega).abs() < 1e-9 && (motion.velocity - velocity).norm() < 1e-9);
    assert!((motion.rotation[(1, 0)] - (omega * time).sin()).abs() < 1e-10);
    let (error_u, error_p) = fluid_error(&setup, &state, |x| u(x, time), |_| 0.0);
    assert!(error_u < 1e-9 && error_p < 1e-7, "{error_u:e} {error_p:e}");
    assert!(reports.iter().all(|r| wet_report(r).n_pockets == 1), "an immersed body does not fix the pressure");
    reports.iter().map(|r| wet_report(r).n_uncovered).sum()
}

#[test]
fn a_neutral_body_moves_and_turns_with_the_fluid() {
    assert!(neutral(V::new(1.1, -0.6), 0.0, 12) > 0);
    assert!(neutral(V::zeros(), 2.5, 30) > 0);
    // Uncovered dofs take the current velocity of the body, not that on the lagging geometry; until one is uncovered,
    // the solution is exact.
    assert_eq!(neutral(V::new(1.1, -0.6), 2.5, 5), 0);
}

/// Returns the setup of a square that turns and drifts in a closed box of fluid at rest.
fn stirring() -> Setup<2> {
    let mesh = structured_box::<2>([0.6, 0.9], [1.1, 1.3], [3, 2]).expect("a box");
    let mut body = rigid("square", &mesh, 2.0, V::new(0.0, -3.0));
    body.initial_spin = [6.0, 0.0, 0.0];
    body.initial_velocity = V::new(0.8, 0.3);
    let mut setup = in_a_box(body, 0.02, |_, _| V::zeros());
    fluid_of(&mut setup).convection = Some(solver::ConvectionForm::Standard);
    setup.newton = NewtonSettings::new(1e-10);
    setup
}

#[test]
fn the_fluid_slows_a_turning_body_by_the_moment_of_its_traction() {
    let setup = stirring();
    let (mut state, mut work) = (State::initial(&setup).expect("a cut"), Workspace::new());
    for _ in 0..5 {
        let before = motion(&state, 0);
        let (next, report) = solver::advance(&setup, &state, Substep::whole(setup.dt), &mut work).expect("a step");
        let pieces = wet(&next).cut.interface().iter().zip(&wet_report(&report).tractions);
        let moment: f64 = pieces.map(|(piece, traction)| traction.moment(&before.centre)[2] * piece.measure).sum();
        let after = motion(&next, 0);
        let change = (after.angular_momentum[0] - before.angular_momentum[0]) / setup.dt;
        assert!(change < 0.0 && (change - moment).abs() < 1e-7 * change.abs(), "{change} {moment}");
        assert!(report.bodies[0].forces.expect("rigid").remainder().norm() < 1e-7);
        state = next;
    }
}

#[test]
fn ties_are_the_same_for_every_linear_solver_and_number_of_threads() {
    let setup = stirring();
    let take = |mut work: Workspace| {
        let mut state = State::initial(&setup).expect("a cut");
        for _ in 0..4 {
            state = solver::advance(&setup, &state, Substep::whole(setup.dt), &mut work).expect("a step").0;
        }
        motion(&state, 0)
    };
    let direct = take(Workspace::new());
    let blocks = BlockGaussSeidelSettings::default();
    for other in [
        Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default()))),
        Workspace::with_solver(Box::new(BlockGaussSeidel::new(blocks))),
    ] {
        let found = take(other);
        assert!((found.velocity - direct.velocity).norm() < 1e-6 * direct.velocity.norm());
        assert!((found.spin[0] - direct.spin[0]).abs() < 1e-6 * direct.spin[0].abs());
    }
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        assert_eq!(pool.install(|| take(Workspace::new())), direct, "{threads} threads");
    }
}

#[test]
fn a_plate_that_moves_as_prescribed_pushes_a_body_through_the_fluid_from_either_side_of_the_contact() {
    let pushed = |slave: usize| {
        let block = structured_box::<2>([0.7, 0.91], [1.2, 1.3], [3, 3]).expect("a box");
        let plate = structured_box::<2>([0.5, 0.6], [1.5, 0.9], [5, 2]).expect("a box");
        let mut setup = in_a_box(rigid("block", &block, 3.0, V::new(0.0, -50.0)), 0.01, |_, _| V::zeros());
        setup.bodies.push(prescribed(&plate, |x, t| x + V::new(0.0, 0.5 * t), |_, _| V::new(0.0, 0.5)));
        // A film of fluid stays between them, within which they push each other.
        let contact = contact(&setup.bodies, slave, (1e4, 0.02, 1.0), against(1 - slave, &setup.bodies));
        setup.contacts.push(contact);
        let (state, reports) = run(&setup, 12);
        for report in &reports {
            // Whichever of the two is the slave, the contact force balances the other forces of the block.
            let push = if slave == 0 { report.contacts[0].force } else { -report.contacts[0].force };
            let forces = report.bodies[0].forces.expect("rigid");
            assert!((push - forces.contact - forces.remainder()).norm() < 1e-6, "{push} {forces:?}");
            assert!(push[1] > 29.25, "it carries the weight, which hydrostatic pressure does not here: {push}");
        }
        assert!(reports[11].contacts[0].is_active());
        motion(&state, 0)
    };
    let [block, plate] = [pushed(0), pushed(1)];
    assert!((block.velocity[1] - 0.5).abs() < 0.05 && (plate.velocity[1] - 0.5).abs() < 0.05, "{block:?} {plate:?}");
    assert!((block.centre - plate.centre).norm() < 2e-3, "{} {}", block.centre, plate.centre);
}

/// A plate whose corners are all outside of the background, and that divides it, has not left.
#[test]
fn a_body_with_all_vertices_outside_of_the_domain_moves_in_it() {
    let mesh = structured_box::<2>([-0.5, 0.61], [2.5, 0.87], [1, 1]).expect("a box");
    let mut plate = rigid("plate", &mesh, 2.0, V::zeros());
    plate.initial_velocity = V::new(0.0, -0.1);
    let mut setup = in_a_box(plate, 0.02, |_, _| V::zeros());
    fluid_of(&mut setup).boundary.clear();
    let (state, _) = run(&setup, 2);
    assert!(motion(&state, 0).velocity[1] < -0.01, "{:?}", motion(&state, 0));
}

#[test]
fn a_body_that_has_left_the_domain_ends_the_run() {
    let mesh = structured_box::<2>([0.8, -0.3], [1.2, 0.05], [2, 2]).expect("a box");
    let mut body = rigid("stone", &mesh, 50.0, V::zeros());
    body.initial_velocity = V::new(0.0, -2.0);
    let mut setup = in_a_box(body, 0.02, |_, _| V::zeros());
    fluid_of(&mut setup).boundary.clear();
    let start = State::initial(&setup).expect("a cut");
    let outcome = TimeLoop::new(&setup, start, Workspace::new()).run(10, &mut []);
    let failure = outcome.expect_err("it cannot come back");
    assert!(matches!(&failure.source, Error::LeftDomain { body } if body == "stone"), "{failure:?}");
}

#[test]
fn a_heavy_body_at_rest_is_held_by_the_fluid_it_displaces() {
    // Neutral under gravity: hydrostatic pressure carries it.
    let gravity = V::new(0.0, -10.0);
    let body = rigid("disk", &disk([1.03, 0.97], 0.4, 0.15), 1.3, gravity);
    let mut setup = in_a_box(body, 0.05, |_, _| V::zeros());
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| gravity * 1.3));
    let (state, reports) = run(&setup, 3);
    // Known up to a constant.
    let first = background().vertex(wet(&state).space.vertices()[0]);
    let constant = wet(&state).pressure[0] + 13.0 * first[1];
    let (error_u, error_p) = fluid_error(&setup, &state, |_| V::zeros(), |x| constant - 13.0 * x[1]);
    assert!(error_u < 1e-9 && error_p < 1e-6, "{error_u:e} {error_p:e}");
    let forces = reports[2].bodies[0].forces.expect("rigid");
    assert!(forces.remainder().norm() < 1e-8 && (forces.pressure + forces.body_force).norm() < 1e-8);
}

#[test]
fn the_force_on_a_body_that_accelerates_does_not_grow_as_steps_become_shorter() {
    // Velocity at a time at which the boundary layer is thin: a light disk, which the added mass slows most.
    let speed = |n: usize| {
        let body = rigid("disk", &disk([1.03, 0.97], 0.4, 0.15), 0.1, V::new(0.0, -1.0));
        let mut setup = in_a_box(body, 0.01 / n as f64, |_, _| V::zeros());
        fluid_of(&mut setup).material.viscosity = 1e-3;
        motion(&run(&setup, n).0, 0).velocity[1]
    };
    let [few, many] = [5, 100].map(speed);
    assert!(few < 0.0 && (many / few - 1.0).abs() < 0.02, "{few:e} {many:e}");
}

/// Returns the setup of a plate across the box, which slides up and down unless it is held, with walls at rest.
fn piston(gravity: V, holds_height: bool) -> Setup<2> {
    let plate = structured_box::<2>([-0.2, 0.9], [2.2, 1.15], [4, 1]).expect("a box");
    let mut body = rigid("plate", &plate, 1.0, V::zeros());
    body.gravity = gravity;
    body.held_axes = [true, holds_height];
    body.holds_rotation = true;
    in_a_box(body, 0.05, |_, _| V::zeros())
}

#[test]
fn a_piston_fixes_the_pressure_behind_it() {
    let n_pockets = |holds_height: bool| {
        let mut setup = piston(V::zeros(), holds_height);
        let top = background().tag("top");
        fluid_of(&mut setup).boundary.retain(|(tag, _)| Some(*tag) != top);
        wet_report(&run(&setup, 1).1[0]).n_pockets
    };
    assert_eq!(n_pockets(false), 0, "open above, and a movable plate below");
    assert_eq!(n_pockets(true), 1, "open above, closed below");
}

#[test]
fn the_difference_of_pressures_alone_moves_a_piston_in_a_closed_box() {
    // Gravity on the fluid, and on the plate as if it were fluid: all at rest, and the pressure goes on through the
    // plate.
    let gravity = V::new(0.0, -10.0);
    // The plate is 2.4 wide, of which 0.4 are outside.
    let mut setup = piston(gravity * (1.3 * 2.0 / 2.4), false);
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| gravity * 1.3));
    let (state, reports) = run(&setup, 2);
    assert_eq!(wet_report(&reports[1]).n_pockets, 1);
    let first = background().vertex(wet(&state).space.vertices()[0]);
    let constant = wet(&state).pressure[0] + 13.0 * first[1];
    let (error_u, error_p) = fluid_error(&setup, &state, |_| V::zeros(), |x| constant - 13.0 * x[1]);
    assert!(error_u < 1e-9 && error_p < 1e-6, "{error_u:e} {error_p:e}");
    assert!(motion(&state, 0).velocity.norm() < 1e-9);
}

#[test]
fn a_guided_body_is_free_after_its_release() {
    let mut body = rigid("disk", &disk([0.0, 1.0], 1.0, 0.3), 2.0, V::new(0.0, -3.0));
    let velocity = Arc::new(|t: f64| V::new(2.0 * t, 0.0));
    body.guide = Some(solid_rigid::Guide { until: 0.5, velocity });
    let setup = dry(vec![Arc::new(body)], 0.1);
    let (state, _) = run(&setup, 5);
    assert!((motion(&state, 0).velocity - V::new(1.0, 0.0)).norm() < 1e-12);
    // Positions by implicit Euler: 0.1 (0.2 + 0.4 + 0.6 + 0.8 + 1.0).
    assert!((motion(&state, 0).centre[0] - 0.3).abs() < 1e-12 && (motion(&state, 0).centre[1] - 1.0).abs() < 1e-12);
    let (state, _) = run(&setup, 8);
    assert!((motion(&state, 0).velocity - V::new(1.0, -0.9)).norm() < 1e-12);
}

/// Checks a block that falls close to the side of a step whose top alone is an obstacle.
fn beside_a_step<const D: usize>() {
    let block_of = |low: [f64; 2], high: [f64; 2]| {
        let corner = |ends: [f64; 2], others: f64| {
            std::array::from_fn(|a| {
                if a == 0 {
                    ends[0]
                } else if a + 1 == D {
                    ends[1]
                } else {
                    others
                }
            })
        };
        structured_box::<D>(corner(low, 0.0), corner(high, 1.0), [2; D]).expect("a box")
    };
    let step = block_of([0.0, 0.0], [1.0, 0.5]);
    let surface = step.boundary();
    let top = surface.facets().filter(|f| surface.tag(*f) == step.tag("top")).collect();
    let obstacle = RigidSurface::new(surface, top, step.vertices().to_vec()).expect("a surface");
    let penalty = || ContactForm::new(PenaltyLaw::new(1e4, 0.1).expect("a law"), 0.1).expect("one");
    let collision = || ContactForm::new(CollisionLaw::new(0.5, 0.1).expect("a law"), 0.1).expect("one");
    let forms: [&dyn Fn() -> ContactForm<D>; 2] = [&penalty, &collision];
    for form in forms {
        let mut body = rigid("block", &block_of([1.02, 0.2], [1.5, 0.45]), 2.0, Vector::zeros());
        let down = Vector::<D>::from_fn(|a, _| if a + 1 == D { -0.5 } else { 0.0 });
        body.initial_velocity = down;
        let mut setup = dry(vec![Arc::new(body)], 0.01);
        let facets = setup.bodies[0].surface().facets().collect();
        let obstacle = ContactObstacle::Rigid(Box::new(obstacle.clone()));
        setup.contacts.push(Contact::new(&setup.bodies, BodyId(0), facets, form(), obstacle).expect("a contact"));
        let (state, _) = run(&setup, 5);
        let found = motion(&state, 0).velocity;
        assert!((found - down).norm() < 1e-12, "{found}");
    }
}

#[test]
fn a_body_beside_a_step_does_not_touch_its_top() {
    beside_a_step::<2>();
    beside_a_step::<3>();
}
