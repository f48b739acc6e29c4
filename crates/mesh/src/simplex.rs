//! One simplex: affine map, measure, barycentric gradients, sizes.

use crate::{Point, Tensor, Vector, VertexId, det, mean};

/// Number of vertices of the largest cell (tetrahedron); per-cell arrays have this length.
pub const MAX_CELL_VERTICES: usize = 4;

/// Number of vertices of the largest facet (triangle); per-facet arrays have this length.
pub const MAX_FACET_VERTICES: usize = 3;

/// A cell given by its `D + 1` points (further entries are zero).
#[derive(Clone, Copy, Debug)]
pub struct Simplex<const D: usize> {
    points: [Point<D>; MAX_CELL_VERTICES],
}

impl<const D: usize> Simplex<D> {
    /// Creates the simplex with the given `D + 1` points.
    ///
    /// # Panics
    /// If there are not `D + 1` points.
    #[inline]
    pub fn new(points: &[Point<D>]) -> Self {
        assert_eq!(points.len(), D + 1, "a simplex has D + 1 points");
        let mut all = [Point::zeros(); MAX_CELL_VERTICES];
        all[..=D].copy_from_slice(points);
        Self { points: all }
    }

    /// Returns the points, `D + 1` of them.
    #[inline]
    pub fn points(&self) -> &[Point<D>] {
        &self.points[..=D]
    }

    /// Returns the Jacobian of the map from the reference simplex: column `k` is `x_{k+1} - x_0`.
    #[inline]
    pub fn jacobian(&self) -> Tensor<D> {
        let mut j = Tensor::<D>::zeros();
        for k in 0..D {
            j.set_column(k, &(self.points[k + 1] - self.points[0]));
        }
        j
    }

    /// Returns the volume (area in 2D), positive for positive orientation.
    #[inline]
    pub fn volume(&self) -> f64 {
        det(&self.jacobian()) / factorial(D)
    }

    /// Returns the gradients of the `D + 1` barycentric coordinates (further entries are zero), or `None` for a
    /// degenerate simplex.
    #[inline]
    pub fn barycentric_gradients(&self) -> Option<[Vector<D>; MAX_CELL_VERTICES]> {
        let inverse = self.jacobian().try_inverse()?;
        let mut gradients = [Vector::zeros(); MAX_CELL_VERTICES];
        for k in 0..D {
            let g = inverse.row(k).transpose();
            gradients[k + 1] = g;
            gradients[0] -= g;
        }
        Some(gradients)
    }

    /// Returns the `D + 1` barycentric coordinates of a point, or `None` for a degenerate simplex.
    #[inline]
    pub fn barycentric(&self, x: &Point<D>) -> Option<[f64; MAX_CELL_VERTICES]> {
        let local = self.jacobian().try_inverse()? * (x - self.points[0]);
        let mut coordinates = [0.0; MAX_CELL_VERTICES];
        coordinates[0] = 1.0 - local.sum();
        coordinates[1..=D].copy_from_slice(local.as_slice());
        Some(coordinates)
    }

    /// Returns the mean of the points.
    #[inline]
    pub fn centroid(&self) -> Point<D> {
        mean(self.points())
    }

    /// Returns the largest distance between two points.
    pub fn diameter(&self) -> f64 {
        diameter(self.points())
    }
}

/// Returns the positions of vertices; entries beyond their number are zero.
#[inline]
pub(crate) fn points_of<const D: usize, const N: usize>(
    positions: &[Point<D>],
    vertices: &[VertexId],
) -> [Point<D>; N] {
    let mut points = [Point::zeros(); N];
    for (slot, v) in points.iter_mut().zip(vertices) {
        *slot = positions[v.index()];
    }
    points
}

/// Returns the largest distance between two of the points.
pub fn diameter<const D: usize>(points: &[Point<D>]) -> f64 {
    let mut largest = 0.0_f64;
    for (i, a) in points.iter().enumerate() {
        for b in &points[i + 1..] {
            largest = largest.max((a - b).norm_squared());
        }
    }
    largest.sqrt()
}

/// Returns the measure of the simplex with the given points in `D` dimensions: 1 for a point, length of a segment, area
/// of a triangle, volume of a tetrahedron; 0 without points.
///
/// # Panics
/// If there are more than three points and not `D + 1`.
pub fn simplex_measure<const D: usize>(points: &[Point<D>]) -> f64 {
    match points.len() {
        0 => 0.0,
        1 => 1.0,
        2 => (points[1] - points[0]).norm(),
        3 => {
            // Components of a ∧ b, without cancellation for slender triangles.
            let (a, b) = (points[1] - points[0], points[2] - points[0]);
            let mut squared = 0.0;
            for i in 0..D {
                for j in 0..i {
                    squared += (a[i] * b[j] - a[j] * b[i]).powi(2);
                }
            }
            0.5 * squared.sqrt()
        }
        _ => Simplex::new(points).volume().abs(),
    }
}

/// Returns the side of the equilateral simplex of dimension `D`, from 1 to 3, with the given volume: the size `h_K`.
#[inline]
pub fn equilateral_side<const D: usize>(volume: f64) -> f64 {
    match D {
        2 => (volume * 4.0 / 3.0_f64.sqrt()).sqrt(),
        3 => (volume * 6.0 * 2.0_f64.sqrt()).cbrt(),
        _ => volume,
    }
}

#[inline]
pub(crate) fn factorial(n: usize) -> f64 {
    (1..=n).product::<usize>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_sum_to_zero_and_reproduce_coordinates() {
        let s = Simplex::<2>::new(&[Point::<2>::new(0.1, 0.2), Point::<2>::new(1.3, 0.1), Point::<2>::new(0.4, 2.0)]);
        let g = s.barycentric_gradients().unwrap();
        let x = Point::<2>::new(0.7, 0.5);
        let l = s.barycentric(&x).unwrap();
        let back: Point<2> = (0..3).map(|i| s.points()[i] * l[i]).sum();
        assert!((back - x).norm() < 1e-14);
        assert!((g[0] + g[1] + g[2]).norm() < 1e-14);
        let gradient: f64 = (0..3).map(|i| g[i][0] * s.points()[i][0]).sum();
        assert!((gradient - 1.0).abs() < 1e-14);
    }

    #[test]
    fn equilateral_simplices_of_side_one_have_the_side_one() {
        assert!((equilateral_side::<2>(3.0_f64.sqrt() / 4.0) - 1.0).abs() < 1e-14);
        assert!((equilateral_side::<3>(1.0 / (6.0 * 2.0_f64.sqrt())) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn measures_in_any_dimension() {
        let triangle = [Point::<3>::zeros(), Point::<3>::new(2.0, 0.0, 0.0), Point::<3>::new(0.0, 0.0, 3.0)];
        assert!((simplex_measure(&triangle) - 3.0).abs() < 1e-14);
        assert!((simplex_measure(&triangle[..2]) - 2.0).abs() < 1e-14);
    }
}
