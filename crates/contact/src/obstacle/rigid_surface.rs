//! A closed surface that does not move.

use mesh::search::SurfaceIndex;
use mesh::{BoundaryMesh, FacetId, Point};

use super::{Anchor, DeformableObstacle, Obstacle, Projection};
use crate::{Error, Positions};

/// A polygon or polyhedron at rest, or some of its facets.
///
/// Closest points and normals are those of [`DeformableObstacle`]. Normals point out of the obstacle; a container is a surface whose
/// facets are reversed, see [`BoundaryMesh::reversed`].
#[derive(Clone, Debug)]
pub struct RigidSurface<const D: usize> {
    surface: DeformableObstacle<D>,
    positions: Vec<Point<D>>,
    /// Index of the facets that can be touched, in their order.
    index: SurfaceIndex<D>,
}

impl<const D: usize> RigidSurface<D> {
    /// Creates the obstacle from some facets of a closed surface and the positions of its vertices.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`]: the surface does not have one of the facets.
    pub fn new(surface: BoundaryMesh<D>, facets: Vec<FacetId>, positions: Vec<Point<D>>) -> Result<Self, Error> {
        let surface = DeformableObstacle::new(surface, facets)?;
        let index = surface.index(&positions);
        Ok(Self { surface, positions, index })
    }
}

impl<const D: usize> Obstacle<D> for RigidSurface<D> {
    fn project(&self, x: &Point<D>, _positions: Positions<'_, D>, _candidates: &[FacetId]) -> Option<Projection<D>> {
        let found = self.surface.project_with(&self.index, x, Positions::Fixed(&self.positions), &mut Vec::new())?;
        Some(Projection { anchor: Anchor::Fixed, ..found })
    }
}

#[cfg(test)]
mod tests {
    use mesh::generate::structured_box;

    use super::super::check_obstacle;
    use super::*;

    fn square(is_hollow: bool) -> RigidSurface<2> {
        let square = structured_box([0.0, 0.0], [1.0, 1.0], [3, 3]).expect("a mesh");
        let surface = if is_hollow { square.boundary().reversed() } else { square.boundary() };
        let facets = surface.facets().collect();
        RigidSurface::new(surface, facets, square.vertices().to_vec()).expect("facets")
    }

    #[test]
    fn is_an_obstacle() {
        let points: Vec<_> =
            (0..20).map(|k| Point::<2>::from_fn(|a, _| 0.5 + 0.9 * ((3 * k + a) as f64).sin())).collect();
        for is_hollow in [false, true] {
            let check = check_obstacle(&square(is_hollow), Positions::Fixed(&[]), &[], &points);
            assert!(check.n_projected == 20 && check.largest() < 1e-7, "{check:?}");
        }
    }

    #[test]
    fn gaps_have_the_sign_of_the_side() {
        for (x, gap) in [([0.5, 1.25], 0.25), ([0.5, 0.875], -0.125), ([2.0, 1.0], 1.0), ([4.0, 5.0], 5.0)] {
            let x = Point::<2>::from(x);
            for (is_hollow, side) in [(false, 1.0), (true, -1.0)] {
                let found = square(is_hollow).project(&x, Positions::Fixed(&[]), &[]).expect("a point");
                assert!((found.gap(&x) - side * gap).abs() < 1e-12, "{x}: {}", found.gap(&x));
                assert_eq!(found.anchor, Anchor::Fixed);
            }
        }
    }
}
