//! Problems with rotational symmetry: solutions inside the discrete space on cut meshes, and those of bodies in space.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::fixture::*;
use solid_svk::{Load, SolidMesh, Support, SupportKind};
use solver::algebra::NewtonSettings;
use solver::algebra::time::QuasiStatic;
use solver::contact::{AugmentedLagrangianLaw, ContactForm, StressSource};
use solver::mesh::generate::{BallOptions, Size, graded_box, half_ball, structured_box};
use solver::mesh::{BodyId, Coordinates, Placed, SimplexMesh, VertexId};
use solver::{Contact, Error, FluidBoundary, Setup};

fn around_axis(mesh: SimplexMesh<2>) -> SimplexMesh<2> {
    mesh.with_coordinates(Coordinates::Axisymmetric).expect("radii of zero and more")
}

fn background() -> SimplexMesh<2> {
    around_axis(graded_box::<2>([0.0, 0.0], [1.5, 2.0], &Size::uniform(0.13)).expect("a box"))
}

/// Returns the half plane of a ball.
fn ball(height: f64, radius: f64, size: f64) -> SimplexMesh<2> {
    around_axis(half_ball([0.0, height], radius, size, &BallOptions::default()).expect("a ball"))
}

/// Returns a fluid with the axis on its left side.
fn around(density: f64, viscosity: f64, dt: f64) -> Setup<2> {
    let mut setup = setup(fluid(background(), density, viscosity), dt);
    on_sides(&mut setup, &["left"], || FluidBoundary::symmetry(0));
    setup
}

/// Sets velocities on the outer sides and as the start.
fn flows(setup: &mut Setup<2>, open: &[&str], u: impl Fn(&P) -> V + Clone + Send + Sync + 'static) {
    let at_start = u.clone();
    fluid_of(setup).initial_velocity = Some(Arc::new(at_start));
    let sides: Vec<&str> = ["right", "bottom", "top"].into_iter().filter(|side| !open.contains(side)).collect();
    on_sides(setup, &sides, || {
        let u = u.clone();
        FluidBoundary::Velocity(Arc::new(move |x, _| u(x)))
    });
}

#[test]
fn a_strain_flow_and_its_pressure_are_exact_around_a_body_that_moves_through_them() {
    // u = (a r, -2 a z) is free of divergence in space, with u·∇u = (a² r, 4 a² z).
    let a = 0.6;
    let u = move |x: &P| V::new(a * x[0], -2.0 * a * x[1]);
    for form in [solver::ConvectionForm::Standard, solver::ConvectionForm::Skew] {
        let mut setup = around(1.2, 0.3, 0.02);
        fluid_of(&mut setup).convection = Some(form);
        fluid_of(&mut setup).body_force = Some(Arc::new(move |x, _| V::new(a * a * x[0], 4.0 * a * a * x[1]) * 1.2));
        flows(&mut setup, &["top"], u);
        let traction = move |_: &P, n: &V, _: f64| V::new(2.0 * a * n[0], -4.0 * a * n[1]) * 0.3 - n * 1.7;
        on_sides(&mut setup, &["top"], || FluidBoundary::Open { traction: Some(Arc::new(traction)), backflow: false });
        setup.bodies.push(prescribed(&ball(0.8, 0.45, 0.1), |x, t| x + V::new(0.0, 1.5 * t), move |x, _| u(x)));
        let (state, reports) = run(&setup, 6);
        let (error_u, error_p) = fluid_error(&setup, &state, u, |_| 1.7);
        assert!(error_u < 1e-10 && error_p < 1e-10, "{form:?}: u {error_u:e}, p {error_p:e}");
        assert!(reports.iter().map(|report| wet_report(report).n_uncovered).sum::<usize>() > 0);
        // The body cuts the cells that it moves through.
        assert!(wet_report(&reports[5]).cut.n_cut_cells > 10);
    }
}

#[test]
fn fluid_at_rest_carries_a_ball_by_the_weight_of_its_volume() {
    let (rho, g) = (1.3, 9.0);
    let mut setup = around(rho, 0.2, 0.01);
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| V::new(0.0, -rho * g)));
    on_sides(&mut setup, &["right", "bottom", "top"], || FluidBoundary::NoSlip);
    let mesh = ball(0.97, 0.4, 0.09);
    setup.bodies.push(Arc::new(rigid("ball", &mesh, rho, V::new(0.0, -g))));
    let (state, reports) = run(&setup, 3);
    let shift = wet(&state).pressure[0] + rho * g * background().vertex(wet(&state).space.vertex(0))[1];
    let (error_u, error_p) = fluid_error(&setup, &state, |_| V::zeros(), |x| shift - rho * g * x[1]);
    assert!(error_u < 1e-10 && error_p < 1e-10, "u {error_u:e}, p {error_p:e}");
    let forces = reports[2].bodies[0].forces.expect("forces");
    let volume = Placed::new(&mesh.boundary(), mesh.vertices()).enclosed().volume;
    assert!((volume / (4.0 / 3.0 * PI * 0.4_f64.powi(3)) - 1.0).abs() < 0.02);
    assert!((forces.pressure - V::new(0.0, rho * g * volume)).norm() < 1e-10, "{}", forces.pressure);
    assert!(motion(&state, 0).velocity.norm() < 1e-10);
}

