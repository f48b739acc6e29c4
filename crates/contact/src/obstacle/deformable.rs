//! The moving boundary of another body as an obstacle.

use mesh::search::SurfaceIndex;
use mesh::{BoundaryMesh, FacetId, Placed, Point, Tensor, Vector, VertexId, facet_normal};

use super::{Anchor, Candidates, MAX_FACET_VERTICES, Obstacle, Projection};
use crate::{Error, Motion};

/// A part of the boundary of a body, to be kept away from.
///
/// The closest point is exact, on segments or triangles. Its normal is minus the normal of the facet where it falls
/// inside a facet. On an edge or vertex it is the direction to the closest point (from it, for a point that has
/// penetrated), or minus the pseudo-normal of the edge or vertex when the gap is zero; the sign of the gap comes from
/// the pseudo-normal.
///
/// Source: paper, Sec. 2.3; angle-weighted pseudo-normals: Baerentzen, Aanaes 2005, DOI 10.1109/TVCG.2005.49.
#[derive(Clone, Debug)]
pub struct DeformableObstacle<const D: usize> {
    boundary: BoundaryMesh<D>,
    facets: Vec<FacetId>,
    /// One entry per facet of the boundary: whether it is among `facets`.
    may_touch: Vec<bool>,
    vertex_offsets: Vec<usize>,
    vertex_to_facet: Vec<FacetId>,
}

impl<const D: usize> DeformableObstacle<D> {
    /// The given facets of a closed boundary. Facets of the boundary that are not given cannot be touched, but count
    /// for pseudo-normals.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`]: a facet that the boundary does not have.
    pub fn new(boundary: BoundaryMesh<D>, facets: Vec<FacetId>) -> Result<Self, Error> {
        let n_facets = boundary.n_facets();
        if let Some(&facet) = facets.iter().find(|f| f.index() >= n_facets) {
            return Err(Error::UnknownFacet { facet, n_facets });
        }
        let mut may_touch = vec![false; n_facets];
        facets.iter().for_each(|f| may_touch[f.index()] = true);
        let mut pairs: Vec<(VertexId, FacetId)> =
            boundary.facets().flat_map(|f| boundary.facet(f).iter().map(move |&v| (v, f))).collect();
        pairs.sort_unstable();
        let n_vertices = pairs.last().map_or(0, |(v, _)| v.index() + 1);
        let vertex_offsets = (0..=n_vertices).map(|v| pairs.partition_point(|(w, _)| w.index() < v)).collect();
        let vertex_to_facet = pairs.into_iter().map(|(_, f)| f).collect();
        Ok(Self { boundary, facets, may_touch, vertex_offsets, vertex_to_facet })
    }

    /// Facets around a vertex.
    fn facets_around(&self, vertex: VertexId) -> &[FacetId] {
        &self.vertex_to_facet[self.vertex_offsets[vertex.index()]..self.vertex_offsets[vertex.index() + 1]]
    }

    /// Normals of the facets that share the given vertices of a facet, summed, weighted by the angle at a vertex.
    fn pseudo_normal(&self, shared: &[VertexId], motion: Motion<'_, D>) -> Vector<D> {
        let mut sum = Vector::zeros();
        for &facet in self.facets_around(shared[0]) {
            let vertices = self.boundary.facet(facet);
            if !shared.iter().all(|v| vertices.contains(v)) {
                continue;
            }
            let points = facet_points(vertices, motion);
            let mut others = vertices.iter().zip(&points).filter(|(v, _)| !shared.contains(v)).map(|(_, x)| x);
            let weight = match (others.next(), others.next()) {
                (Some(a), Some(b)) => {
                    let at = motion.position(shared[0]);
                    (a - at).angle(&(b - at))
                }
                _ => 1.0,
            };
            sum += weight * facet_normal(&points[..D]);
        }
        let length = sum.norm();
        if length > 0.0 { sum / length } else { sum }
    }

