//! Bodies in degenerate positions: corners on vertices, edges and faces of the background, or shifted from them by tiny
//! distances, in 2D and 3D.

mod bodies;
mod cases;
mod identities;

use bodies::TestBody;
use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use mesh::generate::structured_box;
use mesh::{Point, SimplexMesh};
use proptest::prelude::*;

/// Cells along each side of the background, the unit cube.
const N: usize = 3;

fn grid<const D: usize>() -> SimplexMesh<D> {
    structured_box::<D>([0.0; D], [1.0; D], [N; D]).expect("a box")
}

/// Generates points on a vertex, an edge, a face or in the inside of a cell, shifted. Edges of cells are sums
/// of unit vectors.
fn place<const D: usize>() -> impl Strategy<Value = Point<D>> {
    let fraction = prop_oneof![3 => Just(0.0), 1 => Just(0.5), 1 => Just(1.0 / 3.0), 1 => 0.0..1.0_f64];
    let direction = prop::collection::vec(0..2_u8, D);
    let steps = prop::collection::vec((fraction, direction), 2);
    let vertex = prop::collection::vec(0..N as u8, D);
    (vertex, steps, prop::collection::vec(cases::shift(), D), prop::bool::ANY).prop_map(
        |(vertex, steps, shifts, all)| {
            Point::<D>::from_fn(|k, _| {
                let along: f64 = steps.iter().map(|(t, d)| t * f64::from(d[k])).sum();
                let shift = if all || k == 0 { shifts[k] } else { 0.0 };
                ((f64::from(vertex[k]) + along) / N as f64 + 0.3 * shift).clamp(0.0, 1.0)
            })
        },
    )
}

/// Checks identities in every order of the bodies, and the volume of their union if it is known.
fn check<const D: usize>(background: &SimplexMesh<D>, bodies: &[&TestBody<D>], union: Option<f64>) {
    let mut placed: Vec<_> = bodies.iter().map(|body| body.placed()).collect();
    let mut fluid = Vec::new();
    for _ in 0..bodies.len() {
        let cut = CutMesh::overlay(background, &placed, &OverlayOptions::new()).expect("sound surfaces");
        check_identities(background, &cut);
        fluid.push(cut.fluid_volume());
        placed.rotate_left(1);
    }
    let domain = background.volume();
    let expected = union.map_or(fluid[0], |union| domain - union);
    assert!(fluid.iter().all(|v| (v - expected).abs() < 1e-12 * domain), "fluid {fluid:?}, expected {expected}");
}

fn check_simplex<const D: usize>(corners: Vec<Point<D>>) {
    let body = TestBody::simplex(corners);
    if body.volume() > 1e-10 {
        check(&grid(), &[&body], Some(body.volume()));
    }
}

/// Checks two simplices with a common facet, on different sides of it or on the same side.
fn check_pair<const D: usize>(corners: &[Point<D>]) {
    let first = TestBody::simplex(corners[..=D].to_vec());
    let second = TestBody::simplex(corners[1..].to_vec());
    if first.volume().min(second.volume()) < 1e-10 {
        return;
    }
    let side = |of: &Point<D>| {
        let mut points = corners[1..=D].to_vec();
        points.insert(0, *of);
        mesh::Simplex::new(&points).volume()
    };
    let (a, b) = (side(&corners[0]), side(&corners[D + 1]));
    let touch = a * b < 0.0 && a.abs().min(b.abs()) > 1e-10;
    check(&grid(), &[&first, &second], touch.then(|| first.volume() + second.volume()));
}

fn check_boxes<const D: usize>(c: &[Point<D>]) {
    let ((la, ha), (lb, hb)) = ((c[0].inf(&c[1]), c[0].sup(&c[1])), (c[2].inf(&c[3]), c[2].sup(&c[3])));
    let volume = |low: &Point<D>, high: &Point<D>| (high - low).sup(&Point::zeros()).product();
    if (ha - la).min() > 1e-9 && (hb - lb).min() > 1e-9 {
        let union = volume(&la, &ha) + volume(&lb, &hb) - volume(&la.sup(&lb), &ha.inf(&hb));
        check(&grid(), &[&TestBody::cuboid(la, ha), &TestBody::cuboid(lb, hb)], Some(union));
    }
}

proptest! {
    #![proptest_config(cases::config(150))]

    #[test]
    fn a_triangle(c in prop::collection::vec(place::<2>(), 3)) {
        check_simplex(c);
    }

    #[test]
    fn a_tetrahedron(c in prop::collection::vec(place::<3>(), 4)) {
        check_simplex(c);
    }

    #[test]
    fn two_triangles_with_a_common_edge(c in prop::collection::vec(place::<2>(), 4)) {
        check_pair(&c);
    }

    #[test]
    fn two_tetrahedra_with_a_common_face(c in prop::collection::vec(place::<3>(), 5)) {
        check_pair(&c);
    }

    #[test]
    fn two_rectangles(c in prop::collection::vec(place::<2>(), 4)) {
        check_boxes(&c);
    }

    #[test]
    fn two_boxes(c in prop::collection::vec(place::<3>(), 4)) {
        check_boxes(&c);
    }

    #[test]
    fn a_cube_turned_and_shifted(
        angles in prop::collection::vec(cases::shift(), 3), shifts in prop::collection::vec(cases::shift(), 3),
    ) {
        // The cube of STLCutters' rotation tests: side 1/2 or 3/7, in 7³ cubes.
        let background = structured_box::<3>([-1.0; 3], [1.0; 3], [7; 3]).expect("a box");
        let turn = mesh::nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let shift = Point::<3>::from_fn(|k, _| 0.25 * shifts[k]);
        for side in [0.5, 3.0 / 7.0] {
            let body = TestBody::cuboid(Point::<3>::repeat(-side / 2.0), Point::repeat(side / 2.0));
            let body = body.moved(|x| turn * x + shift);
            check(&background, &[&body], Some(body.volume()));
        }
    }
}

