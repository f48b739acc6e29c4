//! Patch tests: solutions inside the discrete space, on cut meshes, to round-off.

use std::sync::Arc;

use crate::fixture::*;
use solid_svk::{Order, SolidMesh, Support, SupportKind};
use solver::algebra::time::{ImplicitEuler, QuasiStatic};
use solver::cutcell::{CutMesh, OverlayOptions};
use solver::mesh::generate::{Size, graded_box, structured_box};
use solver::mesh::{Aabb, Placed, SimplexMesh, Vector, VertexId};
use solver::xfem_space::{Sources, XfemSpace};
use solver::{FluidBoundary, Setup, Step};

fn background() -> solver::mesh::SimplexMesh<2> {
    graded_box::<2>([0.0, 0.0], [2.0, 1.5], &Size::uniform(0.13)).expect("a box")
}

/// Map from a mesh to a body.
type Elements = fn(SimplexMesh<2>) -> SolidMesh<2>;

/// Elements of order 1, of order 2 with straight edges, and of order 2 with edges on the circle of a disk.
const ELEMENTS: [Elements; 3] = [
    |mesh| SolidMesh::new(mesh).expect("a mesh"),
    |mesh| SolidMesh::of_order(mesh, Order::Quadratic).expect("a mesh"),
    |mesh| {
        let bounds = Aabb::of_points(mesh.vertices());
        let (centre, radius) = ((bounds.low + bounds.high) * 0.5, 0.5 * bounds.extent()[0]);
        let is_round = |x: P| ((x - centre).norm() - radius).abs() < 1e-3 * radius;
        let ends: Vec<P> = mesh.vertices().to_vec();
        let on_circle = |[a, b]: [VertexId; 2], middle: P| {
            let far = (middle - centre).norm() > 0.9 * radius;
            let is_edge = far && is_round(ends[a.index()]) && is_round(ends[b.index()]);
            if is_edge { centre + (middle - centre).normalize() * radius } else { middle }
        };
        SolidMesh::curved(mesh, on_circle).expect("a mesh")
    },
];

#[test]
fn uniform_pressure_around_a_closed_elastic_body() {
    // The disk x = s X with (λ + μ)(s² - 1) = -p balances the pressure p exactly; displacement is linear.
    let (mu, lambda) = (2e3, 8e3);
    for (pressure, make) in [(1.0, ELEMENTS[0]), (100.0, ELEMENTS[0]), (100.0, ELEMENTS[1]), (100.0, ELEMENTS[2])] {
        let s = (1.0_f64 - pressure / (lambda + mu)).sqrt();
        let centre = P::new(0.91, 0.73);
        let mut setup = setup(fluid(background(), 1.0, 0.1), 1e-2);
        on_sides(&mut setup, &SIDES, || FluidBoundary::Open {
            traction: Some(Arc::new(move |_, n, _| n * -pressure)),
            backflow: true,
        });
        let stretched = |s: f64| {
            let mesh = disk([0.91, 0.73], 0.4, 0.11);
            let mut body = elastic("disk", mesh.clone(), 1.0, mu, lambda, V::zeros());
            body.solid = make(mesh);
            body.options.initial_displacement = Some(Arc::new(move |x| (x - centre) * (s - 1.0)));
            body.body()
        };
        setup.bodies.push(stretched(s));
        let (state, _) = run(&setup, 3);
        let (u, p) = fluid_error(&setup, &state, |_| V::zeros(), |_| pressure);
        assert!(u < 1e-9 && p < 1e-9 * pressure.max(1.0), "u {u:e}, p {p:e}");
        let v = state.bodies[0].velocity().iter().map(|v| v.norm()).fold(0.0, f64::max);
        assert!(v < 1e-9, "the disk moves with {v:e}");
        // Another size of the disk is no equilibrium.
        let mut wrong = setup;
        wrong.bodies[0] = stretched(s - 0.001);
        let (state, _) = run(&wrong, 1);
        assert!(state.bodies[0].velocity().iter().any(|v| v.norm() > 1e-3));
    }
}

