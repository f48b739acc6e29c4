//! The geometry and the fields of the fluid in a step.

use algebra::time::Affine;
use algebra::{BlockLayout, FieldId};
use cutcell::CutMesh;
use mesh::{SimplexMesh, Tensor, Vector};
use xfem_space::{FaceValue, PartValues, XfemSpace};

use crate::FilmValues;

/// Geometry of a step, and known velocity and acceleration on it, shared by all fluid terms.
#[derive(Clone, Copy)]
pub struct FluidGeometry<'a, const D: usize> {
    /// The background.
    pub background: &'a SimplexMesh<D>,
    /// The cut.
    pub cut: &'a CutMesh<D>,
    /// The space.
    pub space: &'a XfemSpace<D>,
    /// Moments of parts.
    pub parts: &'a PartValues<D>,
    /// Jumps over faces.
    pub faces: &'a [FaceValue<D>],
    /// Known velocity `u*`, one value per dof of the space: that at the start, or its extrapolation to the stage. The
    /// weights of all stabilisations depend on it.
    pub known_velocity: &'a [Vector<D>],
    /// Acceleration at the stage, affine in the velocity at the stage; one value per dof of the space.
    pub acceleration: &'a Affine<Vector<D>>,
    /// Films between surfaces; `None` if their flux is not modelled.
    pub films: Option<&'a FilmValues<D>>,
}

/// Velocity and pressure in the global vector; both have the dofs of the space as nodes.
#[derive(Clone, Copy)]
pub struct FluidFields<'a> {
    /// The layout.
    pub layout: &'a BlockLayout,
    /// The velocity.
    pub velocity: FieldId,
    /// The pressure.
    pub pressure: FieldId,
}

impl FluidFields<'_> {
    /// Returns the velocity of a dof of the space.
    #[inline]
    pub fn velocity_at<const D: usize>(&self, x: &[f64], dof: u32) -> Vector<D> {
        self.layout.at(self.velocity, dof as usize, x).into()
    }

    /// Returns the pressure of a dof of the space.
    #[inline]
    pub fn pressure_at(&self, x: &[f64], dof: u32) -> f64 {
        x[self.layout.dof(self.pressure, dof as usize, 0).index()]
    }

    /// Returns the gradient of the velocity and the pressure at a point, given the dofs of its part with the gradients
    /// and values of their shape functions.
    pub fn grad_and_pressure<const D: usize>(
        &self,
        x: &[f64],
        dofs: &[u32],
        gradients: &[Vector<D>],
        shape: &[f64],
    ) -> (Tensor<D>, f64) {
        let (mut grad_u, mut pressure) = (Tensor::zeros(), 0.0);
        for (i, &dof) in dofs.iter().enumerate() {
            grad_u += self.velocity_at::<D>(x, dof) * gradients[i].transpose();
            pressure += self.pressure_at(x, dof) * shape[i];
        }
        (grad_u, pressure)
    }
}
