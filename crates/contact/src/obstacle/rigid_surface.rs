//! A closed surface that does not move.

use mesh::search::SurfaceIndex;
use mesh::{BoundaryMesh, FacetId, Placed, Point};

use super::{Anchor, DeformableObstacle, Obstacle, Projection};
use crate::{Error, Positions};

/// A polygon or polyhedron at rest, or some of its facets.
///
/// Closest points and normals are those of [`DeformableObstacle`]. Normals point out of the obstacle; a container is a
/// surface whose facets are reversed, see [`BoundaryMesh::reversed`].
#[derive(Clone, Debug)]
pub struct RigidSurface<const D: usize> {
    surface: DeformableObstacle<D>,
    positions: Vec<Point<D>>,
    /// Search structure of the facets that can be touched.
    index: SurfaceIndex<D>,
    /// Largest distance between curved elements and their facets.
    bulge: f64,
}

impl<const D: usize> RigidSurface<D> {
    /// Creates the obstacle from some facets of a closed surface and the positions of its vertices.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`]: the surface does not have one of the facets.
    pub fn new(surface: BoundaryMesh<D>, facets: Vec<FacetId>, positions: Vec<Point<D>>) -> Result<Self, Error> {
        let surface = DeformableObstacle::new(surface, facets)?;
        let (index, bulge) = (surface.index(&positions), surface.bulge(&positions));
        Ok(Self { surface, positions, index, bulge })
    }
}

impl<const D: usize> Obstacle<D> for RigidSurface<D> {
    fn project(&self, x: &Point<D>, _positions: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>> {
        let found = self.surface.project(x, Positions::Fixed(&self.positions), candidates)?;
        Some(Projection { anchor: Anchor::Fixed, ..found })
    }

    fn is_past_end(&self, x: &Point<D>, _positions: Positions<'_, D>, candidates: &[FacetId]) -> bool {
        self.surface.is_past_end(x, Positions::Fixed(&self.positions), candidates)
    }

    fn smallest_gap(&self, points: &[Point<D>], _positions: Positions<'_, D>) -> Option<f64> {
        // All points are tested: a point that is far behind a container or a wall has a large distance and a negative
        // gap.
        points
            .iter()
            .filter_map(|x| self.surface.gap_with((&self.index, self.bulge), x, &self.positions))
            .reduce(f64::min)
    }

    fn candidates(
        &self,
        slave: Placed<'_, D>,
        facets: &[FacetId],
        _positions: &[Point<D>],
        reach: f64,
    ) -> Option<Vec<Vec<FacetId>>> {
        Some(self.surface.candidates_with(&self.index, slave, facets, &self.positions, reach))
    }
}

#[cfg(test)]
mod tests {
    use mesh::VertexId;
    use mesh::generate::structured_box;

    use super::super::check_obstacle;
    use super::*;

    fn square(is_hollow: bool) -> RigidSurface<2> {
        let square = structured_box([0.0, 0.0], [1.0, 1.0], [3, 3]).expect("a mesh");
        let surface = if is_hollow { square.boundary().reversed() } else { square.boundary() };
        let facets = surface.facets().collect();
        RigidSurface::new(surface, facets, square.vertices().to_vec()).expect("facets")
    }

    /// Returns the lower side of a hollow square.
    fn floor() -> RigidSurface<2> {
        let square = structured_box([0.0, 0.0], [1.0, 1.0], [3, 3]).expect("a mesh");
        let floor = square.tag("bottom").expect("a side");
        let surface = square.boundary().reversed();
        let facets = surface.facets().filter(|facet| surface.tag(*facet) == Some(floor)).collect();
        RigidSurface::new(surface, facets, square.vertices().to_vec()).expect("facets")
    }

    /// Returns the obstacle with some sides of a polygon, given by its corners. Side `k` ends at corner `k + 1`.
    fn sides(corners: &[[f64; 2]], touchable: &[usize]) -> RigidSurface<2> {
        let n = corners.len();
        let facets = (0..n).flat_map(|k| [VertexId::new(k), VertexId::new((k + 1) % n)]).collect();
        let positions = corners.iter().map(|x| Point::<2>::from(*x)).collect();
        let touchable = touchable.iter().map(|k| FacetId::new(*k)).collect();
        RigidSurface::new(BoundaryMesh::from_facets(facets), touchable, positions).expect("a polygon")
    }