#[test]
fn a_body_follows_a_pressure_that_grows() {
    // Without inertia each step ends in equilibrium with its pressure. Its cut is that of the start, of larger area.
    let (mu, lambda) = (40.0, 60.0);
    for make in ELEMENTS {
        let mut setup = setup(fluid(background(), 1.0, 1e-2), 1.0);
        setup.scheme = Arc::new(QuasiStatic);
        on_sides(&mut setup, &["left", "right", "bottom"], || FluidBoundary::NoSlip);
        on_sides(&mut setup, &["top"], || FluidBoundary::Open {
            traction: Some(Arc::new(move |_, n, time| n * (-5.0 * time))),
            backflow: true,
        });
        let mesh = disk([1.0, 0.7], 0.4, 0.11);
        let mut body = elastic("disk", mesh.clone(), 1.0, mu, lambda, V::zeros());
        body.solid = make(mesh);
        setup.bodies.push(body.body());
        let (state, reports) = run(&setup, 5);
        for (step, report) in (1..).zip(&reports) {
            let balance = report.bodies[0].balance.as_ref().expect("a body");
            let area = 1.0 - 5.0 * f64::from(step) / (mu + lambda);
            let error = balance.volume / balance.mass / area - 1.0;
            assert!(error.abs() < 1e-4, "step {step}: {error:e}");
        }
        // The disk keeps its place and is not turned: shears are those of the flow.
        let (s, nodes) = ((1.0 - 25.0 / (mu + lambda)).sqrt(), setup.bodies[0].reference());
        let shifts: Vec<V> = nodes.iter().zip(state.bodies[0].displacement()).map(|(x, d)| x + d - (x * s)).collect();
        let worst = shifts.iter().map(|shift| (shift - shifts[0]).norm()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst:e}");
    }
}

#[test]
fn uniform_pressure_around_an_elastic_brick_of_either_order() {
    // (3 λ + 2 μ)(s² - 1)/(2 s) = -p.
    let (mu, lambda, pressure) = (2e3, 8e3, 100.0);
    let ratio = pressure / (3.0 * lambda + 2.0 * mu);
    let s = (1.0_f64 + ratio * ratio).sqrt() - ratio;
    for order in [Order::Linear, Order::Quadratic] {
        let background = structured_box::<3>([0.0; 3], [3.0; 3], [3; 3]).expect("a box");
        let mut setup = setup(fluid(background, 1.0, 0.1), 1e-2);
        on_sides(&mut setup, &["left", "right", "bottom", "front", "back"], || FluidBoundary::NoSlip);
        on_sides(&mut setup, &["top"], || FluidBoundary::Open {
            traction: Some(Arc::new(move |_, n, _| n * -pressure)),
            backflow: true,
        });
        let mesh = structured_box::<3>([0.8, 0.9, 0.7], [2.1, 2.2, 1.9], [2, 1, 1]).expect("a brick");
        let mut body = elastic("brick", mesh.clone(), 1.0, mu, lambda, Vector::zeros());
        body.solid = SolidMesh::of_order(mesh, order).expect("a mesh");
        body.options.initial_displacement = Some(Arc::new(move |x| x * (s - 1.0)));
        setup.bodies.push(body.body());
        for scheme in [Arc::new(ImplicitEuler) as Scheme, Arc::new(QuasiStatic)] {
            setup.scheme = scheme;
            let (state, _) = run(&setup, 1);
            let v = state.bodies[0].velocity().iter().map(|v| v.norm()).fold(0.0, f64::max);
            assert!(v < 1e-9, "{order:?}: {v:e}");
        }
    }
}

#[test]
fn fluid_at_rest_carries_a_neutral_body_of_curved_elements() {
    // A tilted ellipse of few elements. The pressure carries the weight of their volume, without a force to the side.
    let gravity = V::new(0.0, -981.0);
    let centre = P::new(1.0, 0.75);
    let tilted = |x: P| {
        let [along, across] = [(x[0] + x[1]) * 0.5_f64.sqrt(), (x[1] - x[0]) * 0.5_f64.sqrt()];
        centre + P::new(along - 0.4 * across, along + 0.4 * across) * 0.5_f64.sqrt()
    };
    let mesh = disk([0.0, 0.0], 0.5, 0.4);
    let round = mesh.mapped(|x| tilted(*x)).expect("a mesh");
    let ends = mesh.vertices().to_vec();
    let node = |[a, b]: [VertexId; 2], middle: P| {
        let [a, b] = [a, b].map(|end| ends[end.index()]);
        let is_edge = [a, b, (a + b) * 0.52].iter().all(|x| x.norm() > 0.47);
        if is_edge { tilted((a + b).normalize() * 0.5) } else { middle }
    };
    let mut body = elastic("ellipse", round.clone(), 1.0, 4e6, 6e6, gravity);
    body.solid = SolidMesh::curved(round, node).expect("a mesh");
    let mut setup = setup(fluid(background(), 1.0, 1.0), 0.01);
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| gravity));
    on_sides(&mut setup, &SIDES, || FluidBoundary::NoSlip);
    setup.bodies.push(body.body());
    setup.scheme = second_order(0.0);
    let (state, _) = run(&setup, 5);
    let balance = setup.bodies[0].balance(&state.bodies[0]).expect("a mass");
    let velocity = balance.momentum / balance.mass;
    assert!(velocity.norm() < 1e-3, "{velocity}");
    // The plane facets enclose less: with their buoyancy the body would sink with about 0.5 at the end.
    let inside = Placed::new(setup.bodies[0].surface(), setup.bodies[0].reference()).enclosed().volume;
    assert!(inside < 0.99 * balance.volume, "{inside} {}", balance.volume);
}

