//! Properties of all generated meshes and of spatial search.

mod common;

use std::f64::consts::PI;

use common::{assert_sound, smallest_angle, volume};

use mesh::generate::{
    BallOptions, Region, RegionShape, Size, ball, graded_box, half_ball, mirrored, refined_box, structured_box,
};
use mesh::search::{Feature, SurfaceIndex, facets_are_within};
use mesh::{Aabb, BoundaryMesh, CellId, Error, FacetId, Placed, Point, SimplexMesh, VertexId};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Background mesh of the virtual-barrier and rigid-ground cases.
const RIGID: Size = Size::Graded { fine: 0.1, fine_until: 4.5, coarse: 0.5, coarse_from: 10.0, axis: 1 };
/// Background mesh of the flexible-ground case.
const FLEXIBLE: Size = Size::Graded { fine: 0.05, fine_until: 0.5, coarse: 0.5, coarse_from: 5.0, axis: 1 };

fn few_cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(44), failure_persistence: None, ..ProptestConfig::default() }
}

/// Checks a mesh as [`assert_sound`], and that its angles are at least 25 degrees.
fn assert_well_shaped(mesh: &SimplexMesh<2>) {
    assert_sound(mesh);
    let degrees = smallest_angle(mesh);
    assert!(degrees >= 25.0, "{degrees} degrees");
}

/// Checks that the mean length of the edges at every vertex, relative to the specified size, is within the bounds, and
/// that the mean diameter of the cells is the specified size.
fn assert_sizes(mesh: &SimplexMesh<2>, size: &Size, low: f64, high: f64) {
    let mut sums = vec![(0.0, 0.0); mesh.n_vertices()];
    let relative_length = |facet: FacetId| {
        let [x, y] = [0, 1].map(|k| mesh.vertex(mesh.facet(facet)[k]));
        (x - y).norm() / size.at(&(0.5 * (x + y)))
    };
    for facet in mesh.facets() {
        for v in mesh.facet(facet) {
            let sum = &mut sums[v.index()];
            *sum = (sum.0 + relative_length(facet), sum.1 + 1.0);
        }
    }
    for (v, (sum, count)) in sums.into_iter().enumerate() {
        let mean = sum / count;
        assert!((low..high).contains(&mean), "{mean} at {}", mesh.vertices()[v]);
    }
    let diameter = |cell: CellId| mesh.cell_to_facet(cell).iter().map(|&f| relative_length(f)).fold(0.0, f64::max);
    let mean = mesh.cells().map(diameter).sum::<f64>() / mesh.n_cells() as f64;
    assert!((mean - 1.0).abs() < 0.035, "mean diameter {mean}");
}

/// Checks that every tagged facet of a box lies exactly on its side, and that every corner is a vertex.
fn assert_box_sides(mesh: &SimplexMesh<2>, min: [f64; 2], max: [f64; 2]) {
    let sides = [("left", 0, min[0]), ("right", 0, max[0]), ("bottom", 1, min[1]), ("top", 1, max[1])];
    for (name, axis, value) in sides {
        let tag = mesh.tag(name);
        let mut length = 0.0;
        for facet in mesh.facets().filter(|&f| mesh.facet_tag(f) == tag) {
            let x = [0, 1].map(|k| mesh.vertex(mesh.facet(facet)[k]));
            assert!(x.iter().all(|x| x[axis] == value));
            length += (x[1] - x[0]).norm();
        }
        assert!((length - (max[1 - axis] - min[1 - axis])).abs() < 1e-12 * length);
    }
    for corner in [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]] {
        assert!(mesh.vertices().contains(&Point::<2>::from(corner)));
    }
}

