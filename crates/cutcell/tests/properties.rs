//! Identities of the cut over random and degenerate placements.

mod bodies;
mod cases;
mod identities;

use bodies::{TestBody, check_immersed, check_union, overlay};
use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, SimplexMesh, VertexId};
use proptest::prelude::*;

type P = Point<2>;

fn unit_grid(n: usize) -> SimplexMesh<2> {
    structured_box::<2>([0.0, 0.0], [1.0, 1.0], [n, n]).expect("a box")
}

fn star(centre: P, radii: &[f64], turn: f64) -> TestBody<2> {
    let corner = |(k, r): (usize, &f64)| {
        let angle = turn + std::f64::consts::TAU * k as f64 / radii.len() as f64;
        centre + P::new(angle.cos(), angle.sin()) * *r
    };
    TestBody::polygon(radii.iter().enumerate().map(corner).collect())
}

/// Generates coordinates that often coincide with those of the grid, exactly or nearly.
fn nasty_coordinate() -> impl Strategy<Value = f64> {
    let shift = prop_oneof![3 => cases::shift().prop_filter("stays in the grid", |s| s.abs() < 0.1), 1 => -0.05..0.05];
    ((1..8_i32), shift).prop_map(|(k, s)| f64::from(k) / 8.0 + s)
}

proptest! {
    #![proptest_config(cases::config(1500))]

    #[test]
    fn random_stars(
        radii in prop::collection::vec(0.05..0.4_f64, 3..24),
        x in 0.45..0.55_f64, y in 0.45..0.55_f64, turn in 0.0..6.3_f64, n in 1..9_usize,
    ) {
        check_immersed(&unit_grid(n), &star(P::new(x, y), &radii, turn));
    }

    #[test]
    fn rectangles_snapped_to_the_grid(
        x in nasty_coordinate(), y in nasty_coordinate(), a in nasty_coordinate(), b in nasty_coordinate(),
    ) {
        let (low, high) = (P::new(x.min(a), y.min(b)), P::new(x.max(a), y.max(b)));
        if (high - low).min() > 1e-11 {
            check_immersed(&unit_grid(8), &TestBody::cuboid(low, high));
        }
    }

    #[test]
    fn triangles_with_corners_near_vertices(
        c in prop::collection::vec((nasty_coordinate(), nasty_coordinate()), 3),
    ) {
        let points: Vec<P> = c.iter().map(|&(x, y)| P::new(x, y)).collect();
        let mut body = TestBody::polygon(points.clone());
        if body.volume() < 0.0 {
            body = TestBody::polygon(points.into_iter().rev().collect());
        }
        if body.volume() > 1e-3 {
            check_immersed(&unit_grid(8), &body);
        }
    }

    #[test]
    fn two_rectangles_that_overlap_or_touch(
        a in prop::collection::vec(nasty_coordinate(), 4), b in prop::collection::vec(nasty_coordinate(), 4),
    ) {
        let make = |c: &[f64]| (P::new(c[0].min(c[1]), c[2].min(c[3])), P::new(c[0].max(c[1]), c[2].max(c[3])));
        let ((la, ha), (lb, hb)) = (make(&a), make(&b));
        if (ha - la).min() > 1e-11 && (hb - lb).min() > 1e-11 {
            let common = (ha.inf(&hb) - la.sup(&lb)).sup(&P::zeros());
            let area = |l: P, h: P| (h - l)[0] * (h - l)[1];
            let union = area(la, ha) + area(lb, hb) - common[0] * common[1];
            let (first, second) = (TestBody::cuboid(la, ha), TestBody::cuboid(lb, hb));
            check_union(&unit_grid(8), &[&first, &second], union);
            check_union(&unit_grid(8), &[&second, &first], union);
        }
    }

    #[test]
    fn stars_that_overlap_agree_with_polygon_clipping(
        ra in prop::collection::vec(0.1..0.3_f64, 3..12), rb in prop::collection::vec(0.1..0.3_f64, 3..12),
        x in 0.2..0.8_f64, y in 0.2..0.8_f64, turn in 0.0..6.3_f64,
    ) {
        use i_overlay::core::{fill_rule::FillRule, overlay_rule::OverlayRule};
        use i_overlay::float::single::SingleFloatOverlay;
        let (a, b) = (star(P::new(0.5, 0.5), &ra, turn), star(P::new(x, y), &rb, 0.3));
        let path = |p: &TestBody<2>| p.positions.iter().map(|x| [x[0], x[1]]).collect::<Vec<_>>();
        let frame = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let union: Vec<Vec<Vec<[f64; 2]>>> = path(&a).overlay(&path(&b), OverlayRule::Union, FillRule::EvenOdd);
        let inside: Vec<Vec<Vec<[f64; 2]>>> = union.overlay(&frame, OverlayRule::Intersect, FillRule::EvenOdd);
        let area: f64 = inside.iter().flatten().map(|ring| {
            (0..ring.len()).map(|k| {
                let (p, q) = (ring[k], ring[(k + 1) % ring.len()]);
                0.5 * (p[0] * q[1] - p[1] * q[0])
            }).sum::<f64>()
        }).sum::<f64>().abs();
        let background = unit_grid(6);
        let cut = overlay(&background, &[&a, &b]);
        check_identities(&background, &cut);
        // The clipping crate works on integers of about 1e-9 of the size.
        prop_assert!((cut.fluid_volume() - (1.0 - area)).abs() < 1e-7, "{} {}", cut.fluid_volume(), 1.0 - area);
    }
}

