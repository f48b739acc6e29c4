//! Regions between lines, and balls in space.

mod common;

use std::f64::consts::PI;

use common::{assert_sound, smallest_angle, volume};
use mesh::generate::{BallOptions, ClosedLine, Region, RegionShape, ball, inside, refined_inside};
use mesh::{Aabb, Error, Point, SimplexMesh};

fn named(name: &str) -> impl Fn(usize) -> String {
    let name = name.to_owned();
    move |k| format!("{name}-{k}")
}

/// An L with a square hole, and holes in the form of a circle and a capsule.
fn plate(h: f64) -> Vec<ClosedLine> {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.5], [1.5, 1.5], [1.5, 4.0], [0.0, 4.0]];
    let hole = [[0.4, 0.4], [0.4, 1.0], [1.0, 1.0], [1.0, 0.4]];
    vec![
        ClosedLine::polygon(&corners, h, named("side")).expect("a line"),
        ClosedLine::polygon(&hole, h, named("hole")).expect("a line"),
        ClosedLine::circle([2.2, 0.75], 0.4, h, "circle").expect("a line"),
        ClosedLine::capsule([[0.75, 2.0], [0.75, 3.0]], 0.3, h, "capsule").expect("a line"),
    ]
}

#[test]
fn regions_between_lines_are_filled() {
    for h in [0.3, 0.1, 0.04] {
        let lines = plate(h);
        let mesh: SimplexMesh<2> = inside(&lines, h).unwrap();
        assert_sound(&mesh);
        let degrees = smallest_angle(&mesh);
        assert!(degrees >= 20.0, "{degrees} degrees at {h}");
        let areas: Vec<f64> = lines.iter().map(ClosedLine::area).collect();
        assert!((areas[0] - 9.75).abs() < 1e-12 && (areas[1] + 0.36).abs() < 1e-12);
        assert!((volume(&mesh) - (areas[0] + areas[1] - areas[2] - areas[3])).abs() < 1e-11);
        let mean = mesh.cells().map(|cell| mesh.simplex(cell).diameter()).sum::<f64>() / mesh.n_cells() as f64;
        assert!((0.85..1.15).contains(&(mean / h)), "{mean} at {h}");
        // Segments are facets with the names of their sides.
        let points: Vec<[f64; 2]> = lines.iter().flat_map(|line| line.points.clone()).collect();
        assert!(points.iter().zip(mesh.vertices()).all(|(a, b)| a[..] == *b.as_slice()));
        let facets_of = |name: &str| {
            let tag = mesh.tag(name).unwrap();
            mesh.facets().filter(|facet| mesh.facet_tag(*facet) == Some(tag)).collect::<Vec<_>>()
        };
        assert!(facets_of("side-3").iter().flat_map(|f| mesh.facet(*f)).all(|v| mesh.vertex(*v)[0] == 1.5));
        let length: f64 = facets_of("hole-1").iter().map(|facet| mesh.facet_measure(*facet)).sum();
        assert!((length - 0.6).abs() < 1e-12);
        assert_eq!(facets_of("circle").len(), lines[2].points.len());
    }
}

#[test]
fn regions_between_lines_are_finer_near_regions() {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.5], [1.5, 1.5], [1.5, 4.0], [0.0, 4.0]];
    let hole = [[3.3, 0.75], [2.9, 1.0], [2.5, 0.75], [2.9, 0.5]];
    let regions = [
        Region { shape: RegionShape::Segment { ends: [[1.5, 1.5].into(); 2], within: 0.1 }, size: 0.02, growth: 0.2 },
        Region {
            shape: RegionShape::Box(Aabb { low: [3.2, 0.0].into(), high: [4.0, 0.75].into() }),
            size: 0.08,
            growth: 0.3,
        },
    ];
    let size = |x: &Point<2>| regions.iter().map(|region| region.at(x)).fold(0.3, f64::min);
    let at = |x: [f64; 2]| size(&x.into());
    let lines = [
        ClosedLine::graded_polygon(&corners, &at, named("side")).expect("a line"),
        ClosedLine::graded_smooth(&hole, &at, "hole").expect("a line"),
    ];
    let mesh: SimplexMesh<2> = refined_inside(&lines, 0.3, &regions).expect("a mesh");
    assert_sound(&mesh);
    assert!(smallest_angle(&mesh) >= 20.0, "{}", smallest_angle(&mesh));
    assert!((volume(&mesh) - (lines[0].area() - lines[1].area().abs())).abs() < 1e-12);
    // Diameters follow the size everywhere, and in the mean.
    let relative = mesh.cells().map(|cell| {
        let simplex = mesh.simplex(cell);
        simplex.diameter() / size(&simplex.centroid())
    });
    let relative: Vec<f64> = relative.collect();
    let mean = relative.iter().sum::<f64>() / relative.len() as f64;
    let largest = relative.iter().copied().fold(0.0, f64::max);
    assert!((0.85..1.15).contains(&mean) && largest < 2.0, "{mean} {largest}");
    // The hole follows the spline of its corners, and every side has its name.
    let spline = ClosedLine::smooth(&hole, 1e-3, "hole").expect("a line");
    let off =
        |x: &[f64; 2]| spline.points.iter().map(|y| (x[0] - y[0]).hypot(x[1] - y[1])).fold(f64::INFINITY, f64::min);
    assert!(lines[1].points.iter().map(off).fold(0.0, f64::max) < 1e-3);
    assert!(mesh.facets().all(|facet| mesh.is_boundary(facet) == mesh.facet_tag(facet).is_some()));
    let plain = [ClosedLine::polygon(&corners, 0.3, named("side")).expect("a line")];
    let outside =
        Region { shape: RegionShape::Segment { ends: [[9.0, 0.0].into(); 2], within: 0.1 }, ..regions[0].clone() };
    assert!(matches!(refined_inside(&plain, 0.3, &[outside]), Err(Error::Parameter(_))));
}

