//! Obstacles: closest points, normals and gaps.

mod check;
mod curved;
mod deformable;
mod own;
mod rigid_ball;
mod rigid_plane;
mod rigid_surface;

pub use check::{ObstacleCheck, check_obstacle};
pub use deformable::DeformableObstacle;
pub use own::OwnSurface;
pub use rigid_ball::RigidBall;
pub use rigid_plane::RigidPlane;
pub use rigid_surface::RigidSurface;

use mesh::{BoundaryMesh, FacetId, MAX_FACET_NODES, Placed, Point, Tensor, Vector};

use crate::Positions;

/// Support of the closest point, on which the reaction acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor<const D: usize> {
    /// A point that does not move.
    Fixed,
    /// A facet of the obstacle's boundary. Arrays have one entry per node of the facet ([`BoundaryMesh::nodes`]).
    Facet {
        /// The facet.
        facet: FacetId,
        /// Smallest barycentric coordinate of the closest point in the facet.
        inside: f64,
        /// Shape functions `N_a` at the closest point; zero at nodes that do not carry it.
        shape: [f64; MAX_FACET_NODES],
        /// Derivatives `G_a` of the shape functions with respect to the point that is projected.
        gradient: [Vector<D>; MAX_FACET_NODES],
        /// Metric `W`. When a node `b` of the facet moves by `δ`, `N_a` changes by `-N_b G_a · δ - Δ (G_a · W G_b) n ·
        /// δ`, with the gap `Δ` and the normal `n`. It is the identity for flat facets.
        metric: Tensor<D>,
    },
}

/// Closest point `Π(x)` of an obstacle to a point `x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<const D: usize> {
    /// The closest point.
    pub point: Point<D>,
    /// Unit normal `n^w`, into the obstacle.
    pub normal: Vector<D>,
    /// Derivative of the normal with respect to `x`, the obstacle at rest: `[(a, b)] = ∂n_a/∂x_b`, symmetric.
    pub normal_gradient: Tensor<D>,
    /// Support on which the reaction acts.
    pub anchor: Anchor<D>,
}

impl<const D: usize> Projection<D> {
    /// Returns the gap `Δ = (Π(x) - x) · n^w`, negative when `x` has penetrated.
    ///
    /// Source: paper, Sec. 2.2.
    #[inline]
    pub fn gap(&self, x: &Point<D>) -> f64 {
        (self.point - x).dot(&self.normal)
    }
}

/// Geometry that a body must not enter.
pub trait Obstacle<const D: usize>: Send + Sync + std::fmt::Debug {
    /// Returns the closest point to `x`, or `None` if no candidate has one.
    ///
    /// `positions` are the positions of the vertices of the obstacle's own body, not used by obstacles at rest.
    /// `candidates` are the facets that are searched, not used by obstacles without facets.
    fn project(&self, x: &Point<D>, positions: Positions<'_, D>, candidates: &[FacetId]) -> Option<Projection<D>>;

    /// Returns the flat facet that a segment of the slave faces: the closest point to its centre is in the interior of
    /// the facet, the normals are opposite up to 60 degrees, and at no corner another facet is closer by more than a
    /// tenth of the longest edge of the segment. `None` without such a facet.
    fn facet_under(
        &self,
        _corners: &[Point<D>; D],
        _positions: Positions<'_, D>,
        _candidates: &[FacetId],
    ) -> Option<FacetId> {
        None
    }

    /// Returns the projection of `x` onto the plane of a facet of [`Self::facet_under`], with shape functions that may
    /// be negative; `None` if it is outside of the facet by more than a quarter of its height. Then [`Self::project`]
    /// is used.
    fn project_on_plane(&self, _facet: FacetId, _x: &Point<D>, _positions: Positions<'_, D>) -> Option<Projection<D>> {
        None
    }

    /// Returns whether a point is past the end of the facets that can be touched, where the gap to them has no meaning:
    ///
    /// - the gap is negative, but the point is outside of the surface, in front of a facet that cannot be touched;
    /// - the gap is negative, and the point is past the rim in front of the plane of the facet;
    /// - the closest point is on the rim, and a facet that cannot be touched is closer.
    ///
    /// Such a point at the start of a step is not in contact during this step.
    fn is_past_end(&self, _x: &Point<D>, _positions: Positions<'_, D>, _candidates: &[FacetId]) -> bool {
        false
    }

    /// Returns the boundary that the facets of candidates and anchors belong to; `None` for a rigid obstacle.
    fn boundary(&self) -> Option<&BoundaryMesh<D>> {
        None
    }

    /// Returns the smallest gap of points to the whole obstacle; `None` if none of them has a closest point.
    fn smallest_gap(&self, points: &[Point<D>], positions: Positions<'_, D>) -> Option<f64> {
        let gap = |x: &Point<D>| self.project(x, positions, &[]).map(|found| found.gap(x));
        points.iter().filter_map(gap).reduce(f64::min)
    }

    /// Returns, for each of the slave's `facets`, the facets of the obstacle, with vertices at `positions`, within the
    /// distance `reach`. `None` for an obstacle without facets, whose closest points are found at any distance.
    ///
    /// Candidates are found once per step, so that the sparsity pattern does not change when projections move.
    fn candidates(
        &self,
        _slave: Placed<'_, D>,
        _facets: &[FacetId],
        _positions: &[Point<D>],
        _reach: f64,
    ) -> Option<Vec<Vec<FacetId>>> {
        None
    }
}
