//! Closest points of facets, and pseudo-normals of vertices and edges.

use crate::{BoundaryMesh, FacetId, MAX_FACET_VERTICES, Point, Vector, VertexId, facet_normal};

/// Squared distances with a smaller relative difference are treated as equal.
pub(super) const TIE: f64 = 1e-8;
/// Barycentric coordinates above minus this value are inside. The error of the distance is of second order.
const INSIDE: f64 = 1e-13;
/// A triangle is degenerate if the squared sine of one of its angles is below this value.
const DEGENERATE: f64 = f64::EPSILON;
/// Sums of normals shorter than this are round-off.
const CANCELLED: f64 = 16.0 * f64::EPSILON;

/// The part of a facet in whose interior a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The interior of the facet.
    Facet,
    /// The interior of an edge of the facet (3D only), vertices in ascending order.
    Edge([VertexId; 2]),
    /// A vertex of the facet.
    Vertex(VertexId),
}

impl Feature {
    /// Returns the feature of a facet that is spanned by some of its vertices.
    pub(super) fn spanned(facet: &[VertexId], is_spanning: impl Fn(usize) -> bool) -> Self {
        let mut spanning = (0..facet.len()).filter(|&k| is_spanning(k)).map(|k| facet[k]);
        match (spanning.next(), spanning.next(), spanning.next()) {
            (Some(v), None, _) => Self::Vertex(v),
            (Some(a), Some(b), None) if facet.len() > 2 => Self::Edge([a.min(b), a.max(b)]),
            _ => Self::Facet,
        }
    }
}

/// Closest point `Π(x)` of one facet to a point `x`, with derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Foot<const D: usize> {
    /// The closest point.
    pub point: Point<D>,
    /// Squared distance between the two points.
    pub squared_distance: f64,
    /// Barycentric coordinates in the facet; exactly zero at vertices that do not span the feature.
    pub barycentric: [f64; MAX_FACET_VERTICES],
    /// Derivatives of these coordinates with respect to `x` while the feature stays the same.
    pub gradient: [Vector<D>; MAX_FACET_VERTICES],
    /// Local vertices that span the feature, one bit each.
    face: usize,
}

impl<const D: usize> Foot<D> {
    /// Returns the closest point of the facet with the given `D` vertices: the projection onto the facet if it lies
    /// inside, otherwise the closest of the projections onto edges and vertices that lie inside of them.
    #[inline]
    pub fn on_facet(x: &Point<D>, points: &[Point<D>]) -> Self {
        let whole = (1_usize << D) - 1;
        if let Some(foot) = Self::on_face(x, points, whole) {
            return foot;
        }
        let mut best = Self::on_vertex(x, points, 0);
        for face in 1..whole {
            if let Some(foot) = Self::on_face(x, points, face)
                && foot.is_preferred_to(&best)
            {
                best = foot;
            }
        }
        best
    }

    /// Returns the feature onto which `x` was projected, in terms of the vertices of the facet. The point may lie on
    /// its boundary.
    pub fn feature(&self, vertices: &[VertexId]) -> Feature {
        Feature::spanned(vertices, |k| self.face & (1 << k) != 0)
    }

    /// Returns whether a point at the given squared distance is farther away, by more than round-off.
    #[inline]
    pub fn is_closer_than(&self, squared_distance: f64) -> bool {
        squared_distance > self.squared_distance * (1.0 + TIE)
    }

    /// Returns whether this point is closer, or equally close and on a feature of higher dimension. A point over the
    /// common edge of two coplanar facets thus has its closest point on a facet.
    #[inline]
    pub fn is_preferred_to(&self, other: &Self) -> bool {
        let tolerance = TIE * other.squared_distance;
        self.squared_distance < other.squared_distance - tolerance
            || (self.squared_distance <= other.squared_distance + tolerance
                && self.face.count_ones() > other.face.count_ones())
    }

    #[inline]
    fn on_vertex(x: &Point<D>, points: &[Point<D>], k: usize) -> Self {
        let mut barycentric = [0.0; MAX_FACET_VERTICES];
        barycentric[k] = 1.0;
        Self {
            point: points[k],
            squared_distance: (x - points[k]).norm_squared(),
            barycentric,
            gradient: [Vector::zeros(); MAX_FACET_VERTICES],
            face: 1 << k,
        }
    }