#[test]
fn a_moved_body_covers_the_same_area() {
    let background = unit_grid(7);
    let body = star(P::new(0.4, 0.45), &[0.2; 17], 0.1);
    for step in 0..200 {
        let t = f64::from(step);
        let shift = P::new((t * 0.37).sin(), (t * 0.61).cos()) * 0.15;
        check_immersed(&background, &body.moved(|x| x + shift));
    }
}

#[test]
fn a_half_disk_on_the_symmetry_line_has_no_piece_there() {
    let background = unit_grid(8);
    let half =
        mesh::generate::half_ball::<2>([0.0, 0.5], 0.31, 0.05, &mesh::generate::BallOptions { area_preserving: false })
            .expect("half a disk");
    let boundary = half.boundary();
    let cut = CutMesh::overlay(&background, &[Placed::new(&boundary, half.vertices())], &OverlayOptions::new())
        .expect("a closed surface");
    check_identities(&background, &cut);
    let area: f64 = half.cells().map(|c| half.cell_volume(c)).sum();
    assert!((cut.fluid_volume() - (1.0 - area)).abs() < 1e-13);
    for piece in cut.interface() {
        assert!(piece.points[..2].iter().any(|x| x[0] > 0.0), "a piece on the symmetry line");
    }
    let on_line: f64 =
        cut.boundary().iter().filter(|p| p.points[..2].iter().all(|x| x[0] == 0.0)).map(|p| p.measure).sum();
    assert!((on_line - (1.0 - 0.62)).abs() < 1e-12, "{on_line}");
}

#[test]
fn a_plate_on_the_bottom_is_wet_on_its_top_only() {
    let background = unit_grid(8);
    for top in [0.2, 0.25] {
        let plate = TestBody::cuboid(P::new(0.0, 0.0), P::new(1.0, top));
        let cut = check_union(&background, &[&plate], top);
        let length: f64 = cut.interface().iter().map(|p| p.measure).sum();
        assert!((length - 1.0).abs() < 1e-13, "{length}");
        assert!(cut.interface().iter().all(|p| p.facet.0 == 2));
    }
}

#[test]
fn a_body_may_stick_out_and_cover_everything() {
    let background = unit_grid(3);
    check_union(&background, &[&TestBody::cuboid(P::new(-1.0, -1.0), P::new(0.5, 2.0))], 0.5);
    check_union(&background, &[&TestBody::cuboid(P::new(-1.0, -1.0), P::new(2.0, 2.0))], 1.0);
    check_union(&background, &[&TestBody::cuboid(P::new(3.0, 3.0), P::new(4.0, 4.0))], 0.0);
}

#[test]
fn a_thin_strip_makes_two_parts() {
    let background = unit_grid(2);
    let strip = TestBody::cuboid(P::new(-0.5, 0.24), P::new(1.5, 0.26));
    let cut = check_union(&background, &[&strip], 0.02);
    assert_eq!(cut.report().max_parts, 2);
    assert!(cut.parts(mesh::CellId(0)).len() == 2);
}