#[test]
fn the_meshes_of_the_cases_are_well_shaped() {
    for (size, bottom) in [(RIGID, 0.0), (FLEXIBLE, -0.2)] {
        let mesh = graded_box([0.0, bottom], [10.0, 15.0], &size).unwrap();
        assert_well_shaped(&mesh);
        assert_box_sides(&mesh, [0.0, bottom], [10.0, 15.0]);
        assert_sizes(&mesh, &size, 0.74, 1.15);
        assert!((volume(&mesh) - 10.0 * (15.0 - bottom)).abs() < 1e-10);
        assert!((13_000..18_000).contains(&mesh.n_cells()));
        let again = graded_box([0.0, bottom], [10.0, 15.0], &size).unwrap();
        assert_eq!(mesh.vertices(), again.vertices());
    }
    let disk = half_ball([0.0, 5.0], 4.0, 0.1, &BallOptions { area_preserving: true }).unwrap();
    assert_well_shaped(&disk);
    assert_sizes(&disk, &Size::uniform(0.1), 0.74, 1.15);
    let plate = structured_box([0.0, -0.2], [20.0, 0.0], [67, 2]).unwrap();
    assert_sound(&plate);
    assert_box_sides(&plate, [0.0, -0.2], [20.0, 0.0]);
}

#[test]
fn a_disk_has_the_specified_area_or_radius() {
    let centre = Point::<2>::new(1.0, -2.0);
    let on_circle = ball([1.0, -2.0], 3.0, 0.25, &BallOptions::default()).unwrap();
    let boundary = on_circle.boundary();
    for facet in boundary.facets() {
        let x = on_circle.vertex(boundary.facet(facet)[0]);
        assert!(((x - centre).norm() - 3.0).abs() < 1e-14);
    }
    let same_area = BallOptions { area_preserving: true };
    let disk = ball([1.0, -2.0], 3.0, 0.25, &same_area).unwrap();
    assert!((volume(&disk) - 9.0 * PI).abs() < 1e-12);
    let half = half_ball([1.0, -2.0], 3.0, 0.25, &same_area).unwrap();
    assert!((volume(&half) - 4.5 * PI).abs() < 1e-12);
}

#[test]
fn a_mirrored_half_disk_is_an_exactly_symmetric_disk() {
    let half = half_ball([2.0, 5.0], 4.0, 0.3, &BallOptions::default()).unwrap();
    let left = half.tag("left");
    for facet in half.facets() {
        let on_plane = half.facet(facet).iter().all(|&v| half.vertex(v)[0] == 2.0);
        assert_eq!(on_plane, half.facet_tag(facet) == left);
    }
    let disk = mirrored(&half, 0, 2.0).unwrap();
    assert_well_shaped(&disk);
    assert_eq!(disk.n_cells(), 2 * half.n_cells());
    assert_eq!(disk.tag_names(), ["surface"]);
    for x in half.vertices() {
        assert!(disk.vertices().contains(x));
        assert!(disk.vertices().contains(&Point::<2>::new(4.0 - x[0], x[1])));
    }
    let on_plane = |mesh: &SimplexMesh<2>| mesh.vertices().iter().filter(|x| x[0] == 2.0).count();
    assert_eq!(disk.n_vertices(), 2 * half.n_vertices() - on_plane(&half));
}

#[test]
fn mirrored_boxes_keep_their_sides() {
    let half = graded_box([0.0, 0.0], [1.0, 2.0], &Size::uniform(0.2)).unwrap();
    let whole = mirrored(&half, 0, 0.0).unwrap();
    assert_well_shaped(&whole);
    assert_box_sides(&whole, [-1.0, 0.0], [1.0, 2.0]);

    let brick = mirrored(&structured_box([0.0; 3], [1.0; 3], [2; 3]).unwrap(), 1, 1.0).unwrap();
    assert_sound(&brick);
    assert!((volume(&brick) - 2.0).abs() < 1e-14);
    let side = |name: &str| {
        let tag = brick.tag(name);
        brick
            .facets()
            .filter(|&f| brick.facet_tag(f) == tag)
            .map(|f| brick.vertex(brick.facet(f)[0])[1])
            .collect::<Vec<_>>()
    };
    assert_eq!((side("front"), side("back")), (vec![0.0; 8], vec![2.0; 8]));
    assert_eq!((side("bottom").len(), side("left").len()), (16, 16));

    for (axis, plane) in [(2, 0.0), (0, 0.5), (0, -1.0), (0, f64::NAN)] {
        assert!(mirrored(&half, axis, plane).is_err());
    }
}