#[test]
fn bodies_and_fluid_move_along_the_axis_together() {
    let u = V::new(0.0, 0.7);
    for is_elastic in [false, true] {
        let mut setup = around(1.3, 0.05, 0.02);
        flows(&mut setup, &[], move |_| u);
        if is_elastic {
            let mut body = elastic("ball", ball(0.7, 0.4, 0.11), 0.7, 2e3, 8e3, V::zeros());
            body.options.initial_velocity = Some(Arc::new(move |_| u));
            setup.bodies.push(body.body());
        } else {
            let mut body = rigid("ball", &ball(0.7, 0.4, 0.11), 0.7, V::zeros());
            body.initial_velocity = u;
            setup.bodies.push(Arc::new(body));
        }
        let (state, _) = run(&setup, 10);
        let (error_u, error_p) = fluid_error(&setup, &state, |_| u, |_| 0.0);
        assert!(error_u < 1e-10 && error_p < 1e-10, "u {error_u:e}, p {error_p:e}");
        assert!(state.bodies[0].velocity().iter().all(|v| (v - u).norm() < 1e-10));
    }
}

/// Returns the stretch `s` of a ball of Saint Venant-Kirchhoff material under a pressure `p` from outside:
/// `(3 λ + 2 μ)(s² - 1)/(2 s) = -p`.
fn stretch(mu: f64, lambda: f64, pressure: f64) -> f64 {
    let ratio = pressure / (3.0 * lambda + 2.0 * mu);
    (1.0 + ratio * ratio).sqrt() - ratio
}

#[test]
fn a_ball_under_pressure_shrinks_as_in_space() {
    let (mu, lambda) = (2e6, 8e6);
    // Values computed independently.
    for (pressure, found) in [(1e4, -3.5707908e-4), (1e5, -3.5650510e-3), (1e6, -3.5076734e-2)] {
        let s = stretch(mu, lambda, pressure);
        assert!((s - 1.0 - found).abs() < 1e-9);
        for curved in [false, true] {
            let mut body = elastic("ball", ball(0.0, 1.0, 0.3), 1.0, mu, lambda, V::zeros());
            if curved {
                body.solid = SolidMesh::curved(ball(0.0, 1.0, 0.5), |_, middle| middle).expect("a mesh");
            }
            body.options.loads.push(Load::pressure(body.side("surface"), pressure));
            // One node on the axis keeps the ball in its place.
            let held = body.solid.nodes().iter().position(|x| x[0] == 0.0).expect("a node on the axis");
            let kind = SupportKind::Displacement(Arc::new(move |x: &P, _| [None, Some((s - 1.0) * x[1])]));
            body.options.supports.push(Support { vertices: vec![VertexId::new(held)], kind });
            let nodes = body.solid.nodes().to_vec();
            let mut setup = dry(vec![body.body()], 1.0);
            setup.scheme = Arc::new(QuasiStatic);
            let (state, reports) = run(&setup, 1);
            for (x, d) in nodes.iter().zip(state.bodies[0].displacement()) {
                assert!((d - x * (s - 1.0)).norm() < 1e-10, "curved {curved}, p {pressure}: {d} at {x}");
            }
            let balance = reports[0].bodies[0].balance.expect("a mass");
            assert!((balance.volume / balance.mass - s.powi(3)).abs() < 1e-10);
        }
    }
}

