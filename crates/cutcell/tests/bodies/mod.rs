//! Closed surfaces and their overlays, in 2D and 3D.
#![allow(dead_code)]

use cutcell::{CutMesh, OverlayOptions};
use mesh::{BoundaryMesh, Placed, Point, SimplexMesh, Vector, VertexId};

use crate::identities::check_identities;

/// Corners and oriented facets of a closed surface.
pub(crate) struct TestBody<const D: usize> {
    pub(crate) positions: Vec<Point<D>>,
    pub(crate) boundary: BoundaryMesh<D>,
}

impl TestBody<2> {
    /// Creates a closed polygon, counter-clockwise.
    pub(crate) fn polygon(positions: Vec<Point<2>>) -> Self {
        let n = positions.len() as u32;
        Self::new(positions, (0..n).flat_map(|k| [k, (k + 1) % n]))
    }
}

impl<const D: usize> TestBody<D> {
    pub(crate) fn new(positions: Vec<Point<D>>, facets: impl IntoIterator<Item = u32>) -> Self {
        Self { positions, boundary: BoundaryMesh::from_facets(facets.into_iter().map(VertexId).collect()) }
    }

    /// Returns a simplex with positive orientation.
    pub(crate) fn simplex(mut corners: Vec<Point<D>>) -> Self {
        if mesh::Simplex::new(&corners).volume() < 0.0 {
            corners.swap(0, 1);
        }
        match D {
            2 => Self::new(corners, [0, 1, 1, 2, 2, 0]),
            _ => Self::new(corners, [1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1]),
        }
    }

    /// Returns a box from corner to corner.
    pub(crate) fn cuboid(low: Point<D>, high: Point<D>) -> Self {
        let corner = |k: usize| Point::<D>::from_fn(|i, _| if k >> i & 1 == 0 { low[i] } else { high[i] });
        let positions = (0..1 << D).map(corner).collect();
        if D == 2 {
            return Self::new(positions, [0, 1, 1, 3, 3, 2, 2, 0]);
        }
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Self::new(positions, squares.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]))
    }

    pub(crate) fn moved(&self, map: impl Fn(&Point<D>) -> Point<D>) -> Self {
        Self { boundary: self.boundary.clone(), positions: self.positions.iter().map(map).collect() }
    }

    pub(crate) fn placed(&self) -> Placed<'_, D> {
        Placed::new(&self.boundary, &self.positions)
    }

    pub(crate) fn volume(&self) -> f64 {
        self.placed().enclosed().volume
    }
}

pub(crate) fn overlay<const D: usize>(background: &SimplexMesh<D>, bodies: &[&TestBody<D>]) -> CutMesh<D> {
    let placed: Vec<_> = bodies.iter().map(|body| body.placed()).collect();
    CutMesh::overlay(background, &placed, &OverlayOptions::new()).expect("sound surfaces")
}

/// Checks identities, and the volume of the fluid around a union of bodies of known volume.
pub(crate) fn check_union<const D: usize>(
    background: &SimplexMesh<D>,
    bodies: &[&TestBody<D>],
    union: f64,
) -> CutMesh<D> {
    let cut = overlay(background, bodies);
    check_identities(background, &cut);
    let (fluid, domain) = (cut.fluid_volume(), background.volume());
    assert!((fluid - (domain - union)).abs() < 1e-12 * domain, "fluid {fluid}, expected {}", domain - union);
    cut
}

/// Checks a body inside the background: its normals sum to zero and its whole surface is wet.
pub(crate) fn check_immersed<const D: usize>(background: &SimplexMesh<D>, body: &TestBody<D>) {
    let cut = check_union(background, &[body], body.volume());
    let normals: Vector<D> = cut.interface().iter().map(|p| p.normal * p.measure).sum();
    let area: f64 = cut.interface().iter().map(|p| p.measure).sum();
    let placed = body.placed();
    let exact: f64 = body.boundary.facets().map(|f| placed.facet_measure(f)).sum();
    // Coordinates of about one carry round-off of 1e-16; points within 1e-13 of a mesh line may count as on it.
    let tolerance = 1e-12 * exact + if D == 2 { 1e-14 } else { 0.0 };
    assert!(normals.norm() < tolerance && (area - exact).abs() < 10.0 * tolerance, "{normals} {area} {exact}");
    for piece in cut.interface() {
        let corners = placed.facet_points(piece.facet);
        for (x, barycentric) in piece.points[..D].iter().zip(&piece.barycentric) {
            let there: Point<D> = corners.iter().zip(barycentric).map(|(corner, l)| corner * *l).sum();
            assert!((there - x).norm() < 1e-12);
        }
    }
}
