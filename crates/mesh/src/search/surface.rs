//! Closest points of a surface, and the side on which a point lies.

use super::closest::{Feature, Foot, TIE, VertexToFacet};
use super::parry::BoxTree;
use crate::{Aabb, BoundaryMesh, FacetId, MAX_FACET_VERTICES, Placed, Point, Vector, VertexId};

/// The point of a surface closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint<const D: usize> {
    /// The point on the surface.
    pub point: Point<D>,
    /// A facet that contains this point.
    pub facet: FacetId,
    /// Barycentric coordinates in that facet; only the first `D` entries are used.
    pub barycentric: [f64; MAX_FACET_VERTICES],
    /// Whether the point lies inside the facet, on an edge or on a vertex.
    pub feature: Feature,
}

impl<const D: usize> ClosestPoint<D> {
    /// Returns a radius around `x`, the point whose closest point this is, within which all equally close facets lie;
    /// see [`Foot::is_preferred_to`].
    pub fn reach(&self, x: &Point<D>) -> f64 {
        (self.point - x).norm() * (1.0 + TIE)
    }
}

/// Search structure for the facets of a surface at fixed positions.
///
/// Signed distances are correct for closed surfaces whose neighbouring facets share vertices. Facets of measure zero
/// are allowed.
#[derive(Clone)]
pub struct SurfaceIndex<const D: usize> {
    boundary: BoundaryMesh<D>,
    positions: Vec<Point<D>>,
    vertex_to_facet: VertexToFacet,
    tree: BoxTree<D>,
}

impl<const D: usize> std::fmt::Debug for SurfaceIndex<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SurfaceIndex").field("n_facets", &self.boundary.n_facets()).finish_non_exhaustive()
    }
}

impl<const D: usize> SurfaceIndex<D> {
    /// Builds the index of a surface at its current positions, which are copied.
    pub fn new(surface: &Placed<'_, D>) -> Self {
        let boundary = surface.boundary().clone();
        let facet_bounds = |facet| Aabb::of_points(&surface.facet_points(facet)[..D]);
        let tree = BoxTree::new(boundary.facets().map(facet_bounds));
        let vertex_to_facet = VertexToFacet::new(&boundary);
        Self { boundary, positions: surface.positions().to_vec(), vertex_to_facet, tree }
    }