#[test]
fn a_bar_under_axial_stretch_is_that_of_space() {
    // Uniaxial stress: the first stretch is given, the other two follow from S_rr = S_θθ = 0.
    let (mu, lambda) = (2e6, 8e6);
    let mut body = elastic(
        "bar",
        around_axis(structured_box([0.0, 0.0], [0.5, 2.0], [2, 5]).expect("a box")),
        1.0,
        mu,
        lambda,
        V::zeros(),
    );
    let along = 1.2;
    body.support("bottom", SupportKind::symmetry(1));
    body.support("top", SupportKind::Displacement(Arc::new(move |x, _| [None, Some((along - 1.0) * x[1])])));
    let nodes = body.solid.nodes().to_vec();
    let mut setup = dry(vec![body.body()], 1.0);
    setup.scheme = Arc::new(QuasiStatic);
    let (state, reports) = run(&setup, 1);
    let strain = 0.5 * (along * along - 1.0);
    let across = (1.0_f64 - lambda / (lambda + mu) * strain).sqrt();
    for (x, d) in nodes.iter().zip(state.bodies[0].displacement()) {
        assert!((d - V::new((across - 1.0) * x[0], (along - 1.0) * x[1])).norm() < 1e-10, "{d} at {x}");
    }
    // Energy: E/2 E_zz² per volume with Young's modulus of small strains.
    let young = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    let energy = 0.5 * young * strain * strain * PI * 0.25 * 2.0;
    let balance = reports[0].bodies[0].balance.expect("a mass");
    assert!((balance.elastic_energy / energy - 1.0).abs() < 1e-10, "{}", balance.elastic_energy);
    assert!((balance.mass / (PI * 0.25 * 2.0) - 1.0).abs() < 1e-13);
}

#[test]
fn an_elastic_ball_in_fluid_under_pressure_keeps_its_stretch() {
    let (mu, lambda, pressure) = (2e3, 8e3, 100.0);
    let (s, centre) = (stretch(mu, lambda, pressure), P::new(0.0, 0.93));
    let mut setup = around(1.0, 0.1, 1e-2);
    on_sides(&mut setup, &["right", "bottom", "top"], || FluidBoundary::Open {
        traction: Some(Arc::new(move |_, n, _| n * -pressure)),
        backflow: true,
    });
    let mut body = elastic("ball", ball(0.93, 0.5, 0.11), 1.0, mu, lambda, V::zeros());
    body.options.initial_displacement = Some(Arc::new(move |x| (x - centre) * (s - 1.0)));
    setup.bodies.push(body.body());
    let (state, _) = run(&setup, 3);
    let (u, p) = fluid_error(&setup, &state, |_| V::zeros(), |_| pressure);
    assert!(u < 1e-10 && p < 1e-10 * pressure, "u {u:e}, p {p:e}");
    assert!(state.bodies[0].velocity().iter().all(|v| v.norm() < 1e-10));
}

#[test]
fn a_cylinder_stands_on_the_ground_with_its_weight() {
    // Penalty law: pressure λ = (γ/s) (ε - Δ) on the area π R².
    let (density, g, stiffness, offset, size) = (2.0, 10.0, 1e3, 0.05, 0.1);
    let mesh = around_axis(structured_box([0.0, 0.0], [0.6, 1.0], [3, 4]).expect("a box"));
    let (area, weight) = (PI * 0.36, density * g * PI * 0.36);
    let depth = weight / (stiffness / size * area);
    let lifted = mesh.mapped(|x| x + V::new(0.0, offset - depth)).expect("a mesh");
    let mut setup = dry(vec![Arc::new(rigid("cylinder", &lifted, density, V::new(0.0, -g)))], 1e-2);
    let surface = setup.bodies[0].surface();
    let bottom: Vec<_> = surface.facets().filter(|facet| surface.tag(*facet) == lifted.tag("bottom")).collect();
    setup.contacts.push(contact_of(&setup.bodies, 0, bottom, (stiffness, offset, size), ground()));
    let (state, reports) = run(&setup, 1);
    assert!((reports[0].contacts[0].force - V::new(0.0, weight)).norm() < 1e-9 * weight);
    assert!((reports[0].contacts[0].active_area - area).abs() < 1e-12);
    assert!(motion(&state, 0).velocity.norm() < 1e-10);
}

#[test]
fn tangents_are_exact() {
    let mut setup = around(1.1, 0.2, 0.02);
    fluid_of(&mut setup).convection = Some(solver::ConvectionForm::Skew);
    on_sides(&mut setup, &["right", "bottom", "top"], || FluidBoundary::Open { traction: None, backflow: true });
    let mut body = elastic("ball", ball(0.55, 0.5, 0.17), 1.0, 2e3, 8e3, V::zeros());
    let surface = body.side("surface");
    body.options.loads.push(Load::pressure(surface.clone(), 300.0));
    setup.bodies.push(body.body());
    setup.contacts.push(contact_of(&setup.bodies, 0, surface.clone(), (1e4, 0.2, 0.1), ground()));
    let names = check_tangents(&setup, 1.0);
    assert_contain(&names, &CONTRIBUTIONS);
    for stress in [StressSource::Solid, StressSource::Fluid, StressSource::Jump] {
        contact_with_stress_on(&mut setup, 0, surface.clone(), stress);
        assert!(check_tangents(&setup, 1.0).contains(&"contact"));
    }
}