#[test]
fn curves_are_followed_by_segments_of_equal_length() {
    // The spline through points of an ellipse differs from it by the fourth power of their distance.
    let error = |n: usize| {
        let corner = |k: usize| (2.0 * PI * k as f64 / n as f64).sin_cos();
        let corners: Vec<[f64; 2]> = (0..n).map(corner).map(|(s, c)| [2.0 * c, s]).collect();
        let line = ClosedLine::smooth(&corners, 0.05, "skin").unwrap();
        let lengths: Vec<f64> = (0..line.points.len())
            .map(|k| {
                let (a, b) = (line.points[k], line.points[(k + 1) % line.points.len()]);
                (a[0] - b[0]).hypot(a[1] - b[1])
            })
            .collect();
        let (shortest, longest) =
            (lengths.iter().copied().fold(1.0, f64::min), lengths.iter().copied().fold(0.0, f64::max));
        assert!(longest <= 0.05 && shortest > 0.995 * longest, "{shortest} {longest}");
        let off = |x: &[f64; 2]| ((x[0] / 2.0).powi(2) + x[1].powi(2) - 1.0).abs();
        assert!(line.area() > 0.0 && line.clone().reversed().area() < 0.0);
        line.points.iter().chain(&line.middles).map(off).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(12), error(24));
    assert!(fine < 1e-3 && fine < coarse / 10.0, "{coarse} {fine}");
    let capsule = ClosedLine::capsule([[1.0, 1.0], [4.0, 5.0]], 0.5, 0.01, "skin").unwrap();
    assert!((capsule.area() - (5.0 + 0.25 * PI)).abs() < 1e-4);
    assert_eq!(capsule.points.len(), capsule.middles.len());
}

#[test]
fn lines_that_bound_no_region_are_errors() {
    let polygon = |corners: &[[f64; 2]]| ClosedLine::polygon(corners, 0.2, named("side")).unwrap();
    let square = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let bow = polygon(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.1], [1.3, 0.9]]);
    let outside = polygon(&[[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]);
    let across = polygon(&[[0.5, 0.5], [1.5, 0.4], [1.5, 0.6]]);
    let reason = |lines: &[ClosedLine]| inside::<2>(lines, 0.2).map(|_| ()).unwrap_err().to_string();
    assert!(reason(&[bow]).contains("cross or touch"));
    assert!(reason(&[square.clone(), outside]).contains("hole is not inside"));
    let crossing = reason(&[square.clone(), across]);
    assert!(crossing.contains("cross or touch"), "{crossing}");
    assert!(reason(&[square.clone(), square.clone()]).contains("coincide"));
    let square = [square];
    assert!(inside::<2>(&square, 0.0).is_err() && inside::<2>(&square, 1e-9).is_err());
    assert!(matches!(inside::<3>(&square, 0.2), Err(Error::Dimension { .. })));
    for corners in [vec![[0.0, 0.0], [1.0, 0.0]], vec![[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]] {
        assert!(ClosedLine::polygon(&corners, 0.2, named("side")).is_err());
        assert!(ClosedLine::smooth(&corners, 0.2, "side").is_err());
    }
    assert!(ClosedLine::smooth(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]], 0.2, "side").is_err());
    assert!(ClosedLine::circle([0.0, 0.0], -1.0, 0.2, "side").is_err());
    assert!(ClosedLine::capsule([[0.0, 0.0]; 2], 1.0, 0.2, "side").is_err());
    assert!(ClosedLine::polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], 1e-9, named("side")).is_err());
}

#[test]
fn balls_in_space_are_round() {
    let centre = Point::<3>::new(1.0, -2.0, 0.5);
    let mut errors = Vec::new();
    for h in [1.26, 0.63, 0.315] {
        let mesh = ball(centre.into(), 2.0, h, &BallOptions::default()).unwrap();
        assert_sound(&mesh);
        let boundary = mesh.boundary();
        for vertex in boundary.facets().flat_map(|facet| boundary.facet(facet)) {
            assert!(((mesh.vertex(*vertex) - centre).norm() - 2.0).abs() < 1e-14);
        }
        let mut edges = 0.0;
        let mut flattest = 1.0_f64;
        for cell in mesh.cells() {
            let x = mesh.simplex(cell);
            let x = x.points();
            edges += (0..4).flat_map(|a| (0..a).map(move |b| (x[a] - x[b]).norm())).sum::<f64>() / 6.0;
            let longest = mesh.simplex(cell).diameter();
            flattest = flattest.min(mesh.cell_volume(cell) / longest.powi(3));
        }
        let mean = edges / mesh.n_cells() as f64;
        // Edges have few lengths, so that few sizes can be met closely. A regular tetrahedron has a flatness of 0.118,
        // those of a brick 0.032.
        assert!((0.8..1.2).contains(&(mean / h)) && flattest > 0.02, "{mean} at {h}: {flattest}");
        errors.push(32.0 / 3.0 * PI - volume(&mesh));
    }
    assert!(errors.windows(2).all(|pair| (3.5..4.6).contains(&(pair[0] / pair[1]))), "{errors:?}");
    let mesh = ball::<3>([0.0; 3], 2.0, 0.5, &BallOptions { area_preserving: true }).unwrap();
    assert!((volume(&mesh) - 32.0 / 3.0 * PI).abs() < 1e-11);
}
