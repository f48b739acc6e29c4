//! Mass properties and free motion of rigid bodies against closed forms.

use algebra::time::{GeneralisedAlpha, ImplicitEuler, QuasiStatic, TimeScheme};
use algebra::{BlockLayout, Constraints, Equations, NewtonSettings, Workspace, check_tangent, newton};
use body::{Body, BodyState, BodyStep, StepTime};
use mesh::{BoundaryMesh, ParameterError, Placed, Point, Tensor, Vector, VertexId};
use solid_rigid::modes::rotated_by;
use solid_rigid::{Error, MassProperties, RigidBody, RigidMotion, Spin};

/// Returns a brick with sides a, b, c, turned and shifted.
fn brick(size: [f64; 3], turned_by: Spin, centre: Point<3>) -> (BoundaryMesh<3>, Vec<Point<3>>) {
    let rotation = rotated_by::<3>(&turned_by);
    let corner = |i: usize| {
        let sign = |axis: usize| if i >> axis & 1 == 1 { 0.5 } else { -0.5 };
        centre + rotation * Vector::<3>::from_fn(|axis, _| sign(axis) * size[axis])
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]);
    (BoundaryMesh::from_facets(triangles.map(VertexId).collect()), (0..8).map(corner).collect())
}

#[test]
fn mass_centre_and_inertia_of_a_brick_are_exact_in_any_position() {
    let (size, density) = ([1.0, 2.0, 3.0], 1.7);
    let (turned_by, centre) = ([0.3, -0.8, 1.1], Point::<3>::new(5.0, -2.0, 0.5));
    let (surface, corners) = brick(size, turned_by, centre);
    let mass = MassProperties::of_surface(&Placed::new(&surface, &corners), density).unwrap();
    assert!((mass.mass - 6.0 * density).abs() < 1e-12);
    assert!((mass.centre - centre).norm() < 1e-12);
    // In its own axes the inertia is diagonal, with the entries m (b² + c²)/12 and so on.
    let inertia = mass.inertia(&rotated_by::<3>(&turned_by).transpose());
    for (k, row) in inertia.iter().enumerate() {
        for (l, found) in row.iter().enumerate() {
            let [p, q] = [size[(k + 1) % 3], size[(k + 2) % 3]];
            let expected = if k == l { mass.mass * (p * p + q * q) / 12.0 } else { 0.0 };
            assert!((found - expected).abs() < 1e-11, "{k} {l}: {found} {expected}");
        }
    }
}

#[test]
fn what_encloses_nothing_is_refused() {
    let (surface, corners) = brick([1.0, 1.0, 0.0], [0.0; 3], Point::zeros());
    let flat = MassProperties::of_surface(&Placed::new(&surface, &corners), 1.0);
    assert!(matches!(flat, Err(Error::Volume { .. })));
    let (surface, corners) = brick([1.0; 3], [0.0; 3], Point::zeros());
    let massless = MassProperties::of_surface(&Placed::new(&surface, &corners), 0.0);
    assert!(matches!(massless, Err(Error::Parameter(ParameterError { what: "density", .. }))));
}

/// Solves a step of a body without forces, and calls `test` with the step, its layout and its state. The contribution
/// is linear, so one iteration of Newton's method suffices.
fn in_step<R>(
    body: &RigidBody<3>,
    before: &RigidMotion<3>,
    time: &StepTime,
    test: impl FnOnce(&dyn BodyStep<3>, &BlockLayout, &[f64]) -> R,
) -> R {
    let start = BodyState { inner: before.to_numbers(), ..body.initial() };
    let mut layout = BlockLayout::new();
    let step = body.step(&start, time, &mut layout);
    let mut constraints = Constraints::new();
    step.constrain(&layout, &mut constraints);
    let equations =
        Equations { layout: &layout, contributions: step.contributions(&layout), constraints: &constraints };
    let mut x = vec![0.0; layout.len()];
    step.guess(&layout, &mut x);
    assert!(equations.contributions.iter().all(|part| check_tangent(part.as_ref(), &x, 1e-5) < 1e-9));
    newton(&equations, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-13)).expect("a linear system");
    test(step.as_ref(), &layout, &x)
}

/// Advances a body without forces by one step of implicit Euler.
fn free_step(body: &RigidBody<3>, before: &RigidMotion<3>, dt: f64) -> RigidMotion<3> {
    let time = StepTime::new(&ImplicitEuler, dt, dt, true);
    in_step(body, before, &time, |step, layout, x| body.motion(&step.end(layout, x)))
}

