//! Closest points on a surface, and on which side of it a point lies.

use super::parry::BoxTree;
use crate::{FacetId, MAX_CELL_VERTICES, Placed, Point, Vector, VertexId};

/// Distances below this times the largest coordinate count as zero where a direction is taken from them.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// The part of a surface on which a closest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The interior of the facet.
    Facet,
    /// The interior of an edge of the facet (3D only), vertices in ascending order.
    Edge([VertexId; 2]),
    /// A vertex of the facet.
    Vertex(VertexId),
}

/// The point of a surface closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint<const D: usize> {
    /// The point on the surface.
    pub point: Point<D>,
    /// A facet that contains it.
    pub facet: FacetId,
    /// Barycentric coordinates of the point in that facet; the first `D` count, the others are zero.
    pub barycentric: [f64; MAX_CELL_VERTICES],
    /// Whether the point lies inside the facet, on an edge or on a vertex.
    pub feature: Feature,
}

/// The closest point of a surface together with side and direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedClosestPoint<const D: usize> {
    /// The closest point.
    pub closest: ClosestPoint<D>,
    /// Unit direction of growing distance, out of the solid.
    ///
    /// Inside a facet its normal; on an edge or a vertex the direction between the two points, or the
    /// angle-weighted pseudo-normal where they coincide.
    pub normal: Vector<D>,
    /// Distance, positive outside of the solid, negative inside.
    pub distance: f64,
}

/// The facets of a surface at fixed positions, arranged for search.
///
/// Facets that meet must share their vertices (the sign of the distance needs to know the neighbours), and the surface
/// should be closed. Facets without measure are allowed.
#[derive(Clone)]
pub struct SurfaceIndex<const D: usize> {
    /// Stride `D`, as the following.
    facet_to_vertex: Vec<VertexId>,
    points: Vec<Point<D>>,
    normals: Vec<Vector<D>>,
    /// Facets around vertex `v` are entries `offsets[v]` to `offsets[v + 1]` of `vertex_to_facet`.
    offsets: Vec<usize>,
    vertex_to_facet: Vec<FacetId>,
    tree: BoxTree<D>,
}