    /// Normal into the obstacle and its derivative, for a closest point on the given face of a facet.
    fn normal(&self, x: &Point<D>, facet: FacetId, foot: &Foot<D>, motion: Motion<'_, D>) -> (Vector<D>, Tensor<D>) {
        let vertices = self.boundary.facet(facet);
        if foot.n_vertices() == D {
            return (-facet_normal(&foot.points[..D]), Tensor::zeros());
        }
        let mut shared = [vertices[0]; MAX_FACET_VERTICES];
        let mut n_shared = 0;
        for (k, &v) in vertices.iter().enumerate() {
            if foot.carries(k) {
                shared[n_shared] = v;
                n_shared += 1;
            }
        }
        let outward = self.pseudo_normal(&shared[..n_shared], motion);
        let away = x - foot.point;
        let distance = away.norm();
        let size = (foot.points[1] - foot.points[0]).norm();
        if distance <= TOUCHING * size {
            return (-outward, Tensor::zeros());
        }
        let gap = if away.dot(&outward) >= 0.0 { distance } else { -distance };
        let normal = -away / gap;
        let mut across = Tensor::identity() - normal * normal.transpose();
        for k in 0..D {
            across -= (foot.points[k] - foot.point) * foot.gradient[k].transpose();
        }
        (normal, -across / gap)
    }
}

impl<const D: usize> Obstacle<D> for DeformableObstacle<D> {
    fn project(&self, x: &Point<D>, motion: Motion<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        let mut best: Option<(FacetId, Foot<D>)> = None;
        for &facet in candidates {
            let points = facet_points(self.boundary.facet(facet), motion);
            if best.as_ref().is_some_and(|(_, known)| known.is_closer_than(squared_distance_to_box(x, &points[..D]))) {
                continue;
            }
            let foot = closest_on_facet(x, &points);
            if best.as_ref().is_none_or(|(_, known)| foot.beats(known)) {
                best = Some((facet, foot));
            }
        }
        let (facet, foot) = best?;
        let (normal, normal_gradient) = self.normal(x, facet, &foot, motion);
        let anchor = Anchor::Facet { facet, barycentric: foot.barycentric, barycentric_gradient: foot.gradient };
        Some(Projection { point: foot.point, normal, normal_gradient, anchor })
    }

    fn boundary(&self) -> Option<&BoundaryMesh<D>> {
        Some(&self.boundary)
    }

    fn project_all(&self, points: &[Point<D>], motion: Motion<'_, D>) -> Vec<Option<Projection<D>>> {
        let positions = motion.positions();
        let touchable = self.facets.iter().flat_map(|&f| self.boundary.facet(f)).copied().collect();
        let index = SurfaceIndex::new(&Placed::new(&BoundaryMesh::from_facets(touchable), &positions));
        let mut near = Vec::new();
        let mut project = |x: &Point<D>| {
            // All facets as close as the closest one, so that ties are broken here as everywhere else.
            let reach = (index.closest(x)?.point - x).norm() * (1.0 + TIE);
            index.facets_overlapping(&x.add_scalar(-reach), &x.add_scalar(reach), &mut near);
            near.iter_mut().for_each(|f| *f = self.facets[f.index()]);
            self.project(x, motion, &near)
        };
        points.iter().map(&mut project).collect()
    }

    fn candidates(&self, slave: Placed<'_, D>, facets: &[FacetId], positions: &[Point<D>], reach: f64) -> Candidates {
        let index = SurfaceIndex::new(&Placed::new(&self.boundary, positions));
        let mut near = Vec::new();
        Candidates::from_lists(facets.iter().map(|&facet| {
            let (low, high) = bounds(&slave.facet_points(facet)[..D]);
            index.facets_overlapping(&low.add_scalar(-reach), &high.add_scalar(reach), &mut near);
            near.iter().copied().filter(|f| self.may_touch[f.index()]).collect()
        }))
    }
}

/// Corners of the box around points.
fn bounds<const D: usize>(points: &[Point<D>]) -> (Point<D>, Point<D>) {
    points.iter().fold((points[0], points[0]), |(low, high), x| (low.inf(x), high.sup(x)))
}

/// Squared distance of a point from the box around points.
#[inline]
fn squared_distance_to_box<const D: usize>(x: &Point<D>, points: &[Point<D>]) -> f64 {
    let (low, high) = bounds(points);
    (low - x).sup(&(x - high)).map(|c| c.max(0.0)).norm_squared()
}

/// Points of a facet; the first `D` count.
#[inline]
fn facet_points<const D: usize>(vertices: &[VertexId], motion: Motion<'_, D>) -> [Point<D>; MAX_FACET_VERTICES] {
    let mut points = [Point::zeros(); MAX_FACET_VERTICES];
    for (slot, &v) in points.iter_mut().zip(vertices) {
        *slot = motion.position(v);
    }
    points
}