    /// Returns the projection onto the plane of the facet with the given `D` vertices; `None` for a degenerate facet.
    /// Outside of the facet barycentric coordinates are negative.
    #[inline]
    pub fn on_plane(x: &Point<D>, points: &[Point<D>]) -> Option<Self> {
        Self::on_span(x, points, (1 << D) - 1)
    }

    /// Projects onto the plane of the vertices in `face`; `None` if the projection lies outside of their hull, or the
    /// hull is degenerate.
    #[inline]
    fn on_face(x: &Point<D>, points: &[Point<D>], face: usize) -> Option<Self> {
        let is_inside = |foot: &Self| (0..D).all(|k| face & (1 << k) == 0 || foot.barycentric[k] >= -INSIDE);
        Self::on_span(x, points, face).filter(is_inside)
    }

    /// Projects onto the plane of the vertices in `face`; `None` if their hull is degenerate.
    #[inline]
    fn on_span(x: &Point<D>, points: &[Point<D>], face: usize) -> Option<Self> {
        let spanning = || (0..D).filter(|k| face & (1 << k) != 0);
        let base = spanning().next()?;
        let mut foot = Self::on_vertex(x, points, base);
        foot.face = face;
        for k in spanning().skip(1) {
            // The part of the edge from the base to vertex k that is normal to the other edge, if there is one.
            let mut edge = points[k] - points[base];
            let mut smallest = 0.0;
            if let Some(other) = spanning().skip(1).find(|&l| l != k) {
                let across = points[other] - points[base];
                let length = across.norm_squared();
                if length <= 0.0 {
                    return None;
                }
                smallest = DEGENERATE * edge.norm_squared();
                edge -= across * (across.dot(&edge) / length);
            }
            let length = edge.norm_squared();
            if length <= smallest {
                return None;
            }
            foot.gradient[k] = edge / length;
            foot.gradient[base] -= foot.gradient[k];
            foot.barycentric[k] = foot.gradient[k].dot(&(x - points[base]));
            foot.barycentric[base] -= foot.barycentric[k];
            foot.point += (points[k] - points[base]) * foot.barycentric[k];
        }
        foot.squared_distance = (x - foot.point).norm_squared();
        Some(foot)
    }
}

/// Returns whether the distance between two facets, each given by `D` vertices, is at most `distance`. It is the
/// smallest distance of a vertex of either facet from the other facet, of an edge from an edge, and in 3D of the point
/// where an edge crosses the plane of the other facet from that facet.
pub fn facets_are_within<const D: usize>(distance: f64, a: &[Point<D>], b: &[Point<D>]) -> bool {
    squared_distances(a, b).any(|squared| squared <= distance * distance)
}

/// Returns squared distances of points of two facets, of which the smallest one is that of the facets, up to round-off.
fn squared_distances<'f, const D: usize>(a: &'f [Point<D>], b: &'f [Point<D>]) -> impl Iterator<Item = f64> + 'f {
    let from = |facet: &[Point<D>], x: &Point<D>| Foot::on_facet(x, facet).squared_distance;
    let of_vertices = a.iter().map(move |x| from(b, x)).chain(b.iter().map(move |x| from(a, x)));
    // A segment is its own edge.
    let edges = |facet: &'f [Point<D>]| (0..D * (D - 1) / 2).map(|k| [facet[k], facet[(k + 1) % D]]);
    let of_edges = edges(a).flat_map(move |edge| edges(b).map(move |other| squared_distance_of_lines(edge, other)));
    let of_crossings = [(a, b), (b, a)].into_iter().flat_map(move |(facet, other)| {
        let normal = facet_normal(facet);
        edges(other).filter_map(move |[from_point, to_point]| {
            let [before, after] = [from_point, to_point].map(|x| (x - facet[0]).dot(&normal));
            let crossing = || from_point + (to_point - from_point) * (before / (before - after));
            (before * after < 0.0).then(|| from(facet, &crossing()))
        })
    });
    of_vertices.chain(of_edges).chain(of_crossings)
}

