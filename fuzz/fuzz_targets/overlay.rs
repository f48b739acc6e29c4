//! Bodies of any shape in degenerate positions: the overlay returns an error, or a cut that satisfies all identities.

#![no_main]

#[path = "../../crates/cutcell/tests/bodies/mod.rs"]
mod bodies;
#[path = "../../crates/cutcell/tests/identities/mod.rs"]
mod identities;

use bodies::Body;
use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use mesh::Point;
use mesh::generate::structured_box;

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
enum Shape {
    Simplex([[Coordinate; 3]; 4]),
    Box([[Coordinate; 3]; 2]),
    /// Facets between any of the points.
    Facets([[Coordinate; 3]; 5], Vec<[u8; 3]>),
}

impl Shape {
    fn body<const D: usize>(&self) -> Body<D> {
        let point = |x: &[Coordinate; 3]| Point::<D>::from_fn(|k, _| x[k].value());
        match self {
            Self::Simplex(corners) => Body::simplex(corners[..=D].iter().map(point).collect()),
            Self::Box([a, b]) => Body::cuboid(point(a).inf(&point(b)), point(a).sup(&point(b))),
            Self::Facets(points, facets) => {
                let corners = facets.iter().take(12).flat_map(|facet| facet[..D].iter().map(|&k| u32::from(k) % 5));
                Body::new(points.iter().map(point).collect(), corners)
            }
        }
    }
}

fn check<const D: usize>(shapes: &[Shape]) {
    let background = structured_box::<D>([0.0; D], [1.0; D], [3; D]).expect("a box");
    let bodies: Vec<_> = shapes.iter().map(Shape::body::<D>).collect();
    let placed: Vec<_> = bodies.iter().map(Body::placed).collect();
    if let Ok(cut) = CutMesh::overlay(&background, &placed, &OverlayOptions::new()) {
        check_identities(&background, &cut);
    }
}

fuzz_target!(|data: (bool, Vec<Shape>)| {
    let (is_plane, mut shapes) = data;
    shapes.truncate(3);
    if is_plane { check::<2>(&shapes) } else { check::<3>(&shapes) }
});