impl<const D: usize> std::fmt::Debug for SurfaceIndex<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SurfaceIndex").field("n_facets", &self.normals.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> SurfaceIndex<D> {
    /// The facets of the surface where it is now.
    pub fn new(surface: &Placed<'_, D>) -> Self {
        let boundary = surface.boundary();
        let facet_to_vertex: Vec<VertexId> =
            boundary.facets().flat_map(|f| boundary.facet(f).iter().copied()).collect();
        let points: Vec<Point<D>> = facet_to_vertex.iter().map(|v| surface.positions()[v.index()]).collect();
        let normals = boundary.facets().map(|f| surface.facet_normal(f)).collect();
        let (offsets, vertex_to_facet) = facets_around::<D>(&facet_to_vertex, surface.positions().len());
        let tree = BoxTree::around(points.chunks_exact(D));
        Self { facet_to_vertex, points, normals, offsets, vertex_to_facet, tree }
    }

    /// The closest point of the surface; `None` if the surface has no facets or `x` is not finite.
    ///
    /// Of several closest points one is given, always the same.
    pub fn closest(&self, x: &Point<D>) -> Option<ClosestPoint<D>> {
        if x.iter().any(|c| !c.is_finite()) {
            return None;
        }
        let distance = |leaf| {
            let points = self.facet_points(FacetId(leaf));
            (x - combined(points, &closest_on_simplex(points, x))).norm()
        };
        let facet = FacetId(self.tree.nearest(x, distance)?);
        let points = self.facet_points(facet);
        let barycentric = closest_on_simplex(points, x);
        let feature = feature(self.facet(facet), &barycentric);
        Some(ClosestPoint { point: combined(points, &barycentric), facet, barycentric, feature })
    }

    /// The closest point with the signed distance to it; `None` as for [`SurfaceIndex::closest`].
    ///
    /// The sign is that of the facet's normal or, on edges and vertices, of the angle-weighted pseudo-normal, which is
    /// correct for every closed surface that does not cut itself.
    ///
    /// Source: Baerentzen-Aanaes 2005, DOI 10.1109/TVCG.2005.49.
    pub fn closest_signed(&self, x: &Point<D>) -> Option<SignedClosestPoint<D>> {
        let closest = self.closest(x)?;
        let outward = self.pseudo_normal(&closest);
        let offset = x - closest.point;
        let along = offset.dot(&outward);
        if closest.feature == Feature::Facet {
            return Some(SignedClosestPoint { closest, normal: outward, distance: along });
        }
        let distance = if along < 0.0 { -offset.norm() } else { offset.norm() };
        let meaningful = distance.abs() > ROUND_OFF * x.amax().max(closest.point.amax());
        let normal = if meaningful { offset / distance } else { outward };
        Some(SignedClosestPoint { closest, normal, distance })
    }

    /// Replaces `out` by all facets whose bounding boxes overlap the box from `min` to `max`, in ascending order.
    ///
    /// Boxes are inflated a little: no facet that meets the box is missing, a few that do not may be there.
    pub fn facets_overlapping(&self, min: &Point<D>, max: &Point<D>, out: &mut Vec<FacetId>) {
        out.clear();
        self.tree.overlapping(min, max, |leaf| out.push(FacetId(leaf)));
        out.sort_unstable();
    }

    fn facet(&self, facet: FacetId) -> &[VertexId] {
        &self.facet_to_vertex[facet.index() * D..][..D]
    }

    fn facet_points(&self, facet: FacetId) -> &[Point<D>] {
        &self.points[facet.index() * D..][..D]
    }

    /// Unit mean of the normals around the feature: equal weights at an edge, weighted by angle at a vertex.
    fn pseudo_normal(&self, closest: &ClosestPoint<D>) -> Vector<D> {
        let facet_normal = self.normals[closest.facet.index()];
        let sum: Vector<D> = match closest.feature {
            Feature::Facet => return facet_normal,
            Feature::Edge([a, b]) => {
                let meets = |&&f: &&FacetId| self.facet(f).contains(&b);
                self.facets_at(a).iter().filter(meets).map(|f| self.normals[f.index()]).sum()
            }
            Feature::Vertex(v) => self.facets_at(v).iter().map(|&f| self.normals[f.index()] * self.angle(f, v)).sum(),
        };
        // Normals cancel where the surface folds onto itself; then any of them will do.
        sum.try_normalize(ROUND_OFF).unwrap_or(facet_normal)
    }

    fn facets_at(&self, vertex: VertexId) -> &[FacetId] {
        &self.vertex_to_facet[self.offsets[vertex.index()]..self.offsets[vertex.index() + 1]]
    }

    /// Angle of a facet at one of its vertices; one for a segment.
    fn angle(&self, facet: FacetId, vertex: VertexId) -> f64 {
        let around = self.facet(facet).iter().zip(self.facet_points(facet));
        let at: Point<D> = around.clone().filter(|(v, _)| **v == vertex).map(|(_, x)| x).take(1).sum();
        let mut sides = around.filter(|(v, _)| **v != vertex).map(|(_, x)| x - at);
        match (sides.next(), sides.next()) {
            (Some(a), Some(b)) => a.angle(&b),
            _ => 1.0,
        }
    }
}

fn facets_around<const D: usize>(facet_to_vertex: &[VertexId], n_vertices: usize) -> (Vec<usize>, Vec<FacetId>) {
    let mut offsets = vec![0; n_vertices + 1];
    for vertex in facet_to_vertex {
        offsets[vertex.index() + 1] += 1;
    }
    for v in 0..n_vertices {
        offsets[v + 1] += offsets[v];
    }
    let mut next = offsets.clone();
    let mut vertex_to_facet = vec![FacetId(0); facet_to_vertex.len()];
    for (index, vertex) in facet_to_vertex.iter().enumerate() {
        let slot = &mut next[vertex.index()];
        vertex_to_facet[*slot] = FacetId::new(index / D);
        *slot += 1;
    }
    (offsets, vertex_to_facet)
}

