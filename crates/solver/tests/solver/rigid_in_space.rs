//! Rigid bodies in three dimensions, in contact and in the fluid, against exact solutions.

use std::sync::Arc;

use crate::fixture::*;
use solid_rigid::modes::rotated_by;
use solver::FluidBoundary;
use solver::mesh::generate::structured_box;
use solver::mesh::{Point, SimplexMesh, Tensor, Vector};

#[test]
fn a_brick_that_lands_on_a_corner_is_turned_by_the_impulse() {
    // The edges of the brick, and its turn.
    let (edges, density) = (Vector::<3>::new(1.0, 0.6, 0.4), 2.0);
    let turn = rotated_by::<3>(&[0.5, -0.7, 0.2]);
    let half: [f64; 3] = (edges * 0.5).into();
    let straight = structured_box::<3>(half.map(|h| -h), half, [1, 1, 1]).expect("a box");
    let arms: Vec<Vector<3>> = straight.vertices().iter().map(|x| turn * x).collect();
    let arm = *arms.iter().min_by(|a, b| a[2].total_cmp(&b[2])).expect("a corner");
    let centre = Point::<3>::new(0.4, 0.7, 1e-4 - arm[2]);
    let cells = straight.cells().flat_map(|cell| straight.cell(cell)).copied().collect();
    let mesh = SimplexMesh::new(arms.iter().map(|arm| centre + arm).collect(), cells).expect("a brick");
    let mut body = rigid("brick", &mesh, density, Vector::<3>::zeros());
    let start = Vector::<3>::new(0.3, -0.2, -1.0);
    body.initial_velocity = start;
    let mut setup = dry(vec![Arc::new(body)], 2e-6);
    setup.contacts.push(contact(&setup.bodies, 0, (1e7, 0.0, 1.0), ground()));
    let (state, reports) = run(&setup, 4000);
    let active: Vec<usize> = (0..reports.len()).filter(|&k| reports[k].contacts[0].is_active()).collect();
    assert!(active.len() > 100 && !active.contains(&(reports.len() - 1)), "{}", active.len());

    // A frictionless elastic impact: the corner's normal velocity is reversed by an impulse along the normal.
    let mass = density * edges.product();
    let squares = edges.component_mul(&edges);
    let inertia = Vector::<3>::from_fn(|a, _| mass / 12.0 * (squares.sum() - squares[a]));
    let normal = Vector::<3>::z();
    let spun = turn * (turn.transpose() * arm.cross(&normal)).component_div(&inertia);
    let impulse = 2.0 / (mass.recip() + spun.cross(&arm)[2]);
    let motion = motion(&state, 0);
    let (velocity, spin) = (start + normal * (impulse / mass), spun * impulse);
    assert!((motion.velocity - velocity).norm() < 0.03 * velocity.norm(), "{} {velocity}", motion.velocity);
    assert!((Vector::<3>::from(motion.spin) - spin).norm() < 0.03 * spin.norm(), "{:?} {spin}", motion.spin);
    // What the plane cannot change.
    assert!((motion.velocity - start).xy().norm() < 1e-12 && motion.angular_momentum[2].abs() < 1e-12);
    let given: Vector<3> = reports.iter().map(|r| r.contacts[0].force * setup.dt).sum();
    assert!((given - (motion.velocity - start) * mass).norm() < 1e-9);
}

#[test]
fn a_neutral_body_turns_with_the_fluid() {
    // u = ω × (x - c) about an axis askew.
    let (omega, centre, dt) = (Vector::<3>::new(1.3, -0.7, 2.1), Point::<3>::new(1.02, 0.97, 1.05), 0.03);
    let brick = structured_box::<3>([0.72, 0.72, 0.65], [1.32, 1.22, 1.45], [1, 1, 1]).expect("a box");
    let mut body = rigid("brick", &brick, 1.3, Vector::<3>::zeros());
    body.initial_spin = omega.into();
    // With the inertia of a ball: it turns steadily without a torque about any axis.
    let mass = &mut body.mass;
    mass.second_moment = Tensor::<3>::identity() * (mass.second_moment.trace() / 3.0);
    let background = structured_box::<3>([0.0; 3], [2.0; 3], [5, 5, 5]).expect("a box");
    let u: solver::body::TimeField<3> = Arc::new(move |x, _| omega.cross(&(x - centre)));
    let mut setup = setup(fluid(background, 1.3, 0.7), dt);
    fluid_of(&mut setup).convection = None;
    fluid_of(&mut setup).initial_velocity = Some(Arc::new(move |x| omega.cross(&(x - centre))));
    setup.bodies.push(Arc::new(body));
    on_sides(&mut setup, &["left", "right", "front", "back", "bottom", "top"], || FluidBoundary::Velocity(u.clone()));
    let (state, _) = run(&setup, 2);
    let motion = motion(&state, 0);
    assert!((Vector::<3>::from(motion.spin) - omega).norm() < 1e-8 && motion.velocity.norm() < 1e-8);
    let turned = rotated_by::<3>(&(omega * state.time).into());
    assert!((motion.rotation - turned).norm() < 1e-8);
    for (k, &vertex) in wet(&state).space.vertices().iter().enumerate() {
        let exact = u(&fluid_of(&mut setup).background.vertex(vertex), 0.0);
        assert!((wet(&state).velocity[k] - exact).norm() < 1e-7 && wet(&state).pressure[k].abs() < 1e-5);
    }
}
