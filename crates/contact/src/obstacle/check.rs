//! Consistency of an obstacle with itself.

use algebra::worse;
use mesh::{FacetId, Point, Vector};

use super::Obstacle;
use crate::Positions;

/// Deviations found by [`check_obstacle`], relative to the extent of the points; all of them should be small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObstacleCheck {
    /// Points that have a projection.
    pub n_projected: usize,
    /// Length of the normal minus one.
    pub normal: f64,
    /// Distance between the projection of a closest point and this point.
    pub idempotence: f64,
    /// Absolute value of the gap minus the distance of the closest point.
    pub distance: f64,
    /// Derivative of the gap with respect to the point, minus the normal, compared with central differences.
    pub gap_derivative: f64,
    /// Derivative of the normal compared with central differences. It is the mean over all points: some lie at kinks.
    pub mean_normal_derivative: f64,
}

impl ObstacleCheck {
    /// Returns the largest of the deviations.
    pub fn largest(&self) -> f64 {
        [self.idempotence, self.distance, self.gap_derivative, self.mean_normal_derivative]
            .into_iter()
            .fold(self.normal, worse)
    }
}

/// Checks an obstacle at the given points: unit normal, projection idempotent, gap equal to the signed distance, and
/// derivatives.
pub fn check_obstacle<const D: usize>(
    obstacle: &dyn Obstacle<D>,
    at: Positions<'_, D>,
    candidates: &[FacetId],
    points: &[Point<D>],
) -> ObstacleCheck {
    let extent = points.iter().map(|x| (x - points[0]).norm()).fold(f64::MIN_POSITIVE, f64::max);
    let step = f64::EPSILON.cbrt() * extent;
    let project = |x: &Point<D>| obstacle.project(x, at, candidates);
    let mut check = ObstacleCheck::default();
    for x in points {
        let Some(found) = project(x) else { continue };
        check.n_projected += 1;
        check.normal = worse(check.normal, (found.normal.norm() - 1.0).abs());
        check.distance = worse(check.distance, (found.gap(x).abs() - (found.point - x).norm()).abs() / extent);
        if let Some(again) = project(&found.point) {
            check.idempotence = worse(check.idempotence, (again.point - found.point).norm() / extent);
        }
        for a in 0..D {
            let mut e = Vector::<D>::zeros();
            e[a] = step;
            let (ahead, behind) = (x + e, x - e);
            if let (Some(to), Some(from)) = (project(&ahead), project(&behind)) {
                let slope = (to.gap(&ahead) - from.gap(&behind)) / (2.0 * step);
                check.gap_derivative = worse(check.gap_derivative, (slope + found.normal[a]).abs());
                let slope = (to.normal - from.normal) / (2.0 * step);
                let deviation = (slope - found.normal_gradient.column(a)).norm() * extent;
                check.mean_normal_derivative += deviation / (D * points.len()) as f64;
            }
        }
    }
    check
}
