//! Bodies of any shape in degenerate positions: the overlay returns an error, or a cut that satisfies all identities.

#![no_main]

#[path = "../../crates/cutcell/tests/identities/mod.rs"]
mod identities;

use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, VertexId};

/// A coordinate on a plane of the background, near one, or any number.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Coordinate {
    Plane(u8),
    Near(u8, u8, bool),
    Any(f64),
}

impl Coordinate {
    fn value(self) -> f64 {
        let plane = |k: u8| f64::from(k % 13) / 12.0;
        match self {
            Self::Plane(k) => plane(k),
            Self::Near(k, size, is_negative) => {
                let shift = 10.0_f64.powi(-i32::from(size % 19));
                plane(k) + if is_negative { -shift } else { shift }
            }
            // The accuracy of a facet is relative to its size. For coordinates above a thousand, identities hold with
            // fewer digits than are checked.
            Self::Any(x) if x.abs() < 1e9 => x % 1e3,
            Self::Any(x) => x,
        }
    }
}

#[derive(Arbitrary, Clone, Debug)]
enum Body {
    Simplex([[Coordinate; 3]; 4]),
    Box([[Coordinate; 3]; 2]),
    /// Facets between any of the points.
    Facets([[Coordinate; 3]; 5], Vec<[u8; 3]>),
}

impl Body {
    fn surface<const D: usize>(&self) -> (Vec<Point<D>>, BoundaryMesh<D>) {
        let point = |x: &[Coordinate; 3]| Point::<D>::from_fn(|k, _| x[k].value());
        match self {
            Self::Simplex(corners) => {
                let mut positions: Vec<Point<D>> = corners[..=D].iter().map(point).collect();
                if mesh::Simplex::new(&positions).volume() < 0.0 {
                    positions.swap(0, 1);
                }
                let facets: &[u32] =
                    if D == 2 { &[0, 1, 1, 2, 2, 0] } else { &[1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1] };
                (positions, boundary(facets.iter().copied()))
            }
            Self::Box([a, b]) => {
                let (low, high) = (point(a).inf(&point(b)), point(a).sup(&point(b)));
                let corner = |k: usize| Point::<D>::from_fn(|i, _| if k >> i & 1 == 0 { low[i] } else { high[i] });
                let positions = (0..1 << D).map(corner).collect();
                if D == 2 {
                    return (positions, boundary([0, 1, 1, 3, 3, 2, 2, 0]));
                }
                let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
                (positions, boundary(squares.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d])))
            }
            Self::Facets(points, facets) => {
                let corners = facets.iter().take(12).flat_map(|facet| facet[..D].iter().map(|&k| u32::from(k) % 5));
                (points.iter().map(point).collect(), boundary(corners))
            }
        }
    }
}

fn boundary<const D: usize>(corners: impl IntoIterator<Item = u32>) -> BoundaryMesh<D> {
    BoundaryMesh::from_facets(corners.into_iter().map(VertexId).collect())
}

fn check<const D: usize>(bodies: &[Body]) {
    let background = structured_box::<D>([0.0; D], [1.0; D], [3; D]).expect("a box");
    let surfaces: Vec<_> = bodies.iter().map(Body::surface::<D>).collect();
    let placed: Vec<_> = surfaces.iter().map(|(positions, boundary)| Placed::new(boundary, positions)).collect();
    if let Ok(cut) = CutMesh::overlay(&background, &placed, &OverlayOptions::new()) {
        check_identities(&background, &cut);
    }
}

fuzz_target!(|data: (bool, Vec<Body>)| {
    let (is_plane, mut bodies) = data;
    bodies.truncate(3);
    if is_plane { check::<2>(&bodies) } else { check::<3>(&bodies) }
});
