//! A boundary seen at positions in time.

use crate::{BoundaryMesh, FacetId, MAX_CELL_VERTICES, Point, Vector, simplex_measure};

/// A boundary with borrowed positions of its vertices: the current configuration is a view, never a second mesh.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'m, const D: usize> {
    boundary: &'m BoundaryMesh<D>,
    positions: &'m [Point<D>],
}

impl<'m, const D: usize> Placed<'m, D> {
    /// The boundary at the given positions (one per vertex of the mesh whose vertices the boundary names). Segments of a
    /// plane boundary run counter-clockwise around the body, triangles turn counter-clockwise as seen from outside.
    ///
    /// What is done with the surface panics if there are fewer positions than vertices.
    pub fn new(boundary: &'m BoundaryMesh<D>, positions: &'m [Point<D>]) -> Self {
        Self { boundary, positions }
    }

    /// The boundary itself.
    pub fn boundary(&self) -> &'m BoundaryMesh<D> {
        self.boundary
    }

    /// Positions of the vertices.
    pub fn positions(&self) -> &'m [Point<D>] {
        self.positions
    }

    /// Points of a facet; the first `D` count.
    #[inline]
    pub fn facet_points(&self, facet: FacetId) -> [Point<D>; MAX_CELL_VERTICES] {
        let mut points = [Point::zeros(); MAX_CELL_VERTICES];
        for (slot, v) in points.iter_mut().zip(self.boundary.facet(facet)) {
            *slot = self.positions[v.index()];
        }
        points
    }

    /// Measure (length, area) of a facet.
    pub fn facet_measure(&self, facet: FacetId) -> f64 {
        simplex_measure(&self.facet_points(facet)[..D])
    }

    /// Normal of a facet, out of the solid, with the measure of the facet as its length (times two in 3D: the
    /// plain cross product). Zero for a degenerate facet.
    #[inline]
    pub fn facet_normal_scaled(&self, facet: FacetId) -> Vector<D> {
        scaled_normal(&self.facet_points(facet)[..D])
    }

    /// Unit normal of a facet, out of the solid; zero for a degenerate facet.
    #[inline]
    pub fn facet_normal(&self, facet: FacetId) -> Vector<D> {
        facet_normal(&self.facet_points(facet)[..D])
    }

    /// Volume enclosed by the surface, by the divergence theorem; positive when normals point outwards.
    pub fn enclosed_volume(&self) -> f64 {
        let origin = self.boundary.facets().next().map_or(Point::zeros(), |f| self.facet_points(f)[0]);
        let double = if D == 3 { 0.5 } else { 1.0 };
        self.boundary
            .facets()
            .map(|f| {
                let points = self.facet_points(f);
                let centroid = points[..D].iter().sum::<Point<D>>() / D as f64;
                (centroid - origin).dot(&self.facet_normal_scaled(f)) * double / D as f64
            })
            .sum()
    }
}

/// Unit normal of an oriented facet (segment, triangle): right of the segment, right-hand rule for the triangle;
/// zero for a degenerate facet.
#[inline]
pub fn facet_normal<const D: usize>(points: &[Point<D>]) -> Vector<D> {
    let n = scaled_normal(points);
    let length = n.norm();
    if length > 0.0 { n / length } else { n }
}

/// Normal of an oriented facet (segment, triangle): right of the segment, right-hand rule for the triangle.
#[inline]
pub(crate) fn scaled_normal<const D: usize>(points: &[Point<D>]) -> Vector<D> {
    let mut n = Vector::zeros();
    let a = points[1] - points[0];
    match D {
        2 => {
            n[0] = a[1];
            n[1] = -a[0];
        }
        3 => {
            let b = points[2] - points[0];
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                n[k] = a[i] * b[j] - a[j] * b[i];
            }
        }
        _ => unreachable!("facets are of dimension 1 or 2"),
    }
    n
}
