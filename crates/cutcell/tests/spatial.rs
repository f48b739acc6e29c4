//! Cutting tetrahedra: identities over turned and shifted cubes and spheres.

mod bodies;
mod identities;

use bodies::{TestBody, check_immersed, check_union, overlay};
use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use mesh::generate::structured_box;
use mesh::{Point, SimplexMesh};

type P = Point<3>;

/// Returns the cube [-1/2, 1/2]³.
fn cube() -> TestBody<3> {
    TestBody::cuboid(P::repeat(-0.5), P::repeat(0.5))
}

/// Returns a triangulated sphere: an octahedron with each triangle divided into n² and its vertices moved to the
/// sphere.
fn sphere(radius: f64, n: u32) -> TestBody<3> {
    let mut positions: Vec<P> = Vec::new();
    let mut triangles = Vec::new();
    let mut vertex = |x: P| {
        let found = positions.iter().position(|y: &P| (x - y).norm() < 1e-12);
        found.unwrap_or_else(|| {
            positions.push(x);
            positions.len() - 1
        }) as u32
    };
    for octant in 0..8 {
        let s = |k: u32| if octant >> k & 1 == 0 { 1.0 } else { -1.0 };
        let even = s(0) * s(1) * s(2) > 0.0;
        let mut at = |i: u32, j: u32| {
            let (a, b, c) = (f64::from(n - i - j), f64::from(i), f64::from(j));
            vertex(P::new(s(0) * a, s(1) * b, s(2) * c).normalize() * radius)
        };
        let mut push = |a: u32, b: u32, c: u32| triangles.push(if even { [a, b, c] } else { [a, c, b] });
        for i in 0..n {
            for j in 0..n - i {
                let (a, b, c) = (at(i, j), at(i + 1, j), at(i, j + 1));
                push(a, b, c);
                if i + j + 1 < n {
                    let d = at(i + 1, j + 1);
                    push(b, d, c);
                }
            }
        }
    }
    TestBody::new(positions, triangles.into_iter().flatten())
}

fn grid(n: usize) -> SimplexMesh<3> {
    structured_box::<3>([-1.0; 3], [1.0; 3], [n; 3]).expect("a box")
}

fn turned(angle: f64) -> impl Fn(&P) -> P {
    let turn = mesh::nalgebra::Rotation3::from_euler_angles(angle, 0.7 * angle, -0.4 * angle);
    move |x| turn * x
}

#[test]
fn a_cube_turned_and_shifted_by_almost_nothing() {
    let background = grid(7);
    let sizes = [0.0, 1e-17, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1.0];
    for size in sizes {
        check_immersed(&background, &cube().moved(turned(size)));
        check_immersed(&background, &cube().moved(|x| x * (6.0 / 7.0) + P::new(size, 0.3 * size, -0.7 * size) * 0.4));
    }
}

#[test]
fn spheres_at_many_places() {
    let background = grid(6);
    for k in 0..12 {
        let t = f64::from(k);
        let shift = P::new((1.7 * t).sin(), (2.3 * t).cos(), (0.9 * t).sin()) * 0.2;
        check_immersed(&background, &sphere(0.55, 4).moved(|x| x + shift));
    }
    // Facets much smaller than the cells, and much larger.
    check_immersed(&grid(2), &sphere(0.6, 12));
    check_immersed(&grid(16), &sphere(0.7, 1));
}

#[test]
fn bodies_that_overlap_touch_and_stick_out() {
    let background = grid(5);
    let first = cube().moved(|x| x * 0.8);
    let overlapping = cube().moved(|x| x * 0.8 + P::new(0.4, 0.2, 0.0));
    let touching = cube().moved(|x| x * 0.8 + P::new(0.8, 0.0, 0.0));
    let outside = cube().moved(|x| x * 0.8 + P::new(1.0, 1.0, 1.0));
    let volume = 0.8_f64.powi(3);
    for (bodies, union) in [
        ([&first, &overlapping], 2.0 * volume - 0.4 * 0.6 * 0.8),
        ([&first, &touching], volume + 0.6 * 0.8 * 0.8),
        ([&first, &outside], volume + 0.4_f64.powi(3)),
    ] {
        for bodies in [bodies, [bodies[1], bodies[0]]] {
            check_union(&background, &bodies, union);
        }
    }
}