#[test]
fn several_bodies_inside_one_cell() {
    let background = unit_grid(1);
    let bodies = [
        TestBody::cuboid(P::new(0.6, 0.1), P::new(0.7, 0.2)),
        TestBody::cuboid(P::new(0.75, 0.15), P::new(0.9, 0.3)),
        TestBody::cuboid(P::new(0.8, 0.4), P::new(0.85, 0.45)),
    ];
    let union = bodies.iter().map(TestBody::volume).sum();
    check_union(&background, &bodies.iter().collect::<Vec<_>>(), union);
}

#[test]
fn a_hole_filled_by_another_body() {
    // A frame with a square hole. A single polygon with a slit of zero width is not a valid surface, so the frame
    // consists of two L-shaped bodies.
    let background = unit_grid(5);
    let p = P::new;
    let lower = TestBody::polygon(vec![p(0.2, 0.2), p(0.8, 0.2), p(0.8, 0.8), p(0.6, 0.8), p(0.6, 0.4), p(0.2, 0.4)]);
    let upper = TestBody::polygon(vec![p(0.2, 0.4), p(0.4, 0.4), p(0.4, 0.6), p(0.6, 0.6), p(0.6, 0.8), p(0.2, 0.8)]);
    let core = TestBody::cuboid(p(0.4, 0.4), p(0.6, 0.6));
    let cut = check_union(&background, &[&lower, &upper, &core], 0.36);
    let length: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
    assert!((length - 2.4).abs() < 1e-12, "{length}");
}

#[test]
fn bad_surfaces_are_refused() {
    use cutcell::{Error, SurfaceVertex};
    let background = unit_grid(2);
    let options = OverlayOptions::new();
    let positions = vec![P::new(0.2, 0.2), P::new(0.8, 0.2), P::new(0.5, 0.8)];
    let try_facets = |facets: &[u32], positions: &[P]| {
        let boundary = BoundaryMesh::<2>::from_facets(facets.iter().map(|&v| VertexId(v)).collect());
        CutMesh::overlay(&background, &[Placed::new(&boundary, positions)], &options).map(|_| ())
    };
    assert!(try_facets(&[0, 1, 1, 2, 2, 0], &positions).is_ok());
    assert!(matches!(try_facets(&[0, 1, 1, 2], &positions), Err(Error::Open { twin: None, .. })));
    // Facets with vertices of their own at the same places, one facet that is turned, and one with a vertex too many.
    let own: Vec<P> = [0, 1, 1, 2, 2, 0].iter().map(|k| positions[*k]).collect();
    let soup = try_facets(&[0, 1, 2, 3, 4, 5], &own).expect_err("no neighbours");
    assert!(matches!(soup, Error::Open { twin: Some(mesh::VertexId(5)), .. }), "{soup}");
    let turned = try_facets(&[0, 1, 1, 2, 0, 2], &positions).expect_err("turned");
    assert!(matches!(turned, Error::Turned { at: SurfaceVertex { vertex: mesh::VertexId(0), .. } }), "{turned}");
    let beyond = try_facets(&[0, 1, 1, 2, 2, 3], &positions).expect_err("no position");
    assert!(matches!(beyond, Error::MissingPosition { facet: mesh::FacetId(2), n_positions: 3, .. }), "{beyond}");
    for relative_tolerance in [-1e-3, 1.0, f64::NAN] {
        let options = OverlayOptions { relative_tolerance, ..OverlayOptions::default() };
        let refused = CutMesh::overlay(&background, &[], &options).err();
        assert!(matches!(refused, Some(Error::Parameter(_))), "{refused:?}");
    }
    // The facet at the outermost vertex along the first axis, and that vertex.
    let inward = try_facets(&[1, 0, 2, 1, 0, 2], &positions).expect_err("turned inwards");
    assert!(matches!(inward, Error::Inward { facet: mesh::FacetId(1), point: [0.8, 0.2, 0.0], .. }), "{inward}");
    // A second triangle that is turned inwards is a hole in the first one, and an error outside of it.
    let [hole, outside] = [[0.5, 0.4], [0.85, 0.7]].map(|[x, y]| {
        let all = [&positions[..], &[P::new(x, y), P::new(x + 0.05, y), P::new(x, y + 0.05)]].concat();
        try_facets(&[0, 1, 1, 2, 2, 0, 4, 3, 5, 4, 3, 5], &all)
    });
    assert!(hole.is_ok(), "{hole:?}");
    assert!(matches!(outside, Err(Error::InwardPart { facet: mesh::FacetId(4), .. })), "{outside:?}");
    assert!(matches!(try_facets(&[], &positions), Err(Error::Empty { .. })));
    // A pentagram: its area is positive, but its edges cross.
    let corner = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(2 * k) / 5.0;
        P::new(0.5 + 0.4 * angle.cos(), 0.5 + 0.4 * angle.sin())
    };
    let pentagram: Vec<P> = (0..5).map(corner).collect();
    let edges: Vec<u32> = (0..5).flat_map(|k| [k, (k + 1) % 5]).collect();
    let crossed = try_facets(&edges, &pentagram).expect_err("crosses itself");
    assert!(matches!(crossed, Error::SelfIntersection { .. }), "{crossed}");
    let nan = vec![positions[0], P::new(f64::NAN, 0.0), positions[2]];
    assert!(matches!(try_facets(&[0, 1, 1, 2, 2, 0], &nan), Err(Error::NotFinite { .. })));
    let far = vec![P::new(0.1, 0.1), P::new(0.4, 1e300), P::new(0.2, 0.3)];
    assert!(matches!(try_facets(&[0, 1, 1, 2, 2, 0], &far), Err(Error::TooFar { limit: 1e9, .. })));
    assert!(matches!(try_facets(&[0, 1, 1, 2, 2, 0, 0, 1, 1, 2, 2, 0], &positions), Err(Error::NonManifold { .. })));
}