/// Between the positions at which contact acts a body turns by `ω Δt`, and keeps its size, with large angles too.
#[test]
fn contact_acts_on_points_that_turn() {
    let (surface, corners) = brick([1.0; 3], [0.1, -0.3, 0.2], Point::zeros());
    let body = RigidBody::new("cube", surface, corners.clone(), 1.0, Vector::zeros()).unwrap();
    let (spin, dt) = ([2.0, -1.0, 1.5], 0.2);
    let start = RigidMotion::initial(&body.mass, Vector::<3>::new(3.0, 0.0, 1.0), spin);
    let turn = rotated_by::<3>(&spin.map(|omega| omega * dt));
    let schemes: [&dyn TimeScheme; 2] = [&ImplicitEuler, &GeneralisedAlpha::new(0.0).expect("a factor")];
    for scheme in schemes {
        in_step(&body, &start, &StepTime::new(scheme, dt, dt, false), |step, layout, x| {
            let surface = step.surface();
            let end = |k: usize| surface.position_at(VertexId::new(k), layout, x);
            for k in 1..corners.len() {
                let (reference, before) = (corners[k] - corners[0], surface.start[k] - surface.start[0]);
                let after = end(k) - end(0);
                assert!((before.norm() - reference.norm()).abs() < 1e-14, "{scheme:?}: {before}");
                assert!((turn * before - after).norm() < 1e-14, "{scheme:?}: {before} {after}");
            }
        });
    }
}

/// Without inertia the spin of the step before predicts nothing: a body that stops has no gap from an arc.
#[test]
fn without_inertia_points_are_where_a_body_stops() {
    let (surface, corners) = brick([1.0; 3], [0.1, -0.3, 0.2], Point::zeros());
    let body = RigidBody::new("cube", surface, corners.clone(), 1.0, Vector::zeros()).unwrap();
    let start = RigidMotion::initial(&body.mass, Vector::<3>::zeros(), [0.0, 0.0, 5.0]);
    let state = BodyState { inner: start.to_numbers(), ..body.initial() };
    let mut layout = BlockLayout::new();
    let step = body.step(&state, &StepTime::new(&QuasiStatic, 0.2, 0.2, false), &mut layout);
    let at_rest = vec![0.0; layout.len()];
    for (k, corner) in corners.iter().enumerate() {
        let end = step.surface().position_at(VertexId::new(k), &layout, &at_rest);
        assert!((end - corner).norm() < 1e-14, "{end} {corner}");
    }
}

#[test]
fn a_symmetric_top_precesses_at_its_rate() {
    // J₁ = J₂ = 5, J₃ = 2 (mass 12): the axis turns about L with the rate |L|/J₁.
    let (surface, corners) = brick([1.0, 1.0, 2.0], [0.0; 3], Point::zeros());
    let body = RigidBody::new("top", surface, corners, 6.0, Vector::zeros()).unwrap();
    let mass = body.mass;
    let inertia = mass.inertia(&Tensor::identity());
    assert!((inertia[0][0] - 5.0).abs() < 1e-12 && (inertia[2][2] - 2.0).abs() < 1e-12);
    let start = RigidMotion::initial(&mass, Vector::<3>::new(1.0, 0.0, 0.0), [0.4, 0.0, 3.0]);
    let momentum = Vector::<3>::from(start.angular_momentum);
    let time = 2.0;
    let error = |n_steps: usize| {
        let dt = time / n_steps as f64;
        let end = (0..n_steps).fold(start, |motion, _| free_step(&body, &motion, dt));
        assert!((Vector::<3>::from(end.angular_momentum) - momentum).norm() < 1e-12);
        assert!((end.centre - Vector::<3>::new(time, 0.0, 0.0)).norm() < 1e-12);
        assert!((end.rotation.transpose() * end.rotation - Tensor::identity()).norm() < 1e-12);
        let precession = rotated_by::<3>(&(momentum * (time / inertia[0][0])).into());
        (end.rotation.column(2) - precession.column(2)).norm()
    };
    let errors = [200, 400, 800].map(error);
    assert!(errors[2] < 2e-3, "{errors:?}");
    let order = (errors[1] / errors[2]).log2();
    assert!((order - 1.0).abs() < 0.1, "order {order}: {errors:?}");
}
