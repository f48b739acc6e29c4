//! Deformation gradient, strain, and the push-forward of stresses and tractions.
//!
//! Conventions: `grad_d[(a, b)] = ∂d_a/∂X_b`, so `F = I + grad_d` and `J = det F`.

use mesh::{Tensor, Vector, det};

/// Returns the deformation gradient `F = I + ∇d`.
#[inline]
pub fn deformation_gradient<const D: usize>(grad_d: &Tensor<D>) -> Tensor<D> {
    Tensor::identity() + grad_d
}

/// Returns the gradient of a finite element field at a point: `Σ_i d_i ⊗ ∇N_i`.
///
/// Shapes: `values` and `gradients`: one entry per node of the cell.
#[inline]
pub fn gradient<const D: usize>(values: &[Vector<D>], gradients: &[Vector<D>]) -> Tensor<D> {
    let mut sum = Tensor::zeros();
    for (value, g) in values.iter().zip(gradients) {
        sum += value * g.transpose();
    }
    sum
}

/// Returns the Green-Lagrange strain `E = (FᵀF - I)/2`; zero for every rigid motion.
#[inline]
pub fn green_lagrange<const D: usize>(f: &Tensor<D>) -> Tensor<D> {
    0.5 * (f.transpose() * f - Tensor::identity())
}

/// Returns the derivative of the Green-Lagrange strain at `F` in direction `H`: `(FᵀH + HᵀF)/2`.
#[inline]
pub fn green_lagrange_derivative<const D: usize>(f: &Tensor<D>, h: &Tensor<D>) -> Tensor<D> {
    mesh::sym(&(f.transpose() * h))
}

/// Returns the Cauchy stress `T = P Fᵀ / J` of a first Piola stress.
///
/// Source: paper, Sec. 2.1, with the first Piola stress `P = J T F⁻ᵀ`.
/// Units: those of `P`, force per area.
#[inline]
pub fn cauchy_stress<const D: usize>(f: &Tensor<D>, first_piola: &Tensor<D>) -> Tensor<D> {
    first_piola * f.transpose() / det(f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_of_a_linear_field() {
        let corners = [Vector::<2>::new(0.0, 0.0), Vector::<2>::new(2.0, 0.0), Vector::<2>::new(0.5, 1.0)];
        let g = mesh::Simplex::<2>::new(&corners).barycentric_gradients().unwrap();
        let a = Tensor::<2>::new(0.1, -0.4, 0.3, 0.7);
        let values = corners.map(|x| a * x + Vector::<2>::new(3.0, 4.0));
        assert!((gradient(&values, &g[..3]) - a).norm() < 1e-14);
    }

    #[test]
    fn rotation_is_no_strain() {
        let (s, c) = 1.1_f64.sin_cos();
        assert!(green_lagrange(&Tensor::<2>::new(c, -s, s, c)).norm() < 1e-15);
    }

    #[test]
    fn pressure_is_pushed_forward_to_pressure() {
        // P = -p J F⁻ᵀ is the first Piola stress of the Cauchy stress -p I.
        let f = Tensor::<3>::new(1.1, 0.2, 0.0, -0.1, 0.9, 0.3, 0.05, 0.0, 1.2);
        let p = -2.0 * det(&f) * f.try_inverse().unwrap().transpose();
        assert!((cauchy_stress(&f, &p) + 2.0 * Tensor::<3>::identity()).norm() < 1e-14);
    }
}
