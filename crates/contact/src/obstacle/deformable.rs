//! The moving boundary of another body as an obstacle.

use mesh::search::{Feature, Foot, SurfaceIndex, VertexToFacet, facets_are_within};
use mesh::{
    Aabb, BoundaryMesh, FacetId, MAX_FACET_NODES, MAX_FACET_VERTICES, Order, Placed, Point, Tensor, Vector, VertexId,
    facet_normal,
};

use super::curved::{CurvedFacet, CurvedFoot, closest_of};
use super::{Anchor, Obstacle, Projection};
use crate::{Error, Positions};

/// Largest distance, relative to the first edge of the facet, that counts as zero: its direction is round-off.
const TOUCHING: f64 = 1e-8;

/// Barycentric coordinate outside of a facet up to which points are projected onto its plane. The sum of the absolute
/// values of the coordinates is at most 2 there, which the bound of the motion in `sites.rs` contains.
const FARTHEST_OUTSIDE: f64 = 0.25;

/// Cosine of the angle between normals below which facets face each other.
const FACING: f64 = -0.5;

/// Distance relative to the length of a segment by which another facet may be closer at its corners.
const CLOSER: f64 = 0.1;

/// Part of the boundary of a body that acts as an obstacle.
///
/// The closest point is exact, on segments or triangles, or on the curved facets of elements of order 2. The normal
/// `n^w` is minus the normal of the facet if the closest point lies inside a facet. On an edge or vertex, it is the
/// unit vector from `x` to the closest point, reversed if `x` has penetrated, or minus the pseudo-normal if the two
/// points coincide. The sign of the gap follows from the pseudo-normal, on elements of order 2 that of their linear
/// parts.
///
/// Source: paper, Sec. 2.3; pseudo-normals: [`VertexToFacet::pseudo_normal`].
#[derive(Clone, Debug)]
pub struct DeformableObstacle<const D: usize> {
    pub(super) boundary: BoundaryMesh<D>,
    pub(super) facets: Vec<FacetId>,
    /// Whether each facet of the boundary can be touched; empty if all of them can.
    is_touchable: Vec<bool>,
    vertex_to_facet: VertexToFacet,
}

impl<const D: usize> DeformableObstacle<D> {
    /// Creates the obstacle from some facets of a closed boundary. The other facets cannot be touched, but contribute
    /// to pseudo-normals.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`]: the boundary does not have one of the facets.
    pub fn new(boundary: BoundaryMesh<D>, facets: Vec<FacetId>) -> Result<Self, Error> {
        let n_facets = boundary.n_facets();
        if let Some(&facet) = facets.iter().find(|f| f.index() >= n_facets) {
            return Err(Error::UnknownFacet { facet, n_facets });
        }
        let vertex_to_facet = VertexToFacet::new(&boundary);
        let mut is_touchable = vec![false; n_facets];
        facets.iter().for_each(|facet| is_touchable[facet.index()] = true);
        if !is_touchable.contains(&false) {
            is_touchable.clear();
        }
        Ok(Self { boundary, facets, is_touchable, vertex_to_facet })
    }

    /// Builds the search structure of the facets that can be touched. Its facet `k` is `self.facets[k]`.
    pub(super) fn index(&self, positions: &[Point<D>]) -> SurfaceIndex<D> {
        let touchable = self.facets.iter().flat_map(|&f| self.boundary.facet(f)).copied().collect();
        SurfaceIndex::new(&Placed::new(&BoundaryMesh::from_facets(touchable), positions))
    }