fn translating(dt: f64, u: V, n_steps: usize, make: Elements) {
    let mut setup = setup(fluid(background(), 1.3, 0.05), dt);
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(move |_| u));
    on_sides(&mut setup, &SIDES, || FluidBoundary::Velocity(Arc::new(move |_, _| u)));
    let mesh = disk([0.5, 0.55], 0.3, 0.09);
    let mut body = elastic("disk", mesh.clone(), 0.7, 2e3, 8e3, V::zeros());
    body.solid = make(mesh);
    body.options.initial_velocity = Some(Arc::new(move |_| u));
    setup.bodies.push(body.body());
    let (state, reports) = run(&setup, n_steps);
    let (error_u, error_p) = fluid_error(&setup, &state, |_| u, |_| 0.0);
    assert!(error_u < 1e-9 && error_p < 1e-9, "u {error_u:e}, p {error_p:e}");
    for (v, d) in state.bodies[0].velocity().iter().zip(state.bodies[0].displacement()) {
        assert!((v - u).norm() < 1e-9 && (d - u * state.time).norm() < 1e-9);
    }
    assert!(reports.iter().map(|r| wet_report(r).n_uncovered).sum::<usize>() > 0, "the motion uncovers dofs");
}

#[test]
fn solid_and_fluid_translate_together() {
    ELEMENTS.iter().for_each(|make| translating(0.02, V::new(1.0, 0.4), 12, *make));
}

#[test]
fn a_body_may_cross_several_cells_in_one_step() {
    // The body moves by 0.5 in one step, on cells of 0.13: it leaves more than half of the region that it covered.
    translating(0.5, V::new(1.0, 0.3), 2, ELEMENTS[0]);
}

/// Checks that a linear, divergence-free velocity and a linear pressure are found, with the body force that makes them
/// a steady solution.
fn linear_flow(
    mut setup: Setup<2>,
    exact_u: impl Fn(&P) -> V + Clone + Send + Sync + 'static,
    gradient: [[f64; 2]; 2],
    grad_p: V,
) {
    let rho = fluid_of(&mut setup).material.density;
    let exact_p = move |x: &P| 1.7 + grad_p.dot(x);
    let a = solver::mesh::Tensor::<2>::from_fn(|i, j| gradient[i][j]);
    let u = exact_u.clone();
    fluid_of(&mut setup).body_force = Some(Arc::new(move |x, _| a * u(x) * rho + grad_p));
    let u = exact_u.clone();
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(u));
    let stress = (a + a.transpose()) * fluid_of(&mut setup).material.viscosity;
    for side in ["left", "right", "bottom"] {
        let fluid = fluid_of(&mut setup);
        let tag = fluid.background.tag(side);
        if fluid.boundary.iter().all(|(given, _)| Some(*given) != tag) {
            let u = exact_u.clone();
            on_sides(&mut setup, &[side], || {
                let u = u.clone();
                FluidBoundary::Velocity(Arc::new(move |x, _| u(x)))
            });
        }
    }
    on_sides(&mut setup, &["top"], || FluidBoundary::Open {
        traction: Some(Arc::new(move |x, n, _| stress * n - n * exact_p(x))),
        backflow: false,
    });
    let (state, reports) = run(&setup, 3);
    let (error_u, error_p) = fluid_error(&setup, &state, exact_u, exact_p);
    assert!(error_u < 1e-9 && error_p < 1e-9, "u {error_u:e}, p {error_p:e}");
    assert!(reports.iter().all(|r| wet_report(r).cut.n_cut_cells > 10));
}