#[test]
fn steep_facets_do_not_cover_a_face_that_they_touch() {
    // The lower facet of the second body is very close to a face of the background. The layer of fluid below it is left
    // out, also where other facets cut needles from it.
    let corners = [
        [0.6666666666666666, 0.0, 0.16666666666666666],
        [0.16666666666636665, 0.16666666666666666, 0.3333333333333333],
        [0.4444444444444444, 0.4415751799661182, 0.3333333333333363],
        [0.0, 0.0, 0.5],
        [0.0, 0.3333333333333333, 0.3333333333333333],
    ];
    check_pair(&corners.map(Point::<3>::from));
}

#[test]
fn an_edge_of_the_background_through_a_corner_of_a_body() {
    // The corner halves an edge of a cell whose ends have rounded coordinates.
    let corners = [
        [0.3333333333333333, 0.0, 0.0],
        [0.16666666666666666, 0.03, 0.0],
        [0.8333333333333334, 0.5, 0.5],
        [0.0, 0.03, 0.0],
        [0.0, 0.0, 0.0],
    ];
    check_pair(&corners.map(Point::<3>::from));
}

#[test]
fn needles_whose_volume_is_lost_in_round_off_are_parts() {
    // Fluid as long as a cell and 1e-9 wide: computed from its tip, its determinant rounds to zero.
    let corners = [
        [0.16666666666666666, 0.5, 0.16666666666666666],
        [0.0, 0.0, 0.3333333333333333],
        [0.6666666666666666, 0.0, 0.6666666696666667],
        [1.0, 0.4091658991137462, 1.0],
    ];
    check_simplex(corners.map(Point::<3>::from).to_vec());
    let corners = [
        [0.0, 0.3333333333333333, 0.0],
        [0.3333333330333333, 0.6666666666666666, 0.0],
        [0.6666666666666666, 0.6666666666666666, 0.6666666666666666],
        [0.0, 0.0, 0.3333333333333333],
        [0.3333333333333333, 0.0, 0.6666666666666666],
    ];
    check_pair(&corners.map(Point::<3>::from));
}

#[test]
fn facets_much_smaller_than_the_round_off_of_their_coordinates() {
    let body = TestBody::cuboid(Point::<2>::zeros(), Point::<2>::new(0.75, 1e-18));
    check(&grid(), &[&body], Some(body.volume()));
    let body = TestBody::cuboid(Point::<3>::zeros(), Point::<3>::new(0.75, 1e-18, 1e-18));
    check(&grid(), &[&body], Some(body.volume()));
}

#[test]
fn tetrahedra_that_almost_have_a_point_as_edge_or_stick_out_by_almost_nothing() {
    let [near, third, twelfth] = [8.0 / 12.0 - 1e-11, 4.0 / 12.0, 1.0 / 12.0];
    for corners in [
        [[1e-9, 2.0, 0.25], [0.25, 0.25, 0.25], [0.0, 1e-18, 0.0], [0.0, 0.0, 0.0]],
        [[7.0 / 12.0, twelfth, 10.0 / 12.0], [8.0 / 12.0, near, 0.0], [-1e-9, 0.0, near], [third, third, third]],
    ] {
        let body = TestBody::simplex(corners.map(Point::<3>::from).to_vec());
        check(&grid(), &[&body], None);
    }
}

/// Returns the unit cube with an additional vertex on an upper edge that belongs to the facets on one side only, and a
/// facet of zero width between the two sides, as in repaired meshes. `depth` is the distance of the vertex from the
/// edge.
fn cube_with_a_cap(depth: f64) -> TestBody<3> {
    let mut body = TestBody::cuboid(Point::<3>::zeros(), Point::repeat(1.0));
    body.positions.push(Point::<3>::new(0.4, -depth, 1.0 + depth / 3.0));
    let squares = [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let sides = squares.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]);
    TestBody::new(body.positions, sides.chain([4, 8, 7, 8, 5, 7, 4, 7, 6, 4, 5, 8]))
}

#[test]
fn facets_without_width_wherever_they_are() {
    let background = structured_box::<3>([-1.0; 3], [1.0; 3], [3; 3]).expect("a box");
    for depth in [0.0, 1e-16, 1e-13, 1e-10, 1e-6] {
        for step in 0..8 {
            let t = f64::from(step);
            let turn = mesh::nalgebra::Rotation3::from_euler_angles(1.1 * t, 0.7 * t, 1.9 * t);
            let body = cube_with_a_cap(depth).moved(|x| turn * (x - Point::repeat(0.5)));
            // With no depth the rounded corners of the cap may pierce it.
            let options = OverlayOptions::new().without_self_intersection_check();
            let cut = CutMesh::overlay(&background, &[body.placed()], &options).expect("closed");
            check_identities(&background, &cut);
            let area: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
            assert!(
                (cut.fluid_volume() - 7.0).abs() < 1e-5 && (area - 6.0).abs() < 1e-5,
                "depth {depth}, {step}: {area}"
            );
        }
    }
}
