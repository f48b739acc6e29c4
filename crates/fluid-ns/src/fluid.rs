//! The fluid.

use mesh::{Tensor, sym};

/// A Newtonian fluid of constant density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonianFluid {
    /// Density `ρ^f`; unit g/cm³.
    pub density: f64,
    /// Dynamic viscosity `μ^f`; unit poise.
    pub viscosity: f64,
}

impl NewtonianFluid {
    /// Cauchy stress `T^f = -p I + 2 μ D(u)`.
    pub fn stress<const D: usize>(&self, pressure: f64, grad_u: &Tensor<D>) -> Tensor<D> {
        sym(grad_u) * (2.0 * self.viscosity) - Tensor::identity() * pressure
    }
}
