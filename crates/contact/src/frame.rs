//! The frame of a contact point: normal and tangents.

use mesh::{Tensor, Vector};

/// Components of a vector in a [`Frame`]: along the normal, then along the tangents; in the plane the last one is zero.
pub type Local = [f64; 3];

/// Cosine of the angle below which a normal is close to a coordinate axis. One of the axes is always farther away.
const CLOSE: f64 = 0.8;

/// An orthonormal frame whose first axis is the normal `n^w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<const D: usize> {
    /// The axes; only the first `D` are used.
    pub axes: [Vector<D>; 3],
}

impl<const D: usize> Frame<D> {
    /// Creates the frame of a unit normal. In the plane the tangent is the normal turned counter-clockwise by a right
    /// angle. In space the first tangent lies in the plane of the normal and the first coordinate axis that is not
    /// close to it. Frames are smooth around normals along the axes.
    #[inline]
    pub fn new(normal: Vector<D>) -> Self {
        let mut axes = [normal, Vector::zeros(), Vector::zeros()];
        if D == 2 {
            axes[1] = right_angle() * normal;
        } else {
            let (along, axis) = tangential(&normal);
            axes[1] = (axis - normal * along).normalize();
            axes[2] = cross(&normal) * axes[1];
        }
        Self { axes }
    }

    /// Computes the derivatives of the axes with respect to the normal: the tensor of axis `i` maps a change of the
    /// normal to the change of the axis.
    pub fn by_normal(&self) -> [Tensor<D>; 3] {
        let mut by_normal = [Tensor::identity(), Tensor::zeros(), Tensor::zeros()];
        if D == 2 {
            by_normal[1] = right_angle();
        } else {
            let [normal, tangent, _] = self.axes;
            let (along, axis) = tangential(&normal);
            let length = (axis - normal * along).norm();
            let change = -(normal * axis.transpose() + Tensor::identity() * along) / length;
            by_normal[1] = change - tangent * (tangent.transpose() * change);
            by_normal[2] = cross(&normal) * by_normal[1] - cross(&tangent);
        }
        by_normal
    }

    /// Returns the components of a vector in the frame.
    #[inline]
    pub fn components(&self, vector: &Vector<D>) -> Local {
        self.axes.map(|axis| axis.dot(vector))
    }

    /// Returns the vector with the given components in the frame.
    #[inline]
    pub fn vector(&self, components: &Local) -> Vector<D> {
        self.axes.iter().zip(components).map(|(axis, value)| axis * *value).sum()
    }
}

/// Returns the rotation by a right angle in the plane, counter-clockwise.
fn right_angle<const D: usize>() -> Tensor<D> {
    Tensor::from_fn(|i, j| i as f64 - j as f64)
}

/// Returns the component of a unit normal along the first coordinate axis that is not close to it, and that axis.
fn tangential<const D: usize>(normal: &Vector<D>) -> (f64, Vector<D>) {
    let mut axis = Vector::<D>::zeros();
    axis[normal.iter().position(|component| component.abs() < CLOSE).unwrap_or(0)] = 1.0;
    (axis.dot(normal), axis)
}

/// Returns the matrix of `w -> v × w`, in space.
fn cross<const D: usize>(v: &Vector<D>) -> Tensor<D> {
    let mut matrix = Tensor::zeros();
    for k in 0..D {
        let (i, j) = ((k + 1) % D, (k + 2) % D);
        matrix[(i, j)] = -v[k];
        matrix[(j, i)] = v[k];
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const D: usize>(normal: Vector<D>) {
        let normal = normal.normalize();
        let frame = Frame::new(normal);
        for i in 0..D {
            for j in 0..D {
                let expected = f64::from(u8::from(i == j));
                assert!((frame.axes[i].dot(&frame.axes[j]) - expected).abs() < 1e-15, "{i} {j}");
            }
            // Derivatives in tangential directions against central differences.
            for tangent in &frame.axes[1..D] {
                let h = 1e-6;
                let at = |h: f64| Frame::new((normal + tangent * h).normalize()).axes[i];
                let difference = (at(h) - at(-h)) / (2.0 * h);
                assert!((frame.by_normal()[i] * tangent - difference).norm() < 1e-9, "{i}");
            }
        }
        let v = Vector::<D>::from_fn(|a, _| 1.0 + a as f64);
        assert!((frame.vector(&frame.components(&v)) - v).norm() < 1e-14);
    }

    #[test]
    fn frames_are_orthonormal_with_exact_derivatives() {
        check(Vector::<2>::new(0.3, -0.8));
        check(Vector::<3>::new(0.3, -0.8, 0.1));
        check(Vector::<3>::new(0.0, 0.0, -1.0));
    }
}