#[test]
fn boxes_in_3d_follow_the_size() {
    let size = Size::Graded { fine: 0.1, fine_until: 0.2, coarse: 0.3, coarse_from: 1.0, axis: 2 };
    let mesh = graded_box([0.0; 3], [0.4, 0.5, 2.0], &size).unwrap();
    assert_sound(&mesh);
    assert!((volume(&mesh) - 0.4).abs() < 1e-13);
    let mut heights: Vec<f64> = mesh.vertices().iter().map(|x| x[2]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    for pair in heights.windows(2) {
        let ratio = (pair[1] - pair[0]) / size.at(&Point::<3>::new(0.0, 0.0, 0.5 * (pair[0] + pair[1])));
        assert!((0.8..1.25).contains(&ratio));
    }
}

/// Returns a ball, a line and a box that begin in the unit cube, each with coarser cells than the one before.
fn regions<const D: usize>(size: f64, growth: f64) -> [Region<D>; 3] {
    let at = |x: f64| Point::<D>::from_fn(|k, _| x + 0.1 * k as f64);
    [
        Region { shape: RegionShape::Segment { ends: [at(0.3); 2], within: 0.11 }, size, growth },
        Region { shape: RegionShape::Segment { ends: [at(0.3), at(0.8)], within: 0.0 }, size: 2.0 * size, growth },
        Region { shape: RegionShape::Box(Aabb { low: at(0.6), high: at(2.0) }), size: 3.0 * size, growth },
    ]
}

/// Returns the smallest size that regions and the background prescribe.
fn prescribed_size<const D: usize>(regions: &[Region<D>], coarse: f64, x: &Point<D>) -> f64 {
    regions.iter().map(|region| region.at(x)).fold(coarse, f64::min)
}

#[test]
fn triangles_are_fine_near_regions() {
    for size in [0.04, 0.02, 0.01, 0.005] {
        let regions = regions::<2>(size, 0.1);
        let mesh = refined_box([0.0; 2], [1.0; 2], &Size::uniform(0.2), &regions).unwrap();
        assert_well_shaped(&mesh);
        assert_box_sides(&mesh, [0.0; 2], [1.0; 2]);
        assert!((volume(&mesh) - 1.0).abs() < 1e-13);
        let relative = |cell: CellId| {
            let simplex = mesh.simplex(cell);
            simplex.diameter() / prescribed_size(&regions, 0.2, &simplex.centroid())
        };
        let [mean, largest] = [
            mesh.cells().map(relative).sum::<f64>() / mesh.n_cells() as f64,
            mesh.cells().map(relative).fold(0.0, f64::max),
        ];
        assert!((mean - 1.0).abs() < 0.05 && largest < 1.6, "mean {mean}, largest {largest}");
        let again = refined_box([0.0; 2], [1.0; 2], &Size::uniform(0.2), &regions).unwrap();
        assert_eq!(mesh.vertices(), again.vertices());
    }
}

/// Checks a mesh as [`assert_sound`], and that its angles are at least those that are stated for a growth.
fn assert_well_graded(mesh: &SimplexMesh<2>, growth: f64) {
    assert_sound(mesh);
    let (degrees, least) = (smallest_angle(mesh), if growth <= 0.3 { 25.0 } else { 20.0 });
    assert!(degrees >= least, "{degrees} degrees with a growth of {growth}");
}

#[test]
fn triangles_at_a_fine_point_of_a_side_are_well_shaped() {
    for size in [1e-2, 1e-4, 1e-6] {
        for (x, growth) in [(0.5123, 0.1), (0.0, 0.3), (0.7, 0.5)] {
            let shape = RegionShape::Segment { ends: [Point::<2>::new(x, 0.0); 2], within: 0.0 };
            let mesh = refined_box([0.0; 2], [1.0; 2], &Size::uniform(0.2), &[Region { shape, size, growth }]).unwrap();
            assert_well_graded(&mesh, growth);
        }
    }
}

/// Volume over cubed diameter of the tetrahedra of a cube and of those that bisection makes of them; a regular one has
/// 0.118.
const SHAPES: [f64; 3] = [0.032_075, 0.029_463, 0.041_667];

#[test]
fn tetrahedra_are_fine_near_regions() {
    for size in [0.08, 0.04, 0.02, 0.01] {
        let regions = regions::<3>(size, 0.3);
        let mesh = refined_box([0.0; 3], [1.0; 3], &Size::uniform(0.25), &regions).unwrap();
        assert_sound(&mesh);
        assert!((volume(&mesh) - 1.0).abs() < 1e-12);
        let mut mean = 0.0;
        for cell in mesh.cells() {
            let simplex = mesh.simplex(cell);
            let relative = simplex.diameter() / 3.0_f64.sqrt() / prescribed_size(&regions, 0.25, &simplex.centroid());
            assert!(relative < 1.0 + 1e-8, "{relative}");
            let shape = simplex.volume() / simplex.diameter().powi(3);
            assert!(SHAPES.iter().any(|known| (shape - known).abs() < 1e-5), "{shape} at {}", simplex.centroid());
            mean += relative / mesh.n_cells() as f64;
        }
        assert!(mean > 0.5, "{mean}");
        let again = refined_box([0.0; 3], [1.0; 3], &Size::uniform(0.25), &regions).unwrap();
        assert_eq!((mesh.vertices(), mesh.n_cells()), (again.vertices(), again.n_cells()));
        assert_sound(&mirrored(&mesh, 0, 1.0).unwrap());
    }
}

#[test]
fn regions_refine_graded_bricks() {
    let size = Size::Graded { fine: 0.1, fine_until: 0.2, coarse: 0.3, coarse_from: 1.0, axis: 2 };
    let mesh = refined_box([0.0; 3], [0.4, 0.5, 2.0], &size, &regions::<3>(0.04, 0.2)[..1]).unwrap();
    assert_sound(&mesh);
    assert!((volume(&mesh) - 0.4).abs() < 1e-13);
}

#[test]
fn invalid_arguments_are_errors() {
    for outside in [
        Region { size: 0.3, ..regions::<2>(0.1, 0.1)[0].clone() },
        Region { growth: 0.6, ..regions(0.1, 0.1)[0].clone() },
    ] {
        assert!(refined_box([0.0; 2], [1.0; 2], &Size::uniform(0.2), &[outside]).is_err());
    }
    let options = BallOptions::default();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
        assert!(graded_box([0.0, 0.0], [1.0, 1.0], &Size::uniform(bad)).is_err());
        assert!(graded_box([0.0; 3], [1.0; 3], &Size::uniform(bad)).is_err());
        assert!(half_ball([0.0, 0.0], 1.0, bad, &options).is_err());
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(graded_box([0.0, 0.0], [1.0, bad], &Size::uniform(0.1)).is_err());
        assert!(ball([0.0, 0.0], bad, 0.1, &options).is_err());
    }
    assert!(ball([0.0, f64::NAN], 1.0, 0.1, &options).is_err());
    assert!(matches!(half_ball([0.0; 3], 1.0, 0.1, &options), Err(Error::Dimension { dimension: 3, .. })));
}

