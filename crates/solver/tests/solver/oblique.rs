//! Conditions on oblique planes: a problem and the same problem turned by an angle.

use std::sync::Arc;

use crate::fixture::*;
use solid_svk::SupportKind;
use solver::algebra::time::ImplicitEuler;
use solver::mesh::generate::{BallOptions, Size, graded_box, half_ball, structured_box};
use solver::mesh::nalgebra::{Rotation2, Rotation3, Vector3};
use solver::mesh::{SimplexMesh, Tensor, Vector};
use solver::{FluidBoundary, State, StepReport};

/// Time schemes.
const SCHEMES: [fn() -> Scheme; 2] = [|| Arc::new(ImplicitEuler), || second_order(0.5)];

/// Largest difference of a turned flow, relative to values of order one.
const SAME: f64 = 1e-10;

fn turned<const D: usize>(mesh: &SimplexMesh<D>, turn: Tensor<D>) -> SimplexMesh<D> {
    mesh.mapped(|x| turn * x).expect("a mesh")
}

/// Largest energy that no line of the ledger explains, relative to its largest line: the tolerance of Newton's method
/// is `1e-11`.
const CLOSED: f64 = 1e-9;

/// Checks that the lines of the ledger explain the change of the energy in every step: reactions of planes do no work.
fn check_ledgers(reports: &[StepReport<2>]) {
    for ledger in reports.iter().map(|report| &report.ledger) {
        assert!(ledger.change.abs() > 1e-4 * ledger.largest_line(), "{ledger:?}");
        for left in [ledger.defect(), ledger.other] {
            assert!(left.abs() < CLOSED * ledger.largest_line(), "{left} {ledger:?}");
        }
    }
}

/// Returns the flow around an elastic disk, which begins with a velocity across the lines of symmetry.
///
/// Two lines of symmetry, a line that the flow crosses at right angles, and a moving wall meet in corners.
fn with_disk(turn: Tensor<2>, scheme: Scheme) -> State<2> {
    let background = graded_box::<2>([0.0, 0.0], [2.0, 1.5], &Size::uniform(0.2)).expect("a box");
    let mut setup = setup(fluid(turned(&background, turn), 1.2, 0.1), 0.02);
    setup.scheme = scheme;
    fluid_of(&mut setup).body_force = Some(Arc::new(move |x, t| {
        let x = turn.transpose() * x;
        turn * V::new(x[1] * x[1] + t, x[0] - 0.5)
    }));
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(move |_| turn * V::new(0.3, -0.2)));
    let normal = |axis| turn * V::ith(axis, 1.0);
    on_sides(&mut setup, &["left"], || FluidBoundary::Symmetry { normal: -normal(0) });
    on_sides(&mut setup, &["bottom"], || FluidBoundary::Symmetry { normal: normal(1) });
    on_sides(&mut setup, &["right"], || FluidBoundary::Parallel { normal: normal(0), traction: None });
    on_sides(&mut setup, &["top"], || FluidBoundary::Velocity(Arc::new(move |_, t| turn * V::new(t, 0.0))));
    let disk = disk([0.6, 0.7], 0.35, 0.15);
    let gravity = turn * V::new(0.4, -1.0);
    let mut disk = elastic("disk", turned(&disk, turn), 2.0, 50.0, 100.0, gravity);
    disk.options.initial_velocity = Some(Arc::new(move |_| turn * V::new(0.3, -0.2)));
    setup.bodies.push(disk.body());
    let (state, reports) = run(&setup, 4);
    check_ledgers(&reports);
    state
}

#[test]
fn a_turned_problem_has_the_turned_solution() {
    for scheme in SCHEMES {
        let straight = with_disk(Tensor::identity(), scheme());
        for angle in [0.6, 2.2] {
            let turn = Rotation2::new(angle).into_inner();
            let state = with_disk(turn, scheme());
            let (flow, same) = (wet(&state), wet(&straight));
            assert_eq!(flow.velocity.len(), same.velocity.len());
            for (k, (u, v)) in flow.velocity.iter().zip(&same.velocity).enumerate() {
                assert!((u - turn * v).norm() < SAME, "{u} {}", turn * v);
                assert!((flow.pressure[k] - same.pressure[k]).abs() < 1e2 * SAME);
            }
            let displacements = state.bodies[0].displacement().iter().zip(straight.bodies[0].displacement());
            assert!(displacements.clone().all(|(d, e)| (d - turn * e).norm() < SAME));
            assert!(displacements.clone().any(|(d, _)| d.norm() > 1e-3), "the disk moves");
        }
        let background = graded_box::<2>([0.0, 0.0], [2.0, 1.5], &Size::uniform(0.2)).expect("a box");
        let on = |axis: usize, at: f64| {
            let vertices = wet(&straight).space.vertices().iter().zip(&wet(&straight).velocity);
            let on_line: Vec<V> = vertices
                .filter(|(v, _)| {
                    let x = background.vertex(**v);
                    (x[axis] - at).abs() < 1e-12 && x[1] < 1.5
                })
                .map(|(_, u)| *u)
                .collect();
            on_line
        };
        // The moving wall is in force at its ends.
        assert!(on(0, 0.0).iter().all(|u| u[0].abs() < 1e-14) && on(0, 0.0).iter().any(|u| u[1].abs() > 1e-3));
        assert!(on(1, 0.0).iter().all(|u| u[1].abs() < 1e-14) && on(1, 0.0).iter().any(|u| u[0].abs() > 1e-3));
        assert!(on(0, 2.0).iter().all(|u| u[1].abs() < 1e-14) && on(0, 2.0).iter().any(|u| u[0].abs() > 1e-3));
    }
}