    /// Computes [`Obstacle::smallest_gap`] with the search structure at `positions`. Points are visited in the order of
    /// their distances to the box around the body, which are lower bounds of positive gaps; all negative gaps are in
    /// the box. The loop ends when this distance exceeds the smallest gap so far.
    pub(super) fn smallest_gap_with(
        &self,
        index: &SurfaceIndex<D>,
        points: &[Point<D>],
        positions: &[Point<D>],
    ) -> Option<f64> {
        let bulge = self.bulge(positions);
        let bounds = Aabb::of_points(positions).expanded(bulge);
        let mut points: Vec<_> = points.iter().map(|x| (bounds.squared_distance(x), x)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut smallest = None;
        for (squared_distance, x) in points {
            if smallest.is_some_and(|gap: f64| gap.max(0.0).powi(2) < squared_distance) {
                break;
            }
            let gap = self.gap_with((index, bulge), x, positions);
            smallest = [smallest, gap].into_iter().flatten().reduce(f64::min);
        }
        smallest
    }

    /// Computes the gap of a point with the search structure and the bulge at `positions`. Returns `None` if the gap is
    /// negative and has no meaning: the point is past the end of the facets that can be touched, or its closest point
    /// is on their rim.
    pub(super) fn gap_with(
        &self,
        (index, bulge): (&SurfaceIndex<D>, f64),
        x: &Point<D>,
        positions: &[Point<D>],
    ) -> Option<f64> {
        let (mut near, at) = (Vec::new(), Positions::Fixed(positions));
        let reach = index.closest(x)?.reach(x) + 2.0 * bulge;
        self.overlapping(index, &Aabb::of_points([x]).expanded(reach), &mut near);
        let closest = self.closest(x, at, &near)?;
        let gap = self.project(x, at, &near)?.gap(x);
        let has_sign = || !self.is_on_rim(&closest) && !self.is_past_end(x, at, &near);
        (gap >= 0.0 || has_sign()).then_some(gap)
    }

    /// Computes [`Obstacle::candidates`] with the search structure at the obstacle's positions.
    pub(super) fn candidates_with(
        &self,
        index: &SurfaceIndex<D>,
        slave: Placed<'_, D>,
        facets: &[FacetId],
        positions: &[Point<D>],
        reach: f64,
    ) -> Vec<Vec<FacetId>> {
        let own_bulge = self.bulge(positions);
        let of_facet = |&facet: &FacetId| {
            let mut near = Vec::new();
            let reach = reach + own_bulge + slave.bulge([facet].into_iter());
            let points = &slave.facet_points(facet)[..D];
            self.overlapping(index, &Aabb::of_points(points).expanded(reach), &mut near);
            // Boxes may be near although facets are not: the far side of a thin part would be a candidate.
            near.retain(|&other| {
                let other = facet_points(self.boundary.facet(other), Positions::Fixed(positions));
                facets_are_within(reach, points, &other[..D])
            });
            near
        };
        facets.iter().map(of_facet).collect()
    }

    /// Returns an upper bound of the distance between curved elements and the facets that can be touched.
    pub(super) fn bulge(&self, positions: &[Point<D>]) -> f64 {
        Placed::new(&self.boundary, positions).bulge(self.facets.iter().copied())
    }

    /// Replaces `near` by the facets whose boxes overlap a region.
    fn overlapping(&self, index: &SurfaceIndex<D>, region: &Aabb<D>, near: &mut Vec<FacetId>) {
        index.facets_overlapping(region, near);
        near.iter_mut().for_each(|f| *f = self.facets[f.index()]);
    }

    /// Returns the point of the candidates that is closest to `x`, and its facet; `None` without candidates.
    pub(super) fn closest(
        &self,
        x: &Point<D>,
        at: Positions<'_, D>,
        candidates: &[FacetId],
    ) -> Option<(FacetId, Foot<D>)> {
        let mut best: Option<(FacetId, Foot<D>)> = None;
        for &facet in candidates {
            let points = &facet_points(self.boundary.facet(facet), at)[..D];
            let bound = Aabb::of_points(points).squared_distance(x);
            if best.as_ref().is_some_and(|(_, known)| known.is_closer_than(bound)) {
                continue;
            }
            let foot = Foot::on_facet(x, points);
            if best.as_ref().is_none_or(|(_, known)| foot.is_preferred_to(known)) {
                best = Some((facet, foot));
            }
        }
        best
    }

    /// Returns the projection onto a closest point of a facet.
    pub(super) fn projection(
        &self,
        x: &Point<D>,
        (facet, foot): &(FacetId, Foot<D>),
        at: Positions<'_, D>,
    ) -> Projection<D> {
        let (normal, normal_gradient) = self.normal(x, *facet, foot, at);
        let (mut shape, mut gradient) = ([0.0; MAX_FACET_NODES], [Vector::zeros(); MAX_FACET_NODES]);
        shape[..D].copy_from_slice(&foot.barycentric[..D]);
        gradient[..D].copy_from_slice(&foot.gradient[..D]);
        let inside = shape[..D].iter().copied().fold(f64::INFINITY, f64::min);
        let anchor = Anchor::Facet { facet: *facet, inside, shape, gradient, metric: Tensor::identity() };
        Projection { point: foot.point, normal, normal_gradient, anchor }
    }

    /// Returns the projection onto the curved elements of which the candidates are parts; `None` for order 1 and
    /// without candidates.
    pub(super) fn curved(&self, x: &Point<D>, at: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        let (boundary, order) = (&self.boundary, self.boundary.order());
        if order == Order::Linear {
            return None;
        }
        let curved = boundary
            .by_element(candidates)
            .map(|parts| (parts[0], CurvedFacet(boundary.at_nodes(parts[0], |node| at.at(node)))));
        let (facet, curved, closest) = closest_of(x, curved)?;
        let foot = CurvedFoot::new(x, &curved, &closest);
        let (part, inside) = order.part_at(D - 1, &closest.at);
        let facet = boundary.parts_of(boundary.element_of(facet).0).nth(part).unwrap_or(facet);
        let (normal, normal_gradient) = foot.normal.unwrap_or_else(|| {
            let feature = Feature::Vertex(boundary.nodes(facet)[closest.node(D)]);
            let outward = self.vertex_to_facet.pseudo_normal(boundary, |v| at.at(v), facet, feature);
            let size = (at.at(boundary.nodes(facet)[1]) - at.at(boundary.nodes(facet)[0])).norm();
            normal_at_kink(x, &foot.point, outward, size, &foot.point_gradient)
        });
        let anchor = Anchor::Facet { facet, inside, shape: foot.shape, gradient: foot.gradient, metric: foot.metric };
        Some(Projection { point: foot.point, normal, normal_gradient, anchor })
    }

    /// Returns whether a condition holds for all facets around a closest point.
    pub(super) fn holds_around(
        &self,
        (facet, foot): &(FacetId, Foot<D>),
        condition: impl Fn(&FacetId) -> bool,
    ) -> bool {
        match foot.feature(self.boundary.facet(*facet)) {
            Feature::Facet => condition(facet),
            Feature::Edge([a, b]) => {
                let mut around = self.vertex_to_facet.around(a).iter();
                around.all(|facet| condition(facet) || !self.boundary.facet(*facet).contains(&b))
            }
            Feature::Vertex(v) => self.vertex_to_facet.around(v).iter().all(condition),
        }
    }

    /// Returns whether a closest point is on the rim of the facets that can be touched.
    fn is_on_rim(&self, closest: &(FacetId, Foot<D>)) -> bool {
        !self.is_touchable.is_empty() && !self.holds_around(closest, |facet| self.is_touchable[facet.index()])
    }

    /// Returns whether a point is over a facet up to round-off, although its closest point is on the rim of the facet.
    fn is_over_facet(&self, x: &Point<D>, closest: &(FacetId, Foot<D>), at: Positions<'_, D>) -> bool {
        let [height, size] = self.height_and_size(x, closest, at);
        let squared = closest.1.squared_distance - height * height;
        squared <= (TOUCHING * size).powi(2)
    }

    /// Returns the height of a point over the plane of the facet of a closest point, and the length of the first edge
    /// of this facet.
    fn height_and_size(&self, x: &Point<D>, (facet, foot): &(FacetId, Foot<D>), at: Positions<'_, D>) -> [f64; 2] {
        let points = facet_points(self.boundary.facet(*facet), at);
        [(x - foot.point).dot(&facet_normal(&points[..D])), (points[1] - points[0]).norm()]
    }

    /// Computes the normal into the obstacle and its derivative at a closest point of a facet.
    fn normal(&self, x: &Point<D>, facet: FacetId, foot: &Foot<D>, at: Positions<'_, D>) -> (Vector<D>, Tensor<D>) {
        let vertices = self.boundary.facet(facet);
        let feature = foot.feature(vertices);
        let position = |v| at.at(v);
        let outward = self.vertex_to_facet.pseudo_normal(&self.boundary, position, facet, feature);
        let points = facet_points(vertices, at);
        let size = (points[1] - points[0]).norm();
        if feature == Feature::Facet {
            return (-outward, Tensor::zeros());
        }
        // ∇Π = Σ_k (x_k - Π) ⊗ ∇l_k, l_k the barycentric coordinates of the closest point.
        let gradients = points[..D].iter().zip(&foot.gradient);
        let gradient = gradients.map(|(point, gradient)| (point - foot.point) * gradient.transpose()).sum();
        normal_at_kink(x, &foot.point, outward, size, &gradient)
    }
}

/// Returns the normal into the obstacle and its derivative at a closest point on an edge or vertex, given the
/// pseudo-normal, a length, and the derivative of the closest point.
fn normal_at_kink<const D: usize>(
    x: &Point<D>,
    closest: &Point<D>,
    outward: Vector<D>,
    size: f64,
    gradient: &Tensor<D>,
) -> (Vector<D>, Tensor<D>) {
    let away = x - closest;
    let distance = away.norm();
    if distance <= TOUCHING * size {
        return (-outward, Tensor::zeros());
    }
    let gap = if away.dot(&outward) >= 0.0 { distance } else { -distance };
    let normal = -away / gap;
    // ∇n = -(I - n nᵀ - ∇Π)/Δ
    (normal, -(Tensor::identity() - normal * normal.transpose() - gradient) / gap)
}

impl<const D: usize> Obstacle<D> for DeformableObstacle<D> {
    fn project(&self, x: &Point<D>, at: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        let flat = || self.closest(x, at, candidates).map(|found| self.projection(x, &found, at));
        self.curved(x, at, candidates).or_else(flat)
    }