#[test]
fn units_that_differ_by_powers_of_a_hundred_have_the_same_mesh() {
    let size = |unit: f64| Size::Graded {
        fine: 0.06 * unit,
        fine_until: 0.3 * unit,
        coarse: 0.2 * unit,
        coarse_from: 0.9 * unit,
        axis: 1,
    };
    let cells = |mesh: &SimplexMesh<2>| mesh.cells().map(|cell| mesh.cell(cell).to_vec()).collect::<Vec<_>>();
    let options = BallOptions { area_preserving: true };
    for unit in [1e-2, 1e2, 1e-4, 1e-60, 1e40] {
        let meshes = |unit: f64| {
            [
                graded_box([0.0, 0.0], [1.5 * unit, unit], &size(unit)).unwrap(),
                ball([0.3 * unit, -7.0 * unit], 0.4 * unit, 0.1 * unit, &options).unwrap(),
                half_ball([0.0, 0.0], 0.4 * unit, 0.1 * unit, &options).unwrap(),
            ]
        };
        for (given, other) in meshes(1.0).iter().zip(&meshes(unit)) {
            assert_eq!(cells(given), cells(other), "{unit:e}");
            let same = |(a, b): (&Point<2>, &Point<2>)| (a - b / unit).amax() <= 1e-14 * (1.0 + a.amax());
            assert!(given.vertices().iter().zip(other.vertices()).all(same), "{unit:e}");
            assert_eq!(given.boundary_names(), other.boundary_names());
        }
    }
}