fn feature(vertices: &[VertexId], barycentric: &[f64; MAX_CELL_VERTICES]) -> Feature {
    let mut carrying = vertices.iter().zip(barycentric).filter(|(_, l)| **l != 0.0).map(|(v, _)| *v);
    match (carrying.next(), carrying.next(), carrying.next()) {
        (Some(v), None, _) => Feature::Vertex(v),
        (Some(a), Some(b), None) if vertices.len() > 2 => Feature::Edge([a.min(b), a.max(b)]),
        _ => Feature::Facet,
    }
}

fn combined<const D: usize>(points: &[Point<D>], barycentric: &[f64; MAX_CELL_VERTICES]) -> Point<D> {
    points.iter().zip(barycentric).map(|(x, l)| x * *l).sum()
}

/// Barycentric coordinates of the point of a segment or triangle closest to `x`; exactly zero for the vertices of
/// which it is independent.
fn closest_on_simplex<const D: usize>(points: &[Point<D>], x: &Point<D>) -> [f64; MAX_CELL_VERTICES] {
    match *points {
        [a, b] => on_segment(&a, &b, x, [0, 1]),
        [a, b, c] => on_triangle(&a, &b, &c, x),
        _ => unreachable!("facets are segments or triangles"),
    }
}

/// Closest point of a segment, with its coordinates in the given slots.
fn on_segment<const D: usize>(a: &Point<D>, b: &Point<D>, x: &Point<D>, slots: [usize; 2]) -> [f64; MAX_CELL_VERTICES] {
    let (ab, ax) = (b - a, x - a);
    let length_squared = ab.norm_squared();
    let t = if length_squared > 0.0 { (ab.dot(&ax) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let mut barycentric = [0.0; MAX_CELL_VERTICES];
    barycentric[slots[0]] = 1.0 - t;
    barycentric[slots[1]] = t;
    barycentric
}

/// Closest point of a triangle: inside if the projection falls there, else on the closest edge.
fn on_triangle<const D: usize>(a: &Point<D>, b: &Point<D>, c: &Point<D>, x: &Point<D>) -> [f64; MAX_CELL_VERTICES] {
    let (ab, ac, ax) = (b - a, c - a, x - a);
    let (bb, bc, cc) = (ab.norm_squared(), ab.dot(&ac), ac.norm_squared());
    let (xb, xc) = (ax.dot(&ab), ax.dot(&ac));
    let determinant = bb * cc - bc * bc;
    let (v, w) = ((cc * xb - bc * xc) / determinant, (bb * xc - bc * xb) / determinant);
    if determinant > f64::EPSILON * bb * cc && v > 0.0 && w > 0.0 && v + w < 1.0 {
        return [1.0 - v - w, v, w, 0.0];
    }
    let edges = [on_segment(a, b, x, [0, 1]), on_segment(b, c, x, [1, 2]), on_segment(c, a, x, [2, 0])];
    let distance = |l: &[f64; MAX_CELL_VERTICES]| (x - combined(&[*a, *b, *c], l)).norm_squared();
    let mut best = edges[0];
    for edge in &edges[1..] {
        if distance(edge) < distance(&best) {
            best = *edge;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BoundaryMesh;
    use crate::generate::structured_box;

    #[test]
    fn a_corner_has_features_and_directions() {
        let mesh = structured_box([0.0, 0.0], [1.0, 1.0], [1, 1]).unwrap();
        let boundary = mesh.boundary();
        let index = SurfaceIndex::new(&Placed::new(&boundary, mesh.vertices()));
        let at = |x: f64, y: f64| index.closest_signed(&Point::<2>::new(x, y)).unwrap();

        let beside = at(1.5, 0.25);
        assert_eq!((beside.closest.feature, beside.distance), (Feature::Facet, 0.5));
        assert_eq!(beside.normal, Vector::<2>::new(1.0, 0.0));
        assert_eq!(beside.closest.point, Point::<2>::new(1.0, 0.25));

        let off_corner = at(4.0, 5.0);
        assert!(matches!(off_corner.closest.feature, Feature::Vertex(_)));
        assert!((off_corner.distance - 5.0).abs() < 1e-14);
        assert!((off_corner.normal - Vector::<2>::new(0.6, 0.8)).norm() < 1e-14);

        let on_corner = at(1.0, 1.0);
        assert_eq!(on_corner.distance, 0.0);
        assert!((on_corner.normal - Vector::<2>::repeat(0.5_f64.sqrt())).norm() < 1e-14);

        let inside = at(0.5, 0.125);
        assert_eq!((inside.distance, inside.normal), (-0.125, Vector::<2>::new(0.0, -1.0)));
    }

    #[test]
    fn a_reentrant_corner_points_out_of_the_solid() {
        // An arrow head: the vertex at the origin is re-entrant.
        let positions = [(0.0, 0.0), (2.0, -1.0), (0.0, 3.0), (-2.0, -1.0)].map(|(x, y)| Point::<2>::new(x, y));
        let boundary = BoundaryMesh::<2>::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
        let index = SurfaceIndex::new(&Placed::new(&boundary, &positions));
        let inside = index.closest_signed(&Point::<2>::new(0.0, 0.5)).unwrap();
        assert_eq!(inside.closest.feature, Feature::Vertex(VertexId(0)));
        assert_eq!((inside.distance, inside.normal), (-0.5, Vector::<2>::new(0.0, -1.0)));
        assert!(index.closest_signed(&Point::<2>::new(0.0, -0.5)).unwrap().distance > 0.0);
    }

    #[test]
    fn a_cube_has_edges() {
        let mesh = structured_box([0.0; 3], [1.0; 3], [1; 3]).unwrap();
        let boundary = mesh.boundary();
        let index = SurfaceIndex::new(&Placed::new(&boundary, mesh.vertices()));
        let found = index.closest_signed(&Point::<3>::new(1.3, 0.5, 1.4)).unwrap();
        assert_eq!(found.closest.feature, Feature::Edge([VertexId(5), VertexId(7)]));
        assert!((found.distance - 0.5).abs() < 1e-14);
        assert!((found.normal - Vector::<3>::new(0.6, 0.0, 0.8)).norm() < 1e-14);
        let on_edge = index.closest_signed(&Point::<3>::new(1.0, 0.5, 1.0)).unwrap();
        assert!((on_edge.normal - Vector::<3>::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt())).norm() < 1e-14);
        let on_corner = index.closest_signed(&Point::<3>::repeat(1.0)).unwrap();
        assert!((on_corner.normal - Vector::<3>::repeat(1.0 / 3.0_f64.sqrt())).norm() < 1e-14);
    }

    #[test]
    fn nothing_is_closest_to_nowhere() {
        let empty = BoundaryMesh::<2>::from_facets(Vec::new());
        assert!(SurfaceIndex::new(&Placed::new(&empty, &[])).closest(&Point::<2>::zeros()).is_none());
        let one = BoundaryMesh::<2>::from_facets(vec![VertexId(0), VertexId(0)]);
        let index = SurfaceIndex::new(&Placed::new(&one, &[Point::<2>::new(1.0, 0.0)]));
        assert_eq!(index.closest_signed(&Point::<2>::zeros()).unwrap().distance, 1.0);
        assert!(index.closest(&Point::<2>::new(f64::NAN, 0.0)).is_none());
    }
}
