//! Candidates of an item that may contain the closest point to a point.

use mesh::search::Foot;
use mesh::{Aabb, FacetId, MAX_FACET_VERTICES, Order, Point};

use crate::{Obstacle, Positions};

/// Relative margin of squared distances, above that within which closest points are equally close.
const MARGIN: f64 = 1e-6;

/// Facets of an obstacle at one state, with the boxes around them.
pub(crate) struct NearFacets<'i, const D: usize> {
    candidates: &'i [FacetId],
    /// Box and vertices of each candidate; an empty list if all candidates are searched.
    boxes: Vec<(Aabb<D>, [Point<D>; MAX_FACET_VERTICES])>,
    near: Vec<FacetId>,
}

impl<'i, const D: usize> NearFacets<'i, D> {
    /// Computes the boxes of the candidates of an obstacle that is at `positions`. Curved facets and facets of an
    /// obstacle at rest have none.
    pub(crate) fn new(obstacle: &dyn Obstacle<D>, candidates: &'i [FacetId], positions: Positions<'_, D>) -> Self {
        let mut boxes = Vec::new();
        if let Some(boundary) = obstacle.boundary().filter(|boundary| boundary.order() == Order::Linear) {
            boxes.extend(candidates.iter().map(|&facet| {
                let mut points = [Point::zeros(); MAX_FACET_VERTICES];
                points.iter_mut().zip(boundary.facet(facet)).for_each(|(point, vertex)| *point = positions.at(*vertex));
                (Aabb::of_points(&points[..D]), points)
            }));
        }
        Self { candidates, boxes, near: Vec::new() }
    }

    /// Returns the candidates that may contain the closest point to `x`, in their order: those whose boxes are not
    /// farther away than the closest point of the facet in the nearest box.
    pub(crate) fn of(&mut self, x: &Point<D>) -> &[FacetId] {
        let nearest = self.boxes.iter().map(|(around, points)| (around.squared_distance(x), points));
        let Some((_, points)) = nearest.reduce(|nearest, other| if other.0 < nearest.0 { other } else { nearest })
        else {
            return self.candidates;
        };
        let farthest = Foot::on_facet(x, &points[..D]).squared_distance * (1.0 + MARGIN);
        let candidates = self.candidates.iter().zip(&self.boxes);
        let near = candidates.filter(|(_, (around, _))| around.squared_distance(x) <= farthest);
        self.near.clear();
        self.near.extend(near.map(|(facet, _)| facet));
        &self.near
    }
}