#[test]
fn large_sizes_are_cut_down() {
    assert_well_shaped(&graded_box([0.0, 0.0], [2.0, 1.0], &Size::uniform(7.0)).unwrap());
    assert_well_shaped(&ball([0.0, 0.0], 1.0, 9.0, &BallOptions::default()).unwrap());
    assert_well_shaped(&half_ball([1e6, 0.0], 1.0, 9.0, &BallOptions::default()).unwrap());
    assert_sound(&graded_box([0.0; 3], [2.0, 1.0, 1.0], &Size::uniform(7.0)).unwrap());
}

proptest! {
    #![proptest_config(few_cases(48))]

    #[test]
    fn boxes_are_well_shaped(
        width in 0.3..3.0_f64, height in 0.3..3.0_f64, corner in -5.0..5.0_f64,
        coarse in 0.06..1.0_f64, ratio in 0.1..1.0_f64, slope in 0.02..0.499_f64, until in 0.0..1.0_f64, axis in 0..2_usize,
    ) {
        let fine = coarse * ratio.max(0.04 / coarse);
        let fine_until = corner + until * height;
        let size = Size::Graded { fine, fine_until, coarse, coarse_from: fine_until + (coarse - fine) / slope, axis };
        let (min, max) = ([corner, corner], [corner + width, corner + height]);
        let mesh = graded_box(min, max, &size).unwrap();
        assert_well_shaped(&mesh);
        assert_box_sides(&mesh, min, max);
    }

    #[test]
    fn triangles_near_regions_are_well_shaped(
        ends in prop::array::uniform4(0.0..1.0_f64), within in 0.0..0.3_f64, ratio in 0.05..1.0_f64, growth in 0.02..0.5_f64,
    ) {
        let [a, b, c, d] = ends;
        let segment = RegionShape::Segment { ends: [Point::<2>::new(a, b), Point::<2>::new(c, d)], within };
        let patch = RegionShape::Box(Aabb { low: Point::<2>::new(a, b - 0.2), high: Point::<2>::new(a + within, b + 0.1) });
        let regions = [segment, patch].map(|shape| Region { shape, size: 0.2 * ratio, growth });
        let mesh = refined_box([0.0; 2], [1.0; 2], &Size::uniform(0.2), &regions).unwrap();
        assert_well_graded(&mesh, growth);
        assert_box_sides(&mesh, [0.0; 2], [1.0; 2]);
    }

    #[test]
    fn balls_are_well_shaped(radius in 0.5..5.0_f64, n in 1.0..25.0_f64, x in -10.0..10.0_f64, area_preserving: bool) {
        let options = BallOptions { area_preserving };
        assert_well_shaped(&ball([x, 1.0], radius, radius / n, &options).unwrap());
        let half = half_ball([x, 1.0], radius, radius / n, &options).unwrap();
        assert_well_shaped(&half);
        assert_well_shaped(&mirrored(&half, 0, x).unwrap());
    }
}

/// Returns a deformed box mesh, whose boundary is neither convex nor flat.
fn bent<const D: usize>(n: usize, bend: f64) -> (SimplexMesh<D>, Vec<Point<D>>) {
    let mesh = structured_box([0.0; D], [1.0; D], [n; D]).expect("a sensible box");
    let positions = mesh
        .vertices()
        .iter()
        .map(|x| Point::from_fn(|k, _| x[k] + bend * (5.0 * x[(k + 1) % D] + k as f64).sin()))
        .collect();
    (mesh, positions)
}

/// Returns all barycentric lattice points of a facet.
fn lattice<const D: usize>(points: &[Point<D>], n: usize) -> Vec<Point<D>> {
    let mut all = Vec::new();
    for i in 0..=n {
        for j in 0..=(if D > 2 { n - i } else { 0 }) {
            let weights = if D > 2 { [i, j, n - i - j] } else { [i, n - i, 0] };
            all.push(points.iter().zip(weights).map(|(x, w)| x * (w as f64 / n as f64)).sum());
        }
    }
    all
}