/// Squared distances that differ relatively by less are the same.
const TIE: f64 = 1e-8;
/// Barycentric coordinates above minus this are inside: a hair outside is as close on the neighbour.
const HAIR: f64 = 1e-13;
/// Distances below this, relative to the size of a facet, give no direction but round-off.
const TOUCHING: f64 = 1e-8;

/// Closest point of one facet, with the face (facet, edge, vertex) in whose interior it lies.
#[derive(Clone, Copy, Debug)]
struct Foot<const D: usize> {
    point: Point<D>,
    squared_distance: f64,
    points: [Point<D>; MAX_FACET_VERTICES],
    /// Vertices that span the face, one bit each.
    face: usize,
    barycentric: [f64; MAX_FACET_VERTICES],
    gradient: [Vector<D>; MAX_FACET_VERTICES],
}

impl<const D: usize> Foot<D> {
    fn n_vertices(&self) -> usize {
        self.face.count_ones() as usize
    }

    fn carries(&self, k: usize) -> bool {
        self.face & (1 << k) != 0
    }

    /// Whether nothing as far as this can beat it.
    fn is_closer_than(&self, squared_distance: f64) -> bool {
        squared_distance > self.squared_distance * (1.0 + TIE)
    }

    /// Closer; or as close and on a face of higher dimension, so that a point over the common edge of two coplanar
    /// facets is seen over a facet.
    fn beats(&self, other: &Self) -> bool {
        let tolerance = TIE * other.squared_distance;
        self.squared_distance < other.squared_distance - tolerance
            || (self.squared_distance <= other.squared_distance + tolerance
                && self.face.count_ones() > other.face.count_ones())
    }
}

/// Closest point of a facet: the closest of the projections onto its faces that fall inside them. If the projection
/// onto the facet itself does, it is the one.
fn closest_on_facet<const D: usize>(x: &Point<D>, points: &[Point<D>; MAX_FACET_VERTICES]) -> Foot<D> {
    let whole = (1_usize << D) - 1;
    if let Some(foot) = project_on_face(x, points, whole) {
        return foot;
    }
    let mut best = vertex_foot(x, points, 0);
    for face in 1..whole {
        if let Some(foot) = project_on_face(x, points, face)
            && foot.beats(&best)
        {
            best = foot;
        }
    }
    best
}

fn vertex_foot<const D: usize>(x: &Point<D>, points: &[Point<D>; MAX_FACET_VERTICES], k: usize) -> Foot<D> {
    let mut barycentric = [0.0; MAX_FACET_VERTICES];
    barycentric[k] = 1.0;
    Foot {
        point: points[k],
        squared_distance: (x - points[k]).norm_squared(),
        points: *points,
        face: 1 << k,
        barycentric,
        gradient: [Vector::zeros(); MAX_FACET_VERTICES],
    }
}

/// Projection onto the hull of the vertices in `face`; `None` if it falls outside, or the face is degenerate.
fn project_on_face<const D: usize>(
    x: &Point<D>,
    points: &[Point<D>; MAX_FACET_VERTICES],
    face: usize,
) -> Option<Foot<D>> {
    let carried = || (0..D).filter(|k| face & (1 << k) != 0);
    let base = carried().next()?;
    let mut foot = vertex_foot(x, points, base);
    foot.face = face;
    for k in carried().skip(1) {
        // Part of the edge from the base to vertex k that is normal to the opposite edge: there are at most two.
        let mut edge = points[k] - points[base];
        if let Some(other) = carried().skip(1).find(|&l| l != k) {
            let across = points[other] - points[base];
            let length = across.norm_squared();
            if length <= 0.0 {
                return None;
            }
            edge -= across * (across.dot(&edge) / length);
        }
        let length = edge.norm_squared();
        if length <= 0.0 {
            return None;
        }
        foot.gradient[k] = edge / length;
        foot.gradient[base] -= foot.gradient[k];
        foot.barycentric[k] = foot.gradient[k].dot(&(x - points[base]));
        foot.barycentric[base] -= foot.barycentric[k];
        foot.point += (points[k] - points[base]) * foot.barycentric[k];
    }
    if carried().any(|k| foot.barycentric[k] < -HAIR) {
        return None;
    }
    foot.squared_distance = (x - foot.point).norm_squared();
    Some(foot)
}