#[test]
fn a_thin_plate_makes_two_parts() {
    let background = grid(3);
    let plate = cube().moved(|x| P::new(4.0 * x[0], 4.0 * x[1], 0.02 * x[2] + 0.11));
    let cut = check_union(&background, &[&plate], 4.0 * 0.02);
    assert_eq!(cut.report().max_parts, 2);
}

#[test]
fn a_cutter_gives_what_a_fresh_overlay_gives() {
    let backgrounds = [grid(4), grid(9), grid(3)];
    let bodies = [sphere(0.6, 4), cube().moved(|x| x * 0.4), sphere(0.3, 6)];
    let mut cutter = cutcell::Cutter::new();
    for (step, background) in backgrounds.iter().cycle().take(7).enumerate() {
        let shift = P::new(0.01, 0.02, -0.013) * step as f64;
        let moved: Vec<TestBody<3>> = bodies[step % 3..].iter().map(|body| body.moved(|x| x + shift)).collect();
        let placed: Vec<_> = moved.iter().map(TestBody::placed).collect();
        let cut = cutter.overlay(background, &placed, &OverlayOptions::new()).expect("sound surfaces");
        assert!(
            cut == CutMesh::overlay(background, &placed, &OverlayOptions::new()).expect("sound surfaces"),
            "step {step}"
        );
        assert!(cut.report().n_cut_cells > 0);
        if step % 2 == 0 {
            cutter.recycle(cut);
        }
        // A failed overlay does not change later results.
        let inwards = moved[0].moved(|x| P::new(-x[0], x[1], x[2]));
        assert!(cutter.overlay(background, &[inwards.placed()], &OverlayOptions::new()).is_err());
    }
}

#[test]
fn pieces_of_needles_have_barycentric_coordinates() {
    // The third corner almost lies on the side between the two others.
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0], [0.4, 0.3, 0.8]];
    let body = TestBody::new(points.map(P::from).to_vec(), [1, 0, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3]);
    let body = body.moved(|x| x - P::new(0.3, 0.1, 0.2));
    assert!(body.volume() > 0.0);
    let cut = overlay(&grid(3), &[&body]);
    assert!(!cut.interface().is_empty());
    for piece in cut.interface() {
        let corners = body.placed().facet_points(piece.facet);
        for (x, barycentric) in piece.points.iter().zip(&piece.barycentric) {
            let there: P = corners.iter().zip(barycentric).map(|(corner, l)| corner * *l).sum();
            assert!((there - x).norm() < 1e-8, "{x} from {barycentric:?}");
        }
    }
}

#[test]
fn a_surface_that_pierces_itself_is_refused_unless_allowed() {
    // Two cubes that overlap, as one surface.
    let (first, second) = (cube(), cube().moved(|x| x * 0.8 + P::new(0.5, 0.1, 0.2)));
    let offset = first.positions.len() as u32;
    let corners = |body: &TestBody<3>, offset: u32| -> Vec<u32> {
        body.boundary.facets().flat_map(|f| body.boundary.facet(f)).map(|v| v.0 + offset).collect()
    };
    let facets = [corners(&first, 0), corners(&second, offset)].concat();
    let both = TestBody::new([first.positions.clone(), second.positions.clone()].concat(), facets);
    let background = grid(5);
    let options = OverlayOptions::new();
    let refused = CutMesh::overlay(&background, &[both.placed()], &options).expect_err("pierces itself");
    assert!(matches!(refused, cutcell::Error::SelfIntersection { .. }), "{refused}");
    let cut = CutMesh::overlay(&background, &[both.placed()], &options.without_self_intersection_check())
        .expect("a closed surface");
    check_identities(&background, &cut);
    let union = overlay(&background, &[&first, &second]);
    assert!((cut.fluid_volume() - union.fluid_volume()).abs() < 1e-12, "overlapping parts of a surface count once");
}