fn closest_agrees_with_brute_force<const D: usize>(x: Point<D>, bend: f64) {
    let (mesh, positions) = bent::<D>(4, bend);
    let boundary = mesh.boundary();
    let placed = Placed::new(&boundary, &positions);
    let index = SurfaceIndex::new(&placed);
    let (closest, distance) = index.closest(&x).zip(index.signed_distance(&x)).expect("a surface with facets");

    // The barycentric coordinates agree with the point.
    let corners = placed.facet_points(closest.facet);
    let point: Point<D> = corners.iter().zip(&closest.barycentric).map(|(x, l)| x * *l).sum();
    assert!((point - closest.point).norm() < 1e-14);
    assert!(closest.barycentric.iter().all(|l| (0.0..=1.0).contains(l)));
    assert!((distance.abs() - (x - point).norm()).abs() < 1e-14);
    let carrying = closest.barycentric.iter().filter(|l| **l > 0.0).count();
    match closest.feature {
        Feature::Vertex(v) => assert!(carrying == 1 && point == positions[v.index()]),
        Feature::Edge(_) => assert!(carrying == 2 && D == 3),
        Feature::Facet => assert_eq!(carrying, D),
    }
    // No other point is closer.
    for facet in boundary.facets() {
        for other in lattice(&placed.facet_points(facet)[..D], 12) {
            assert!((x - other).norm() > distance.abs() - 1e-13);
        }
    }
    // The sign is that of the cells.
    let inside = mesh.cell_index_at(&positions).locate(&x).is_some();
    assert!(distance.abs() < 1e-8 || inside == (distance < 0.0));
}

fn search_agrees_with_brute_force<const D: usize>(x: Point<D>, side: f64, bend: f64) {
    let (mesh, positions) = bent::<D>(5, bend);
    let cells = mesh.cell_index_at(&positions);
    let expected = mesh.cells().find_map(|c| {
        let barycentric = mesh.simplex_at(c, &positions).barycentric(&x)?;
        barycentric.iter().all(|&l| l >= -1e-10).then_some((c, barycentric))
    });
    assert_eq!(cells.locate(&x), expected);

    let max = x + Point::repeat(side);
    let meets = |points: &[Point<D>]| {
        (0..D).all(|k| points.iter().any(|p| p[k] <= max[k]) && points.iter().any(|p| p[k] >= x[k]))
    };
    let mut found = vec![CellId(7)];
    cells.cells_overlapping(&Aabb { low: x, high: max }, &mut found);
    let expected: Vec<CellId> = mesh.cells().filter(|&c| meets(mesh.simplex_at(c, &positions).points())).collect();
    assert_eq!(found, expected);

    let boundary = mesh.boundary();
    let placed = Placed::new(&boundary, &positions);
    let mut found = Vec::new();
    SurfaceIndex::new(&placed).facets_overlapping(&Aabb { low: x, high: max }, &mut found);
    let expected: Vec<FacetId> = boundary.facets().filter(|&f| meets(&placed.facet_points(f)[..D])).collect();
    assert_eq!(found, expected);
}

proptest! {
    #![proptest_config(few_cases(200))]

    #[test]
    fn closest_points(x in prop::array::uniform3(-0.5..1.5_f64), bend in 0.0..0.1_f64) {
        closest_agrees_with_brute_force(Point::<2>::new(x[0], x[1]), bend);
        closest_agrees_with_brute_force(Point::<3>::from(x), bend);
    }

    #[test]
    fn cells_and_facets_near_a_box(x in prop::array::uniform3(-0.2..1.2_f64), side in 0.0..0.5_f64, bend in 0.0..0.1_f64) {
        search_agrees_with_brute_force(Point::<2>::new(x[0], x[1]), side, bend);
        search_agrees_with_brute_force(Point::<3>::from(x), side, bend);
    }
}

