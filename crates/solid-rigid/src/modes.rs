//! Rigid velocities: translations along the axes, then rotations.
//!
//! In 2D there is one rotation, counter-clockwise. In 3D rotation `k` turns about axis `k`, by the right-hand rule.

use mesh::{Point, Tensor, Vector, mean, unit_vector};

/// Angular velocity, momentum or torque: one coefficient per rotation; only the first `D(D-1)/2` are used. Units of an
/// angular velocity: rad/time.
pub type Spin = [f64; 3];

/// Returns the number of rotations.
pub const fn n_rotations(dimension: usize) -> usize {
    dimension * (dimension - 1) / 2
}

/// Returns the number of rigid velocities.
pub const fn n_modes(dimension: usize) -> usize {
    dimension + n_rotations(dimension)
}

/// Returns `e_k × r`: velocity of rotation `k` at the arm `r`.
#[inline]
pub fn rotation<const D: usize>(k: usize, arm: &Vector<D>) -> Vector<D> {
    let across = if D == 2 { 2 } else { k };
    let (a, b) = ((across + 1) % 3, (across + 2) % 3);
    let mut v = Vector::zeros();
    v[a] = -arm[b];
    v[b] = arm[a];
    v
}

/// Returns the velocity of a mode at the arm `r`. Indices below `D` are translations, the others rotations.
#[inline]
pub fn mode<const D: usize>(index: usize, arm: &Vector<D>) -> Vector<D> {
    if index < D { unit_vector(index) } else { rotation(index - D, arm) }
}

/// Returns `ω × r`.
#[inline]
pub fn spin_velocity<const D: usize>(spin: &Spin, arm: &Vector<D>) -> Vector<D> {
    (0..n_rotations(D)).map(|k| rotation(k, arm) * spin[k]).sum()
}

/// Returns the spin `ω` of the rotation of points about their mean that is nearest to their motion: the least sum of
/// squares of `v - v̄ - ω × (x - x̄)`. The points must not lie on a line.
pub fn nearest_spin<const D: usize>(points: &[Point<D>], velocities: &[Vector<D>]) -> Spin {
    let (centre, drift) = (mean(points), mean(velocities));
    let (mut squares, mut swept) = (Tensor::<3>::identity(), Vector::<3>::zeros());
    for k in 0..n_rotations(D) {
        let about = |k: usize| points.iter().map(move |x| rotation(k, &(x - centre)));
        swept[k] = about(k).zip(velocities).map(|(mode, v)| mode.dot(&(v - drift))).sum();
        for l in 0..n_rotations(D) {
            squares[(k, l)] = about(k).zip(about(l)).map(|(a, b)| a.dot(&b)).sum();
        }
    }
    squares.try_inverse().map_or([f64::NAN; 3], |inverse| (inverse * swept).into())
}

/// Returns the rotation by the angles `φ` (an axis with its angle as length in 3D), `exp(φ ×)`.
///
/// Source: Rodrigues' formula `I + sin θ/θ Φ + (1 - cos θ)/θ² Φ²`, which holds in the plane as well.
pub fn rotated_by<const D: usize>(angles: &Spin) -> Tensor<D> {
    let mut generator = Tensor::<D>::zeros();
    for a in 0..D {
        generator.set_column(a, &spin_velocity(angles, &unit_vector(a)));
    }
    let angle = angles[..n_rotations(D)].iter().map(|a| a * a).sum::<f64>().sqrt();
    // sin θ/θ, and (1 - cos θ)/θ² without cancellation.
    let sinc = |t: f64| if t.abs() < 1e-8 { 1.0 } else { t.sin() / t };
    Tensor::identity() + generator * sinc(angle) + generator * generator * (0.5 * sinc(0.5 * angle).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spin_of_a_rigid_motion_is_found() {
        let omega = [1.3, -0.7, 2.1];
        let points = [[0.0, 0.1, 0.0], [2.0, 0.0, 0.3], [0.5, 1.0, 0.0], [0.2, 0.4, 3.0]].map(Point::<3>::from);
        let velocities = points.map(|x| Vector::<3>::new(4.0, 5.0, -6.0) + spin_velocity(&omega, &x));
        let found = nearest_spin(&points, &velocities);
        assert!(found.iter().zip(omega).all(|(found, exact)| (found - exact).abs() < 1e-13), "{found:?}");
        let flat = points.map(|x| Point::<2>::new(x[0], x[1]));
        let velocities = flat.map(|x| Vector::<2>::new(1.0 - 3.0 * x[1], 3.0 * x[0]));
        let found = nearest_spin(&flat, &velocities);
        assert!((found[0] - 3.0).abs() < 1e-13 && found[1..] == [0.0; 2], "{found:?}");
    }

    #[test]
    fn rotations_are_those_of_the_right_hand() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let turned = rotated_by::<2>(&[quarter, 0.0, 0.0]) * Vector::<2>::new(1.0, 0.0);
        assert!((turned - Vector::<2>::new(0.0, 1.0)).norm() < 1e-15);
        for k in 0..3 {
            let mut angles = [0.0; 3];
            angles[k] = quarter;
            let r = rotated_by::<3>(&angles);
            let next: Vector<3> = Vector::ith((k + 1) % 3, 1.0);
            assert!((r * next - Vector::<3>::ith((k + 2) % 3, 1.0)).norm() < 1e-15);
            assert_eq!(rotation(k, &next), Vector::<3>::ith(k, 1.0).cross(&next));
        }
        let r = rotated_by::<3>(&[0.3, -1.2, 2.0]);
        assert!((r * r.transpose() - Tensor::<3>::identity()).norm() < 1e-14);
        let axis = Vector::<3>::new(0.3, -1.2, 2.0);
        assert!((r * axis - axis).norm() < 1e-14);
        let tiny = rotated_by::<3>(&[1e-5, 0.0, 0.0]);
        assert!((tiny[(2, 1)] - 1e-5_f64.sin()).abs() < 1e-20 && (1.0 - tiny[(1, 1)] - 0.5e-10).abs() < 1e-16);
    }
}