    /// Checks which points are past the end of an obstacle.
    fn check_ends(obstacle: &RigidSurface<2>, touching: &[[f64; 2]], past: &[[f64; 2]]) {
        for (points, expected) in [(touching, false), (past, true)] {
            for x in points {
                let found = obstacle.is_past_end(&(*x).into(), Positions::Fixed(&[]), &obstacle.surface.facets);
                assert_eq!(found, expected, "{x:?}");
            }
        }
    }

    #[test]
    fn points_past_the_ends_of_a_wall_do_not_touch_it() {
        // The floor of a container whose right side is open.
        check_ends(&floor(), &[[0.5, -0.1], [0.5, 0.1], [0.0, -0.1], [1.0, -0.1], [0.9, 0.3]], &[[1.1, 0.02]]);
        // The top of a step: in front of its side, above the corner, inside.
        let step = sides(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]], &[2]);
        check_ends(
            &step,
            &[[1.02, 0.6], [0.9, 0.45], [0.999, 0.3], [0.5, 0.6]],
            &[[1.02, 0.45], [1.1, 0.45], [1.02, 0.49]],
        );
        // The top of a thin shelf, from below.
        let shelf = sides(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [0.0, 0.1]], &[2]);
        check_ends(&shelf, &[[0.5, 0.05], [0.5, 0.2]], &[[0.5, -0.02], [0.97, -0.02]]);
        // Half of a bowl, whose left side is a plane of symmetry.
        let bowl = sides(&[[0.0, -1.0], [1.0, -1.0], [1.0, 0.5], [0.0, 0.0]], &[2]);
        check_ends(&bowl, &[[0.0, -0.05], [1e-3, -0.05], [0.0, 0.05], [0.2, 0.0]], &[]);
    }

    /// A point far behind a wall has a smaller gap than a near one in front of it. Beyond the ends of the wall gaps
    /// have no sign.
    #[test]
    fn smallest_gap_to_a_wall_is_that_of_the_deepest_point() {
        let wall = floor();
        let gap = |points: &[[f64; 2]]| {
            let points: Vec<_> = points.iter().map(|x| Point::<2>::from(*x)).collect();
            wall.smallest_gap(&points, Positions::Fixed(&[]))
        };
        assert_eq!(gap(&[[0.5, 0.02], [0.4, -0.1], [0.6, 0.3]]), Some(-0.1));
        assert_eq!(gap(&[[0.5, 0.02], [0.4, 0.1]]), Some(0.02));
        assert_eq!(gap(&[[0.5, 0.02], [1.4, -0.1]]), Some(0.02));
    }

    fn all() -> Vec<FacetId> {
        (0..12).map(FacetId::new).collect()
    }

    #[test]
    fn is_an_obstacle() {
        let points: Vec<_> =
            (0..20).map(|k| Point::<2>::from_fn(|a, _| 0.5 + 0.9 * ((3 * k + a) as f64).sin())).collect();
        for is_hollow in [false, true] {
            let check = check_obstacle(&square(is_hollow), Positions::Fixed(&[]), &all(), &points);
            assert!(check.n_projected == 20 && check.largest() < 1e-7, "{check:?}");
        }
    }

    #[test]
    fn gaps_have_the_sign_of_the_side() {
        for (x, gap) in [([0.5, 1.25], 0.25), ([0.5, 0.875], -0.125), ([2.0, 1.0], 1.0), ([4.0, 5.0], 5.0)] {
            let x = Point::<2>::from(x);
            for (is_hollow, side) in [(false, 1.0), (true, -1.0)] {
                let found = square(is_hollow).project(&x, Positions::Fixed(&[]), &all()).expect("a point");
                assert_eq!(square(is_hollow).smallest_gap(&[x], Positions::Fixed(&[])), Some(found.gap(&x)));
                assert!((found.gap(&x) - side * gap).abs() < 1e-12, "{x}: {}", found.gap(&x));
                assert_eq!(found.anchor, Anchor::Fixed);
            }
        }
    }
}
