//! A ball that does not move.

use mesh::{FacetId, Point, Tensor, Vector};

use super::{Anchor, Obstacle, Projection};
use crate::{Error, Positions};

/// A disk or ball, or all that is outside of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBall<const D: usize> {
    centre: Point<D>,
    radius: f64,
    /// 1 if the ball is the obstacle, -1 if its outside is.
    side: f64,
}

impl<const D: usize> RigidBall<D> {
    /// Creates a ball that bodies must not enter.
    ///
    /// # Errors
    /// [`Error::Parameter`]: the radius is not positive.
    pub fn new(centre: Point<D>, radius: f64) -> Result<Self, Error> {
        Ok(Self { centre, radius: mesh::positive("radius of the obstacle", radius)?, side: 1.0 })
    }

    /// Creates a round container that bodies must not leave.
    ///
    /// # Errors
    /// As [`RigidBall::new`].
    pub fn hollow(centre: Point<D>, radius: f64) -> Result<Self, Error> {
        Ok(Self { side: -1.0, ..Self::new(centre, radius)? })
    }
}

impl<const D: usize> Obstacle<D> for RigidBall<D> {
    /// Returns the closest point of the sphere; the centre has none.
    fn project(&self, x: &Point<D>, _positions: Positions<'_, D>, _candidates: &[FacetId]) -> Option<Projection<D>> {
        let arm = x - self.centre;
        let direction: Vector<D> = arm.try_normalize(0.0)?;
        let across = Tensor::identity() - direction * direction.transpose();
        Some(Projection {
            point: self.centre + direction * self.radius,
            normal: direction * -self.side,
            normal_gradient: across * (-self.side / arm.norm()),
            anchor: Anchor::Fixed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_obstacle;
    use super::*;

    #[test]
    fn is_an_obstacle_on_both_sides() {
        let centre = Point::<3>::new(1.0, 2.0, 3.0);
        let points: Vec<_> = (0..20).map(|k| Point::<3>::from_fn(|a, _| ((3 * k + a) as f64).sin() * 5.0)).collect();
        for ball in [RigidBall::new(centre, 2.0), RigidBall::hollow(centre, 2.0)] {
            let check = check_obstacle(&ball.expect("a ball"), Positions::Fixed(&[]), &[], &points);
            assert!(check.n_projected == 20 && check.largest() < 1e-8, "{check:?}");
        }
    }

    #[test]
    fn gaps_have_the_sign_of_the_side() {
        let (centre, x) = (Point::<2>::new(1.0, 0.0), Point::<2>::new(1.0, 3.0));
        let gap = |ball: RigidBall<2>| ball.project(&x, Positions::Fixed(&[]), &[]).map(|p| p.gap(&x));
        assert_eq!(gap(RigidBall::new(centre, 2.0).expect("a ball")), Some(1.0));
        assert_eq!(gap(RigidBall::hollow(centre, 2.0).expect("a container")), Some(-1.0));
        assert!(RigidBall::new(centre, 0.0).is_err());
    }
}
