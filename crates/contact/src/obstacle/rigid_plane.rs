//! A plane that does not move.

use mesh::{FacetId, Point, Tensor, Vector};

use super::{Anchor, Obstacle, Projection};
use crate::{Error, Positions};

/// The half space behind a plane: all points `x` with `(x - point) · normal > 0`.
///
/// Source: paper, Sec. 2.2, Sec. 4.1 (virtual barrier) and Sec. 4.2 (rigid ground).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPlane<const D: usize> {
    point: Point<D>,
    normal: Vector<D>,
}

impl<const D: usize> RigidPlane<D> {
    /// Creates the plane through `point` with a normal (of any length) that points **into the obstacle**.
    ///
    /// # Errors
    /// [`Error::Parameter`]: the normal is zero or not finite.
    pub fn new(point: Point<D>, normal: Vector<D>) -> Result<Self, Error> {
        let length = mesh::positive("length of the obstacle's normal", normal.norm())?;
        Ok(Self { point, normal: normal / length })
    }
}

impl<const D: usize> Obstacle<D> for RigidPlane<D> {
    #[inline]
    fn project(&self, x: &Point<D>, _positions: Positions<'_, D>, _candidates: &[FacetId]) -> Option<Projection<D>> {
        let gap = (self.point - x).dot(&self.normal);
        Some(Projection {
            point: x + gap * self.normal,
            normal: self.normal,
            normal_gradient: Tensor::zeros(),
            anchor: Anchor::Fixed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_obstacle;
    use super::*;

    #[test]
    fn is_an_obstacle() {
        let plane = RigidPlane::new(Point::<3>::new(1.0, 2.0, 3.0), Vector::<3>::new(0.3, -4.0, 0.1)).unwrap();
        let points: Vec<_> = (0..20).map(|k| Point::<3>::from_fn(|a, _| ((3 * k + a) as f64).sin() * 5.0)).collect();
        let check = check_obstacle(&plane, Positions::Fixed(&[]), &[], &points);
        assert!(check.n_projected == 20 && check.largest() < 1e-8, "{check:?}");
    }

    #[test]
    fn gap_changes_sign_at_the_plane() {
        let ground = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -2.0)).unwrap();
        for y in [0.5, -0.25] {
            let x = Point::<2>::new(7.0, y);
            let projection = ground.project(&x, Positions::Fixed(&[]), &[]).unwrap();
            assert_eq!(projection.gap(&x), y);
            assert_eq!(projection.point, Point::<2>::new(7.0, 0.0));
        }
    }

    #[test]
    fn a_plane_needs_a_normal() {
        assert!(RigidPlane::new(Point::<2>::zeros(), Vector::<2>::zeros()).is_err());
    }
}