#[test]
fn linear_velocity_and_hydrostatic_pressure_around_a_prescribed_interface() {
    let u = |x: &P| V::new(0.3 + 0.5 * x[0] - 0.8 * x[1], -0.2 + 1.1 * x[0] - 0.5 * x[1]);
    let gradient = [[0.5, -0.8], [1.1, -0.5]];
    for (k, viscosity) in [0.01, 1.0].into_iter().enumerate() {
        let mut setup = setup(fluid(background(), 1.2, viscosity), 0.05);
        let shift = 0.031 * k as f64;
        let mesh = disk([0.9 + shift, 0.7 - shift], 0.37, 0.1);
        setup.bodies.push(prescribed(&mesh, |x, _| *x, move |x, _| u(x)));
        linear_flow(setup, u, gradient, V::new(-0.7, 2.5));
    }
    // The same while the interface moves through the mesh.
    let mut setup = setup(fluid(background(), 1.2, 0.1), 0.05);
    let mesh = structured_box::<2>([0.5, 0.4], [0.9, 0.83], [4, 4]).expect("a box");
    setup.bodies.push(prescribed(&mesh, |x, t| x + V::new(2.0 * t, t), move |x, _| u(x)));
    linear_flow(setup, u, gradient, V::new(-0.7, 2.5));
}

#[test]
fn the_tangential_traction_on_a_symmetry_line_is_free() {
    // u = (a x, -a y) has no normal velocity and no shear on x = 0.
    let u = |x: &P| V::new(0.6 * x[0], 0.4 - 0.6 * x[1]);
    let mut setup = setup(fluid(background(), 1.2, 0.3), 0.05);
    on_sides(&mut setup, &["left"], || FluidBoundary::symmetry(0));
    setup.bodies.push(prescribed(&disk([0.9, 0.7], 0.37, 0.1), |x, _| *x, move |x, _| u(x)));
    // The pressure of a symmetric flow is symmetric.
    linear_flow(setup, u, [[0.6, 0.0], [0.0, -0.6]], V::new(0.0, 2.5));
}

#[test]
fn parallel_flow_has_no_normal_traction() {
    // u = (a y, 0) leaves on the right, x = 2, where the pressure is that of `linear_flow`, zero.
    let u = |x: &P| V::new(0.6 * x[1], 0.0);
    let mut setup = setup(fluid(background(), 1.2, 0.3), 0.05);
    on_sides(&mut setup, &["right"], || FluidBoundary::parallel(0));
    setup.bodies.push(prescribed(&disk([0.9, 0.7], 0.37, 0.1), |x, _| *x, move |x, _| u(x)));
    linear_flow(setup, u, [[0.0, 0.6], [0.0, 0.0]], V::new(-0.85, 0.0));
}

#[test]
fn an_enclosed_pocket_has_a_pressure_of_mean_zero() {
    let u = |x: &P| V::new(0.5 * x[0] - 0.8 * x[1], 1.1 * x[0] - 0.5 * x[1]);
    let a = solver::mesh::Tensor::<2>::new(0.5, -0.8, 1.1, -0.5);
    let mut setup = setup(fluid(background(), 1.0, 0.2), 0.05);
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(u));
    fluid_of(&mut setup).body_force = Some(Arc::new(move |x, _| a * u(x) + V::new(0.0, -3.0)));
    on_sides(&mut setup, &SIDES, || FluidBoundary::Velocity(Arc::new(move |x, _| u(x))));
    setup.bodies.push(prescribed(&disk([0.9, 0.7], 0.37, 0.1), |x, _| *x, move |x, _| u(x)));
    let (state, reports) = run(&setup, 2);
    assert_eq!(wet_report(&reports[0]).n_pockets, 1);
    let shift = wet(&state).pressure[0] + 3.0 * background().vertex(wet(&state).space.vertex(0))[1];
    let (error_u, error_p) = fluid_error(&setup, &state, u, |x| shift - 3.0 * x[1]);
    assert!(error_u < 1e-9 && error_p < 1e-8, "u {error_u:e}, p {error_p:e}");
    // The mean of -3 y over the box without the polygon, which is symmetric about its centre.
    let fluid = wet(&state).cut.fluid_volume();
    let mean = -3.0 * (3.0 * 0.75 - (3.0 - fluid) * 0.7) / fluid;
    assert!((shift + mean).abs() < 1e-4, "{shift} {mean}");
}

