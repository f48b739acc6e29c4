//! Candidates of an item that may contain the closest point to a point.

use mesh::search::Foot;
use mesh::{Aabb, BoundaryMesh, FacetId, MAX_FACET_VERTICES, Order, Point};

use crate::{Obstacle, Positions, Projection};

/// Relative margin of squared distances, larger than that within which closest points are equally close.
const MARGIN: f64 = 1e-6;
/// Margin of distances relative to the length of an edge, larger than round-off.
const ROUND_OFF: f64 = 1e-10;

/// Facets of an obstacle at one state, with the boxes around them.
pub(crate) struct NearFacets<'i, const D: usize> {
    obstacle: &'i dyn Obstacle<D>,
    candidates: &'i [FacetId],
    positions: Positions<'i, D>,
    /// Box and vertices of each candidate; an empty list before the first search, and if all candidates are searched.
    boxes: Vec<(Aabb<D>, [Point<D>; MAX_FACET_VERTICES])>,
    near: Vec<FacetId>,
}

impl<'i, const D: usize> NearFacets<'i, D> {
    /// Creates the facets of an obstacle that is at `positions`.
    pub(crate) fn new(obstacle: &'i dyn Obstacle<D>, candidates: &'i [FacetId], positions: Positions<'i, D>) -> Self {
        Self { obstacle, candidates, positions, boxes: Vec::new(), near: Vec::new() }
    }

    /// Returns the projection of a point onto the plane of a facet, or else the closest point.
    pub(crate) fn project(&mut self, x: &Point<D>, facet: Option<FacetId>) -> Option<Projection<D>> {
        let on_plane = facet.and_then(|facet| self.obstacle.project_on_plane(facet, x, self.positions));
        on_plane.or_else(|| self.obstacle.project(x, self.positions, self.of(x)))
    }

    /// Computes the boxes of the candidates. Curved facets and facets of an obstacle at rest have none.
    fn boxes(&self) -> Vec<(Aabb<D>, [Point<D>; MAX_FACET_VERTICES])> {
        let boundary = self.obstacle.boundary().filter(|boundary| boundary.order() == Order::Linear);
        let of_facet = |boundary: &BoundaryMesh<D>, facet| {
            let mut points = [Point::zeros(); MAX_FACET_VERTICES];
            let vertices = points.iter_mut().zip(boundary.facet(facet));
            vertices.for_each(|(point, vertex)| *point = self.positions.at(*vertex));
            (Aabb::of_points(&points[..D]), points)
        };
        let boxes = boundary.map(|boundary| self.candidates.iter().map(|&facet| of_facet(boundary, facet)).collect());
        boxes.unwrap_or_default()
    }

    /// Returns the candidates that may contain the closest point to `x`, in their order: those whose boxes are not
    /// farther away than the closest point of the facet in the nearest box.
    fn of(&mut self, x: &Point<D>) -> &[FacetId] {
        if self.boxes.is_empty() {
            self.boxes = self.boxes();
        }
        let nearest = self.boxes.iter().map(|(around, points)| (around.squared_distance(x), points));
        let Some((_, points)) = nearest.reduce(|nearest, other| if other.0 < nearest.0 { other } else { nearest })
        else {
            return self.candidates;
        };
        let round_off = ROUND_OFF * ROUND_OFF * (points[1] - points[0]).norm_squared();
        let farthest = Foot::on_facet(x, &points[..D]).squared_distance * (1.0 + MARGIN) + round_off;
        let candidates = self.candidates.iter().zip(&self.boxes);
        let near = candidates.filter(|(_, (around, _))| around.squared_distance(x) <= farthest);
        self.near.clear();
        self.near.extend(near.map(|(facet, _)| facet));
        &self.near
    }
}

#[cfg(test)]
mod tests {
    use mesh::Vector;
    use mesh::generate::{BallOptions, ball};
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::SplitMix64;

    use super::*;
    use crate::DeformableObstacle;

    /// Compares projections onto near facets with those onto all facets of a ball whose vertices are moved at random.
    fn near_facets_have_the_closest_point<const D: usize>() {
        let mut random = SplitMix64::seed_from_u64(5);
        let mut vector = |size: f64| Vector::<D>::from_fn(|_, _| random.random_range(-size..size));
        let mesh = ball([0.0; D], 1.0, 0.4, &BallOptions::default()).expect("a ball");
        let boundary = mesh.boundary();
        let facets: Vec<_> = boundary.facets().collect();
        let positions: Vec<_> = mesh.vertices().iter().map(|x| x + vector(0.05)).collect();
        let obstacle = DeformableObstacle::new(boundary.clone(), facets.clone()).expect("facets");
        let at = Positions::Fixed(&positions);
        let mut near = NearFacets::new(&obstacle, &facets, at);
        let on_vertices = boundary.facet(facets[0]).iter().map(|vertex| at.at(*vertex)).collect::<Vec<_>>();
        let around = (0..500).map(|_| Point::from(vector(1.2))).collect::<Vec<_>>();
        for x in around.iter().chain(&on_vertices) {
            assert_eq!(near.project(x, None), obstacle.project(x, at, &facets), "{x}");
            assert!(near.near.len() < facets.len());
        }
    }

    #[test]
    fn near_facets_have_the_closest_point_in_2d_and_3d() {
        near_facets_have_the_closest_point::<2>();
        near_facets_have_the_closest_point::<3>();
    }
}
