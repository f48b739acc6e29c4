//! The boundary of a body as an obstacle to itself.

use mesh::{Aabb, BoundaryMesh, FacetId, Placed, Point, facet_normal};

use super::{DeformableObstacle, Obstacle, Projection};
use crate::{Error, Positions};

/// Part of the boundary of a body that acts as an obstacle to the same part.
///
/// A facet may touch another one if
/// - their boxes are farther apart than the exempt distance in the undeformed body: neighbours along the surface, and
///   the two sides of a thin part, are not in contact;
/// - their normals oppose each other at the start of the step;
/// - no vertex of one is then deeper behind the other than half the exempt distance: facets that face each other
///   through the body are not in contact.
///
/// Closest points and normals are those of [`DeformableObstacle`].
#[derive(Clone, Debug)]
pub struct OwnSurface<const D: usize> {
    surface: DeformableObstacle<D>,
    reference: Vec<Point<D>>,
    exempt: f64,
}

impl<const D: usize> OwnSurface<D> {
    /// Creates the obstacle from some facets of a closed boundary, the positions of the vertices of the undeformed
    /// body, and the exempt distance. It is at least the distance at which the law acts, and less than the thickness of
    /// the parts between which contact is searched.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`]: the boundary does not have one of the facets. [`Error::Parameter`]: the distance is not
    /// positive.
    pub fn new(
        boundary: BoundaryMesh<D>,
        facets: Vec<FacetId>,
        reference: Vec<Point<D>>,
        exempt: f64,
    ) -> Result<Self, Error> {
        mesh::positive("exempt distance of a surface from itself", exempt)?;
        Ok(Self { surface: DeformableObstacle::new(boundary, facets)?, reference, exempt })
    }

    /// Returns whether one facet may touch another one, at positions at the start of a step.
    fn may_touch(&self, facet: FacetId, other: FacetId, positions: &[Point<D>]) -> bool {
        let boundary = &self.surface.boundary;
        let points = |facet, positions| Placed::new(boundary, positions).facet_points(facet);
        let [here, there] = [facet, other].map(|facet| Aabb::of_points(&points(facet, &self.reference)[..D]));
        if here.distance(&there) <= self.exempt {
            return false;
        }
        let corners = [facet, other].map(|facet| points(facet, positions));
        let normals = corners.each_ref().map(|corners| facet_normal(&corners[..D]));
        let is_behind = |k: usize| {
            let depth = |x: &Point<D>| (corners[k][0] - x).dot(&normals[k]);
            corners[1 - k][..D].iter().any(|x| depth(x) > 0.5 * self.exempt)
        };
        normals[0].dot(&normals[1]) < 0.0 && !is_behind(0) && !is_behind(1)
    }
}

impl<const D: usize> Obstacle<D> for OwnSurface<D> {
    fn project(&self, x: &Point<D>, at: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        self.surface.project(x, at, candidates)
    }

    fn boundary(&self) -> Option<&BoundaryMesh<D>> {
        self.surface.boundary()
    }

    /// Returns `None`: the gap of a point of a surface to the whole of this surface is zero. Only gaps to candidates
    /// are meaningful.
    fn smallest_gap(&self, _points: &[Point<D>], _positions: Positions<'_, D>) -> Option<f64> {
        None
    }

    fn candidates(
        &self,
        slave: Placed<'_, D>,
        facets: &[FacetId],
        positions: &[Point<D>],
        reach: f64,
    ) -> Option<Vec<Vec<FacetId>>> {
        let mut found = self.surface.candidates(slave, facets, positions, reach)?;
        for (&facet, candidates) in facets.iter().zip(&mut found) {
            candidates.retain(|&other| self.may_touch(facet, other, positions));
        }
        Some(found)
    }
}