    fn facet_under(&self, corners: &[Point<D>; D], at: Positions<'_, D>, candidates: &[FacetId]) -> Option<FacetId> {
        if self.boundary.order() != Order::Linear {
            return None;
        }
        let centre: Point<D> = corners.iter().map(|corner| corner / D as f64).sum();
        let (facet, foot) = self.closest(&centre, at, candidates)?;
        let points = facet_points(self.boundary.facet(facet), at);
        let normals = facet_normal(&points[..D]).dot(&facet_normal(corners));
        if foot.feature(self.boundary.facet(facet)) != Feature::Facet || normals > FACING {
            return None;
        }
        let length =
            (1..D).map(|k| (corners[k] - corners[k - 1]).norm()).fold((corners[D - 1] - corners[0]).norm(), f64::max);
        let is_closest = |corner: &Point<D>| {
            let plane = Foot::on_plane(corner, &points[..D]).map(|foot| foot.squared_distance.sqrt());
            let closest = self.closest(corner, at, candidates).map(|(_, foot)| foot.squared_distance.sqrt());
            plane.zip(closest).is_some_and(|(plane, closest)| plane <= closest + CLOSER * length)
        };
        corners.iter().all(is_closest).then_some(facet)
    }

    fn project_on_plane(&self, facet: FacetId, x: &Point<D>, at: Positions<'_, D>) -> Option<Projection<D>> {
        let points = facet_points(self.boundary.facet(facet), at);
        let foot = Foot::on_plane(x, &points[..D])?;
        let is_near = foot.barycentric[..D].iter().all(|coordinate| *coordinate >= -FARTHEST_OUTSIDE);
        is_near.then(|| self.projection(x, &(facet, foot), at))
    }