#[test]
fn overlap_volumes_of_two_cuts_add_up() {
    let background = unit_grid(5);
    let a = star(P::new(0.4, 0.5), &[0.25; 9], 0.0);
    let b = star(P::new(0.45, 0.47), &[0.25; 9], 0.1);
    let (first, second) = (overlay(&background, &[&a]), overlay(&background, &[&b]));
    // Fluid in both = domain without the union of both bodies.
    let common: f64 = background
        .cells()
        .map(|cell| {
            first
                .parts(cell)
                .flat_map(|p| second.parts(cell).map(move |q| (p, q)))
                .map(|(p, q)| first.overlap_volume(&background, p, &second, q))
                .sum::<f64>()
        })
        .sum();
    let both = overlay(&background, &[&a, &b]);
    assert!((common - both.fluid_volume()).abs() < 1e-13, "{common} {}", both.fluid_volume());
}

#[test]
fn threads_do_not_change_the_result() {
    // The number of touched cells is large enough that their division depends on the number of threads.
    let background = unit_grid(160);
    let body = star(P::new(0.5, 0.5), &[0.3; 40], 0.05);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| overlay(&background, &[&body]))
    };
    let one = run(1);
    assert!(one.report().n_cut_cells > 2 * 256);
    assert!(one == run(2));
    assert!(one == run(3));
}

#[test]
fn faces_next_to_cut_cells_are_ghost_faces() {
    // Two squares in two triangles each, divided by their rising diagonals; a small body inside the upper left
    // triangle of the left square.
    let background = structured_box::<2>([0.0, 0.0], [2.0, 1.0], [2, 1]).expect("a box");
    let cut = overlay(&background, &[&TestBody::cuboid(P::new(0.2, 0.6), P::new(0.3, 0.7))]);
    assert_eq!(cut.report().n_cut_cells, 1);
    let cells_of = |face: &cutcell::PartFace| face.parts.map(|part| cut.part_cell(part));
    let is_cut = |cell: mesh::CellId| cut.cell_state(cell) == cutcell::CellState::Cut;
    assert_eq!(cut.part_faces().len(), 3);
    assert_eq!(cut.ghost_faces().count(), 1, "the diagonal of the left square");
    for face in cut.part_faces() {
        assert_eq!(face.is_ghost, cells_of(face).into_iter().any(is_cut));
    }
}