#[test]
fn a_clamped_body_does_not_fix_the_pressure() {
    // Four walls and a body that cannot move: only the mean fixes the constant.
    let mut setup = setup(fluid(background(), 1.0, 0.1), 0.05);
    fluid_of(&mut setup).body_force = Some(Arc::new(|_, _| V::new(0.0, -2.0)));
    on_sides(&mut setup, &SIDES, || FluidBoundary::NoSlip);
    let mut body = elastic("disk", disk([0.91, 0.73], 0.4, 0.11), 1.0, 2e3, 8e3, V::zeros());
    let vertices = (0..body.solid.mesh().n_vertices()).map(solver::mesh::VertexId::new).collect();
    body.options.supports.push(Support { vertices, kind: SupportKind::Clamped });
    setup.bodies.push(body.body());
    let (state, reports) = run(&setup, 1);
    assert_eq!(wet_report(&reports[0]).n_pockets, 1);
    let shift = wet(&state).pressure[0] + 2.0 * background().vertex(wet(&state).space.vertex(0))[1];
    let (u, p) = fluid_error(&setup, &state, |_| V::zeros(), |x| shift - 2.0 * x[1]);
    assert!(u < 1e-9 && p < 1e-9, "u {u:e}, p {p:e}");
    // Tractions have the constant of the pressure.
    for (piece, on) in wet(&state).cut.interface().iter().zip(&wet_report(&reports[0]).tractions) {
        let exact = piece.normal * (2.0 * on.middle[1] - shift);
        assert!((on.fluid - exact).norm() < 1e-8, "{} {exact}", on.fluid);
    }
}

#[test]
fn every_pocket_has_its_own_mean() {
    // A wall across the box makes two pockets, with the same linear pressure up to their constants.
    let mut setup = setup(fluid(background(), 1.0, 0.1), 0.05);
    fluid_of(&mut setup).body_force = Some(Arc::new(|_, _| V::new(3.0, 0.0)));
    on_sides(&mut setup, &SIDES, || FluidBoundary::NoSlip);
    let wall = structured_box::<2>([1.21, -0.1], [1.38, 1.6], [1, 9]).expect("a wall");
    setup.bodies.push(prescribed(&wall, |x, _| *x, |_, _| V::zeros()));
    let (state, reports) = run(&setup, 1);
    let background = background();
    assert_eq!(wet_report(&reports[0]).n_pockets, 2);
    let middle = |x: &P| if x[0] < 1.3 { 0.605 } else { 1.69 };
    let mut worst = 0.0_f64;
    for part in wet(&state).cut.all_parts() {
        let left = background.simplex(wet(&state).cut.part_cell(part)).centroid()[0] < 1.295;
        for &dof in wet(&state).space.dofs(part) {
            let x = background.vertex(wet(&state).space.vertex(dof));
            let centre = middle(&P::new(if left { 0.0 } else { 2.0 }, 0.0));
            worst = worst.max((wet(&state).pressure[dof as usize] - 3.0 * (x[0] - centre)).abs());
        }
    }
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn uncovered_fluid_continues_an_affine_flow() {
    // Two disks move with the fluid around them, then both jump by 1.6 cells.
    let u = |x: &P| V::new(0.3 + 0.5 * x[0] - 0.8 * x[1], -0.2 + 1.1 * x[0] - 0.5 * x[1]);
    let jump = V::new(0.05, 0.2);
    let mut setup = setup(fluid(background(), 1.0, 0.1), 0.05);
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(u));
    on_sides(&mut setup, &SIDES, open);
    for (centre, radius) in [([0.5, 0.5], 0.3), ([1.5, 0.5], 0.25)] {
        let mut body = elastic("disk", disk(centre, radius, 0.08), 1.0, 2e3, 8e3, V::zeros());
        body.options.initial_velocity = Some(Arc::new(move |x| u(&(x + jump))));
        setup.bodies.push(body.body());
    }
    let mut moved = solver::State::initial(&setup).expect("a cut");
    for body in &mut moved.bodies {
        body.level.displacement.iter_mut().for_each(|d| *d = jump);
    }
    let (positions, background) = (setup.positions(&moved.bodies), background());
    let cut = CutMesh::overlay(&background, &setup.surfaces(&positions), &OverlayOptions::new()).expect("a cut");
    let space = XfemSpace::new(&background, &cut);
    let sources = Sources::between(&background, &wet(&moved).cut, &wet(&moved).space, &cut, &space);
    assert!(sources.n_uncovered() > 5, "{}", sources.n_uncovered());
    // The starting guess of a step is the history on its space.
    let step = Step::prepare(&setup, &moved, moved.step_time(&setup, setup.dt)).expect("a cut");
    let velocity = step.layout.fields().next().expect("the velocity");
    let history: Vec<V> = step.layout.values(velocity, &step.guess()).map(V::from).collect();
    for (value, vertex) in history.iter().zip(space.vertices()) {
        let x = background.vertex(*vertex);
        assert!((value - u(&x)).norm() < 1e-8, "{x} {value}");
    }
}