#[test]
fn the_flow_through_a_pipe_has_its_parabola() {
    // Poiseuille: u_z = 1 - r², p = -4 μ z.
    let mu = 0.5;
    let u = |x: &P| V::new(0.0, 1.0 - x[0] * x[0]);
    // T n of the parabola has a shear along the side, and no other traction where the flow is held parallel.
    let open = || FluidBoundary::Open {
        traction: Some(Arc::new(move |x, n, _| V::new(-2.0 * mu * x[0], 0.0) * n[1] + n * (4.0 * mu * x[1]))),
        backflow: false,
    };
    let parallel = || FluidBoundary::Parallel {
        normal: V::new(0.0, 1.0),
        traction: Some(Arc::new(move |x, n, _| n * (4.0 * mu * x[1]))),
    };
    let ends: [&dyn Fn() -> FluidBoundary<2>; 2] = [&open, &parallel];
    for end in ends {
        let errors = [12, 24].map(|n| {
            let pipe = around_axis(structured_box([0.0, 0.0], [1.0, 1.0], [n, n / 2]).expect("a box"));
            let mut setup = setup(fluid(pipe, 1.0, mu), 1e3);
            fluid_of(&mut setup).initial_velocity = Some(Arc::new(u));
            on_sides(&mut setup, &["left"], || FluidBoundary::symmetry(0));
            on_sides(&mut setup, &["right"], || FluidBoundary::NoSlip);
            on_sides(&mut setup, &["bottom", "top"], end);
            let (state, reports) = run(&setup, 3);
            // ρ/2 ∫ u² = π/6 for the exact flow.
            let energy = (wet_report(&reports[2]).kinetic_energy / (TAU / 12.0) - 1.0).abs();
            [fluid_error(&setup, &state, u, |x| -4.0 * mu * x[1]).0, energy]
        });
        for (coarse, fine) in errors[0].iter().zip(errors[1]) {
            assert!(fine < coarse / 3.0, "no second order: {errors:?}");
        }
    }
}

#[test]
fn other_coordinates_and_a_wall_on_the_axis_are_refused() {
    let mut wall = setup(fluid(background(), 1.0, 0.1), 0.1);
    on_sides(&mut wall, &SIDES, || FluidBoundary::NoSlip);
    assert!(matches!(wall.check(), Err(Error::Axis)));
    let mut plane = around(1.0, 0.1, 0.1);
    on_sides(&mut plane, &["right", "bottom", "top"], || FluidBoundary::NoSlip);
    plane.bodies.push(prescribed(&disk([0.7, 0.9], 0.3, 0.1), |x, _| *x, |_, _| V::zeros()));
    assert!(matches!(plane.check(), Err(Error::Coordinates { .. })));
    let across = structured_box([-0.5, 0.0], [0.5, 1.0], [2, 2]).expect("a box");
    assert!(across.with_coordinates(Coordinates::Axisymmetric).is_err());
    let space = structured_box([0.0; 3], [1.0; 3], [1, 1, 1]).expect("a box");
    assert!(space.with_coordinates(Coordinates::Axisymmetric).is_err());
}

#[test]
fn a_rigid_ball_rests_on_the_floor_or_on_a_ball_with_its_weight() {
    // Its lowest point is on the axis. The law holds it at the distance zero from the floor, or from another ball.
    let (density, gravity) = (2.0, 10.0);
    for has_floor in [true, false] {
        let falling = rigid("ball", &ball(0.5001, 0.5, 0.1), density, V::new(0.0, -gravity));
        let below = prescribed(&ball(-0.4, 0.4, 0.07), |x, _| *x, |_, _| V::zeros());
        let mut setup = dry(vec![Arc::new(falling), below], 0.01);
        setup.newton = NewtonSettings::new(1e-9);
        let law = AugmentedLagrangianLaw::new(1e6, 0.0, 0.0, 1e-6).expect("a law");
        let form = ContactForm::new(law, 0.1).expect("a size");
        let obstacle = if has_floor { ground() } else { against(1, &setup.bodies) };
        let facets = setup.bodies[0].surface().facets().collect();
        setup.contacts.push(Contact::new(&setup.bodies, BodyId(0), facets, form, obstacle).expect("a contact"));
        let (state, reports) = run(&setup, 30);
        let balance = setup.bodies[0].balance(&state.bodies[0]).expect("a free body");
        let contact = &reports.last().expect("a step").contacts[0];
        let force = contact.force[1] / (balance.mass * gravity);
        assert!((force - 1.0).abs() < 1e-4, "{force}");
        let gap = contact.minimum_gap.expect("a gap");
        assert!(gap.abs() < 1e-6, "{gap}");
    }
}