/// Returns the squared distance between the lines through two segments if both closest points lie inside of the
/// segments; infinity otherwise, and for parallel ones.
fn squared_distance_of_lines<const D: usize>(a: [Point<D>; 2], b: [Point<D>; 2]) -> f64 {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let determinant = uu * vv - uv * uv;
    if determinant <= DEGENERATE * uu * vv {
        return f64::INFINITY;
    }
    let s = (uv * v.dot(&w) - vv * u.dot(&w)) / determinant;
    let t = (uu * v.dot(&w) - uv * u.dot(&w)) / determinant;
    let is_inside = [s, t].iter().all(|x| (0.0..=1.0).contains(x));
    if is_inside { (w + u * s - v * t).norm_squared() } else { f64::INFINITY }
}

/// Facets around each vertex of a surface.
#[derive(Clone, Debug)]
pub struct VertexToFacet {
    /// Facets around vertex `v` are entries `offsets[v]` to `offsets[v + 1]` of `facets`, in ascending order.
    offsets: Vec<usize>,
    facets: Vec<FacetId>,
}

impl VertexToFacet {
    /// Collects the facets around each vertex.
    pub fn new<const D: usize>(boundary: &BoundaryMesh<D>) -> Self {
        let corners = || boundary.facets().flat_map(|f| boundary.facet(f).iter().map(move |v| (v.index(), f)));
        let mut offsets = vec![0; corners().map(|(v, _)| v + 2).max().unwrap_or(1)];
        corners().for_each(|(v, _)| offsets[v + 1] += 1);
        for v in 1..offsets.len() {
            offsets[v] += offsets[v - 1];
        }
        let mut next = offsets.clone();
        let mut facets = vec![FacetId(0); corners().count()];
        for (v, facet) in corners() {
            facets[next[v]] = facet;
            next[v] += 1;
        }
        Self { offsets, facets }
    }

    /// Returns the facets around a vertex, in ascending order.
    pub fn around(&self, vertex: VertexId) -> &[FacetId] {
        &self.facets[self.offsets[vertex.index()]..self.offsets[vertex.index() + 1]]
    }

    /// Returns the unit mean of the normals of the facets that share a feature of `facet`, with the vertices of
    /// `boundary` at the given positions.
    ///
    /// At a vertex, normals are weighted by the angles of the facets; at an edge, weights are equal. The sign of the
    /// scalar product with this normal is the side of the surface for every point whose closest point lies on the
    /// feature. If the normals cancel, because the surface is folded onto itself, the normal of `facet` is returned.
    ///
    /// Source: Baerentzen-Aanaes 2005, DOI 10.1109/TVCG.2005.49.
    pub fn pseudo_normal<const D: usize>(
        &self,
        boundary: &BoundaryMesh<D>,
        position: impl Fn(VertexId) -> Point<D>,
        facet: FacetId,
        feature: Feature,
    ) -> Vector<D> {
        let points = |facet: FacetId| {
            let mut points = [Point::zeros(); MAX_FACET_VERTICES];
            points.iter_mut().zip(boundary.facet(facet)).for_each(|(slot, &v)| *slot = position(v));
            points
        };
        let normal = |facet| facet_normal(&points(facet)[..D]);
        let sum: Vector<D> = match feature {
            Feature::Facet => return normal(facet),
            Feature::Edge([a, b]) => {
                let shared = self.around(a).iter().filter(|f| boundary.facet(**f).contains(&b));
                shared.map(|&f| normal(f)).sum()
            }
            Feature::Vertex(v) => {
                let angle = |facet: FacetId| {
                    let points = points(facet);
                    let mut others = boundary.facet(facet).iter().zip(&points).filter(|(w, _)| **w != v);
                    match (others.next(), others.next()) {
                        (Some((_, a)), Some((_, b))) => (a - position(v)).angle(&(b - position(v))),
                        _ => 1.0,
                    }
                };
                self.around(v).iter().map(|&f| angle(f) * normal(f)).sum()
            }
        };
        sum.try_normalize(CANCELLED).unwrap_or_else(|| normal(facet))
    }
}
