//! The fluid.

use mesh::{Tensor, Vector, sym};

/// A Newtonian fluid of constant density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonianFluid {
    /// Density `ρ^f`.
    pub density: f64,
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
}

impl NewtonianFluid {
    /// Returns the Cauchy stress `T^f = -p I + 2 μ D(u)`.
    pub fn stress<const D: usize>(&self, pressure: f64, grad_u: &Tensor<D>) -> Tensor<D> {
        sym(grad_u) * (2.0 * self.viscosity) - Tensor::identity() * pressure
    }

    /// Returns the viscous traction `2 μ D(u) n`.
    #[inline]
    pub fn viscous_traction<const D: usize>(&self, grad_u: &Tensor<D>, normal: &Vector<D>) -> Vector<D> {
        (grad_u + grad_u.transpose()) * *normal * self.viscosity
    }

    /// Returns the derivative of the viscous traction with respect to the velocity of a node with shape gradient `g`:
    /// column `b` of `μ ((g·n) I + g ⊗ n)` is that for component `b`.
    #[inline]
    pub fn viscous_traction_by_velocity<const D: usize>(&self, g: &Vector<D>, normal: &Vector<D>) -> Tensor<D> {
        (Tensor::identity() * g.dot(normal) + g * normal.transpose()) * self.viscosity
    }
}