    fn is_past_end(&self, x: &Point<D>, at: Positions<'_, D>, candidates: &[FacetId]) -> bool {
        if self.is_touchable.is_empty() {
            return false;
        }
        let Some(closest) = self.closest(x, at, candidates) else { return false };
        let is_behind = self.projection(x, &closest, at).gap(x) < 0.0;
        let is_on_rim = self.is_on_rim(&closest);
        if !is_behind && !is_on_rim {
            return false;
        }
        let [height, size] = self.height_and_size(x, &closest, at);
        let is_beside = is_on_rim && !self.is_over_facet(x, &closest, at);
        if is_behind && is_beside && height > 0.0 {
            return true;
        }
        // The same with all facets of the boundary: in front of a facet that cannot be touched the point is outside.
        let all: Vec<_> = self.boundary.facets().collect();
        let Some(nearest) = self.closest(x, at, &all) else { return false };
        let is_outside = self.projection(x, &nearest, at).gap(x) > TOUCHING * size;
        is_outside && (is_behind || nearest.1.is_closer_than(closest.1.squared_distance))
    }

    fn boundary(&self) -> Option<&BoundaryMesh<D>> {
        Some(&self.boundary)
    }

    fn smallest_gap(&self, points: &[Point<D>], at: Positions<'_, D>) -> Option<f64> {
        let positions = at.all();
        self.smallest_gap_with(&self.index(&positions), points, &positions)
    }

    fn candidates(
        &self,
        slave: Placed<'_, D>,
        facets: &[FacetId],
        positions: &[Point<D>],
        reach: f64,
    ) -> Option<Vec<Vec<FacetId>>> {
        let own = Placed::new(&self.boundary, positions);
        let bulges = self.bulge(positions) + slave.bulge(facets.iter().copied());
        if !bounds(slave, facets).expanded(reach + bulges).overlaps(&bounds(own, &self.facets)) {
            return Some(vec![Vec::new(); facets.len()]);
        }
        Some(self.candidates_with(&self.index(positions), slave, facets, positions, reach))
    }
}

/// Returns the box around facets.
fn bounds<const D: usize>(surface: Placed<'_, D>, facets: &[FacetId]) -> Aabb<D> {
    let boxes = facets.iter().map(|&facet| Aabb::of_points(&surface.facet_points(facet)[..D]));
    boxes.fold(Aabb::empty(), |all, one| all.union(&one))
}

/// Returns the points of a facet; only the first `D` are used.
#[inline]
fn facet_points<const D: usize>(vertices: &[VertexId], at: Positions<'_, D>) -> [Point<D>; MAX_FACET_VERTICES] {
    let mut points = [Point::zeros(); MAX_FACET_VERTICES];
    for (slot, &v) in points.iter_mut().zip(vertices) {
        *slot = at.at(v);
    }
    points
}