/// Checks fluid at rest on a plane without friction, under a weight across it, in the plane and in space.
fn rests_on_a_plane_of_symmetry<const D: usize>(turn: Tensor<D>, scheme: Scheme) {
    let background = structured_box::<D>([0.0; D], [1.0; D], [3; D]).expect("a box");
    let up: Vector<D> = turn.column(D - 1).into_owned();
    let mut setup = setup(fluid(turned(&background, turn), 2.0, 1e-3), 0.1);
    setup.scheme = scheme;
    fluid_of(&mut setup).body_force = Some(Arc::new(move |_, t| up * -(20.0 + t)));
    on_sides(&mut setup, &["bottom"], || FluidBoundary::Symmetry { normal: up });
    let sides: &[&str] = if D == 2 { &["left", "right"] } else { &["left", "right", "front", "back"] };
    on_sides(&mut setup, sides, || FluidBoundary::NoSlip);
    let (state, reports) = run(&setup, 3);
    let fastest = wet(&state).velocity.iter().map(|u| u.norm()).fold(0.0, f64::max);
    assert!(fastest < 1e-9, "{fastest:e}");
    let highest = wet(&state).pressure.iter().copied().fold(0.0, f64::max);
    let weight = 20.0 + wet(&state).pressure_time;
    assert!((highest - weight).abs() < 1e-8 * weight, "{highest} {weight}");
    let is_closed = |ledger: &solver::Ledger| ledger.defect().abs() < 1e-9 && ledger.other.abs() < 1e-9;
    assert!(reports.iter().all(|report| is_closed(&report.ledger)));
}

#[test]
fn fluid_rests_on_a_plane_of_symmetry_under_its_weight() {
    for scheme in SCHEMES {
        rests_on_a_plane_of_symmetry::<2>(Tensor::identity(), scheme());
        rests_on_a_plane_of_symmetry::<2>(Rotation2::new(0.6).into_inner(), scheme());
        rests_on_a_plane_of_symmetry::<3>(Tensor::identity(), scheme());
    }
}

#[test]
fn a_difference_of_pressure_accelerates_the_fluid_between_planes_of_symmetry() {
    // ρ du/dt = (3 - 1)/2 along a channel of the length 2, and no traction for the kinetic energy that flows in.
    let (density, gain) = (1.2, 1.0);
    for angle in [0.0, 0.6] {
        let turn = Rotation2::new(angle).into_inner();
        let background = graded_box::<2>([0.0, 0.0], [2.0, 1.5], &Size::uniform(0.4)).expect("a box");
        let mut setup = setup(fluid(turned(&background, turn), density, 0.1), 0.02);
        let [along, across] = [0, 1].map(|axis| turn * V::ith(axis, 1.0));
        on_sides(&mut setup, &["bottom", "top"], || FluidBoundary::Symmetry { normal: across });
        for (side, pressure) in [("left", 3.0), ("right", 1.0)] {
            on_sides(&mut setup, &[side], || FluidBoundary::Parallel {
                normal: along,
                traction: Some(Arc::new(move |_, n, t| n * -(pressure + t))),
            });
        }
        let (state, reports) = run(&setup, 4);
        check_ledgers(&reports);
        let speed = gain / density * 0.08;
        assert!(
            wet(&state).velocity.iter().all(|u| (u - along * speed).norm() < SAME),
            "{:?}",
            wet(&state).velocity[0]
        );
    }
}

