//! The boundary of a body as an obstacle to itself.

use mesh::search::facets_are_within;
use mesh::{BoundaryMesh, FacetId, MAX_FACET_VERTICES, Placed, Point, facet_normal};

use super::{DeformableObstacle, Obstacle, Projection};
use crate::{Error, Positions};

/// Part of the boundary of a body that acts as an obstacle to the same part.
///
/// A facet may touch another one, with elements of order 2 a part of one, if for this part and the others of its
/// element
/// - they are farther apart than the exempt distance in the undeformed body: neighbours along the surface, and
///   the two sides of a thin part, are not in contact;
/// - their normals oppose each other at the start of the step;
/// - no vertex of one facet is deeper behind the other, at the start of the step, than half of the exempt distance. If
///   the normals oppose each other in the undeformed body, half of the depth in the undeformed body is another limit:
///   facets that face each other through the body are not in contact.
///
/// Closest points and normals are those of [`DeformableObstacle`]. A negative gap is used only if all facets around the
/// closest point may be touched. Otherwise the closest point is an end of the facets that were searched, and the sign
/// of the gap has no meaning. The two sides of a re-entrant corner are an example.
#[derive(Clone, Debug)]
pub struct OwnSurface<const D: usize> {
    surface: DeformableObstacle<D>,
    reference: Vec<Point<D>>,
    exempt: f64,
}

impl<const D: usize> OwnSurface<D> {
    /// Creates the obstacle from some facets of a closed boundary, the positions of the vertices of the undeformed
    /// body, and the exempt distance. This distance must be at least the distance at which the law acts, and less than
    /// twice the thickness of the parts between which contact is searched.
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
        let corners = |positions| [facet, other].map(|facet| Placed::new(boundary, positions).facet_points(facet));
        let undeformed = corners(&self.reference);
        let [here, there] = undeformed.each_ref().map(|corners| &corners[..D]);
        if facets_are_within(self.exempt, here, there) {
            return false;
        }
        let (before, now) = (Facing::new(&undeformed), Facing::new(&corners(positions)));
        let is_behind = |k: usize| {
            let depth = if before.is_opposite && before.depths[k] > 0.0 { before.depths[k] } else { self.exempt };
            now.depths[k] > 0.5 * depth.min(self.exempt)
        };
        now.is_opposite && !is_behind(0) && !is_behind(1)
    }
}

/// Orientation of two facets relative to each other.
struct Facing {
    /// Whether their normals oppose each other.
    is_opposite: bool,
    /// Largest depth of the vertices of the second behind the plane of the first, and of the first behind the second.
    depths: [f64; 2],
}

impl Facing {
    /// Creates the orientation of two facets with the given vertices.
    fn new<const D: usize>(corners: &[[Point<D>; MAX_FACET_VERTICES]; 2]) -> Self {
        let normals = corners.each_ref().map(|corners| facet_normal(&corners[..D]));
        let deepest = |k: usize| {
            let depth = |x: &Point<D>| (corners[k][0] - x).dot(&normals[k]);
            corners[1 - k][..D].iter().map(depth).fold(f64::NEG_INFINITY, f64::max)
        };
        Self { is_opposite: normals[0].dot(&normals[1]) < 0.0, depths: [deepest(0), deepest(1)] }
    }
}

impl<const D: usize> Obstacle<D> for OwnSurface<D> {
    fn project(&self, x: &Point<D>, at: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        let closest = self.surface.closest(x, at, candidates)?;
        let found = self.surface.projection(x, &closest, at);
        let found = self.surface.curved(x, at, candidates).unwrap_or(found);
        let is_known = found.gap(x) >= 0.0 || self.surface.holds_around(&closest, |facet| candidates.contains(facet));
        is_known.then_some(found)
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
            // The closest point may lie on any part of a curved element.
            let boundary = &self.surface.boundary;
            let may_touch =
                |&element: &usize| boundary.parts_of(element).all(|part| self.may_touch(facet, part, positions));
            let elements = boundary.by_element(candidates).map(|parts| boundary.element_of(parts[0]).0);
            *candidates = elements.filter(may_touch).flat_map(|element| boundary.parts_of(element)).collect();
        }
        Some(found)
    }
}