    /// Returns the surface.
    pub fn surface(&self) -> Placed<'_, D> {
        Placed::new(&self.boundary, &self.positions)
    }

    /// Returns the closest point of the surface, or `None` if the surface has no facets or `x` is not finite.
    ///
    /// If several points are equally close, the choice among them is deterministic.
    pub fn closest(&self, x: &Point<D>) -> Option<ClosestPoint<D>> {
        if x.iter().any(|c| !c.is_finite()) {
            return None;
        }
        let surface = self.surface();
        let foot = |facet| Foot::on_facet(x, &surface.facet_points(facet)[..D]);
        let facet = FacetId(self.tree.nearest(x, |leaf| foot(FacetId(leaf)).squared_distance.sqrt())?);
        let foot = foot(facet);
        let feature = Feature::spanned(self.boundary.facet(facet), |k| foot.barycentric[k] > 0.0);
        Some(ClosestPoint { point: foot.point, facet, barycentric: foot.barycentric, feature })
    }

    /// Returns the distance from the surface, positive outside of the solid and negative inside, or `None` as
    /// [`SurfaceIndex::closest`] does.
    ///
    /// The sign is correct for every closed surface that does not intersect itself, see
    /// [`VertexToFacet::pseudo_normal`].
    pub fn signed_distance(&self, x: &Point<D>) -> Option<f64> {
        let closest = self.closest(x)?;
        let offset = x - closest.point;
        let along = offset.dot(&self.pseudo_normal(&closest));
        Some(match closest.feature {
            Feature::Facet => along,
            _ if along < 0.0 => -offset.norm(),
            _ => offset.norm(),
        })
    }

    fn pseudo_normal(&self, at: &ClosestPoint<D>) -> Vector<D> {
        let position = |vertex: VertexId| self.positions[vertex.index()];
        self.vertex_to_facet.pseudo_normal(&self.boundary, position, at.facet, at.feature)
    }

    /// Replaces `out` by all facets whose bounding boxes overlap `region`, in ascending order.
    ///
    /// Bounding boxes are slightly inflated: every facet that meets the region is found, and possibly a few others.
    pub fn facets_overlapping(&self, region: &Aabb<D>, out: &mut Vec<FacetId>) {
        out.clear();
        self.tree.overlapping(region, |leaf| out.push(FacetId(leaf)));
        out.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::structured_box;

    #[test]
    fn a_corner_has_features_and_distances() {
        let mesh = structured_box([0.0, 0.0], [1.0, 1.0], [1, 1]).unwrap();
        let boundary = mesh.boundary();
        let index = SurfaceIndex::new(&Placed::new(&boundary, mesh.vertices()));
        let at = |x: f64, y: f64| {
            let x = Point::<2>::new(x, y);
            (index.closest(&x).unwrap(), index.signed_distance(&x).unwrap())
        };
        let (beside, distance) = at(1.5, 0.25);
        assert_eq!((beside.feature, beside.point, distance), (Feature::Facet, Point::<2>::new(1.0, 0.25), 0.5));
        let (off_corner, distance) = at(4.0, 5.0);
        assert!(matches!(off_corner.feature, Feature::Vertex(_)) && (distance - 5.0).abs() < 1e-14);
        let (on_corner, distance) = at(1.0, 1.0);
        assert_eq!(distance, 0.0);
        assert!((index.pseudo_normal(&on_corner) - Vector::<2>::repeat(0.5_f64.sqrt())).norm() < 1e-14);
        assert_eq!(at(0.5, 0.125).1, -0.125);
    }

    #[test]
    fn a_reentrant_corner_points_out_of_the_solid() {
        // An arrow head: the vertex at the origin is re-entrant.
        let positions = [(0.0, 0.0), (2.0, -1.0), (0.0, 3.0), (-2.0, -1.0)].map(|(x, y)| Point::<2>::new(x, y));
        let boundary = BoundaryMesh::<2>::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
        let index = SurfaceIndex::new(&Placed::new(&boundary, &positions));
        let inside = Point::<2>::new(0.0, 0.5);
        assert_eq!(index.closest(&inside).unwrap().feature, Feature::Vertex(VertexId(0)));
        assert_eq!(index.signed_distance(&inside), Some(-0.5));
        assert!(index.signed_distance(&Point::<2>::new(0.0, -0.5)).unwrap() > 0.0);
    }

    #[test]
    fn a_cube_has_edges() {
        let mesh = structured_box([0.0; 3], [1.0; 3], [1; 3]).unwrap();
        let boundary = mesh.boundary();
        let index = SurfaceIndex::new(&Placed::new(&boundary, mesh.vertices()));
        let beyond = Point::<3>::new(1.3, 0.5, 1.4);
        assert_eq!(index.closest(&beyond).unwrap().feature, Feature::Edge([VertexId(5), VertexId(7)]));
        assert!((index.signed_distance(&beyond).unwrap() - 0.5).abs() < 1e-14);
        let normal = |x: Point<3>| index.pseudo_normal(&index.closest(&x).unwrap());
        let on_edge = Vector::<3>::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt());
        assert!((normal(Point::<3>::new(1.0, 0.5, 1.0)) - on_edge).norm() < 1e-14);
        assert!((normal(Point::<3>::repeat(1.0)) - Vector::<3>::repeat(1.0 / 3.0_f64.sqrt())).norm() < 1e-14);
    }

    #[test]
    fn nothing_is_closest_to_nowhere() {
        let empty = BoundaryMesh::<2>::from_facets(Vec::new());
        assert!(SurfaceIndex::new(&Placed::new(&empty, &[])).closest(&Point::<2>::zeros()).is_none());
        let one = BoundaryMesh::<2>::from_facets(vec![VertexId(0), VertexId(0)]);
        let index = SurfaceIndex::new(&Placed::new(&one, &[Point::<2>::new(1.0, 0.0)]));
        assert_eq!(index.signed_distance(&Point::<2>::zeros()), Some(1.0));
        assert!(index.closest(&Point::<2>::new(f64::NAN, 0.0)).is_none());
    }
}