/// Returns an elastic half disk in vacuum that falls along its line of symmetry, pulled away from it.
fn half_disk(turn: Tensor<2>, scheme: Scheme) -> State<2> {
    let options = BallOptions { area_preserving: false };
    let mesh = half_ball::<2>([0.0, 0.7], 0.35, 0.15, &options).expect("a half disk");
    let mut disk = elastic("disk", turned(&mesh, turn), 2.0, 50.0, 100.0, turn * V::new(4.0, -1.0));
    disk.options.initial_velocity = Some(Arc::new(move |_| turn * V::new(0.3, -0.2)));
    disk.support("left", SupportKind::Symmetry { normal: turn * -V::ith(0, 1.0) });
    let mut setup = dry(vec![disk.body()], 0.02);
    setup.scheme = scheme;
    let (state, reports) = run(&setup, 4);
    check_ledgers(&reports);
    state
}

#[test]
fn a_support_on_an_oblique_line_holds_across_it_only() {
    for scheme in SCHEMES {
        let straight = half_disk(Tensor::identity(), scheme());
        let displaced = straight.bodies[0].displacement();
        assert!(displaced.iter().any(|d| d[0].abs() > 1e-3) && displaced.iter().all(|d| d[1] < -1e-3));
        for angle in [0.6, 2.2] {
            let turn = Rotation2::new(angle).into_inner();
            let state = half_disk(turn, scheme());
            let displacements = state.bodies[0].displacement().iter().zip(displaced);
            displacements.for_each(|(d, e)| assert!((d - turn * e).norm() < SAME, "{d} {}", turn * e));
        }
    }
}

#[test]
fn lines_of_symmetry_at_any_angle_stop_the_flow_where_they_meet() {
    // A parallelogram: the left and the bottom side meet at 63 degrees.
    let square = structured_box::<2>([0.0; 2], [1.0; 2], [5; 2]).expect("a box");
    let background = square.mapped(|x| V::new(x[0] + 0.5 * x[1], x[1])).expect("a mesh");
    let normal = V::new(1.0, -0.5).normalize();
    let mut setup = setup(fluid(background.clone(), 1.0, 0.1), 0.1);
    fluid_of(&mut setup).body_force = Some(Arc::new(|x, _| V::new(1.0, 2.0 * x[0])));
    on_sides(&mut setup, &["left"], || FluidBoundary::Symmetry { normal });
    on_sides(&mut setup, &["bottom"], || FluidBoundary::symmetry(1));
    on_sides(&mut setup, &["right", "top"], || FluidBoundary::Open { traction: None, backflow: true });
    let (state, _) = run(&setup, 2);
    for (vertex, u) in wet(&state).space.vertices().iter().zip(&wet(&state).velocity) {
        let x = background.vertex(*vertex);
        let (on_left, on_bottom) = ((x[0] - 0.5 * x[1]).abs() < 1e-12, x[1] == 0.0);
        assert!(!on_left || u.dot(&normal).abs() < 1e-14);
        assert!(!on_bottom || u[1].abs() < 1e-14);
        assert_eq!(u.norm() < 1e-14, on_left && on_bottom, "{x} {u}");
    }
}

#[test]
fn planes_of_symmetry_in_space_may_be_turned() {
    type Turn = Tensor<3>;
    let flow = |turn: Turn| {
        let box_mesh = structured_box::<3>([0.0; 3], [1.0, 0.9, 0.8], [2; 3]).expect("a box");
        let mut setup = setup(fluid(turned(&box_mesh, turn), 1.0, 0.1), 0.1);
        let force = Vector::<3>::new(0.5, 1.0, -0.7);
        fluid_of(&mut setup).body_force = Some(Arc::new(move |x, _| {
            let x = turn.transpose() * x;
            turn * force.component_mul(&Vector::<3>::new(x[1], x[2], x[0]))
        }));
        for (axis, side) in ["left", "front", "bottom"].into_iter().enumerate() {
            let tag = fluid_of(&mut setup).background.tag(side).expect("a side");
            let normal = fluid_of(&mut setup).background.tag_normal(tag).expect("a plane");
            assert!((normal.dot(&(turn * Vector::ith(axis, 1.0))).abs() - 1.0).abs() < 1e-12);
            on_sides(&mut setup, &[side], || FluidBoundary::Symmetry { normal });
        }
        on_sides(&mut setup, &["right", "top", "back"], || FluidBoundary::Open { traction: None, backflow: true });
        run(&setup, 2).0
    };
    let straight = flow(Turn::identity());
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.6)).into_inner();
    let state = flow(turn);
    for (u, v) in wet(&state).velocity.iter().zip(&wet(&straight).velocity) {
        assert!((u - turn * v).norm() < SAME, "{u} {}", turn * v);
    }
    // The corner of three planes, and a line of two.
    let speeds: Vec<f64> = wet(&state).velocity.iter().map(|u| u.norm()).collect();
    assert_eq!(speeds.iter().filter(|speed| **speed < 1e-14).count(), 1);
}