#[test]
fn vertices_are_located_in_their_lowest_cell() {
    let mesh = graded_box([0.0, 0.0], [1.0, 1.0], &Size::uniform(0.1)).unwrap();
    let index = mesh.cell_index();
    for v in (0..mesh.n_vertices()).map(VertexId::new) {
        let lowest = mesh.cells().find(|&c| mesh.cell(c).contains(&v));
        assert_eq!(index.locate(&mesh.vertex(v)).map(|(c, _)| c), lowest);
    }
    assert!(index.locate(&Point::<2>::new(1.1, 0.5)).is_none());
    assert!(index.locate(&Point::<2>::new(f64::NAN, 0.5)).is_none());
}

/// Checks the distance of two facets, on either side of a plane, by the distances of points in them.
fn distance_agrees_with_points<const D: usize>(numbers: &[f64]) {
    let corner = |k: usize, side: f64| {
        let mut x = Point::<D>::from_fn(|axis, _| numbers[k * D + axis]);
        x[D - 1] = side * (0.01 + x[D - 1].abs());
        x
    };
    let a: Vec<_> = (0..D).map(|k| corner(k, 1.0)).collect();
    let b: Vec<_> = (D..2 * D).map(|k| corner(k, -1.0)).collect();
    const N: usize = 24;
    let points = |facet: &[Point<D>]| {
        let mut points = Vec::new();
        for i in 0..=N {
            for j in 0..=(if D == 3 { N - i } else { 0 }) {
                let [s, t] = [i, j].map(|k| k as f64 / N as f64);
                points.push(facet[0] * (1.0 - s - t) + facet[1] * s + facet[D - 1] * t);
            }
        }
        points
    };
    let (of_a, of_b) = (points(&a), points(&b));
    let smallest = of_a.iter().flat_map(|x| of_b.iter().map(move |y| (x - y).norm())).fold(f64::INFINITY, f64::min);
    let longest = [&a, &b].iter().flat_map(|f| f.iter().map(|x| (x - f[0]).norm())).fold(0.0, f64::max);
    assert!(facets_are_within(smallest + 1e-12, &a, &b) && facets_are_within(smallest + 1e-12, &b, &a), "{smallest}");
    assert!(!facets_are_within((smallest - 4.0 * longest / N as f64).max(0.0), &a, &b), "{smallest}");
}

proptest! {
    #![proptest_config(few_cases(200))]

    #[test]
    fn distances_of_facets(numbers in prop::collection::vec(-1.0..1.0_f64, 18)) {
        distance_agrees_with_points::<2>(&numbers);
        distance_agrees_with_points::<3>(&numbers);
    }
}

#[test]
fn edges_that_pass_each_other_have_their_distance() {
    let a = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 5.0]].map(Point::<3>::from);
    let b = [[0.0, -1.0, -0.1], [0.0, 1.0, -0.1], [0.0, 0.0, -5.0]].map(Point::<3>::from);
    assert!(facets_are_within(0.1 + 1e-15, &a, &b) && !facets_are_within(0.1 - 1e-15, &a, &b));
    // A facet through the middle of another one.
    let through = [[0.1, 0.0, 9.0], [0.1, 0.0, -3.0], [9.0, 0.0, -3.0]].map(Point::<3>::from);
    let flat = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]].map(Point::<3>::from);
    assert!(facets_are_within(1e-15, &through, &flat) && facets_are_within(1e-15, &flat, &through));
    let [left, right] = [[[0.0, 0.0], [4.0, 1.0]], [[2.0, -3.0], [2.1, 5.0]]].map(|x| x.map(Point::<2>::from));
    assert!(facets_are_within(1e-15, &left, &right));
}

#[test]
fn a_single_facet_can_be_searched() {
    let boundary = BoundaryMesh::<2>::from_facets(vec![VertexId(0), VertexId(1)]);
    let positions = [Point::<2>::new(0.0, 0.0), Point::<2>::new(1.0, 0.0)];
    let index = SurfaceIndex::new(&Placed::new(&boundary, &positions));
    let x = Point::<2>::new(0.25, 2.0);
    assert_eq!(index.closest(&x).unwrap().barycentric, [0.75, 0.25, 0.0]);
    assert_eq!(index.signed_distance(&x), Some(-2.0));
}
