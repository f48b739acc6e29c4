//! The deformation at a point, with the hoop stretch in axisymmetric coordinates.

use mesh::{Tensor, det};

use crate::Material;
use crate::kinematics::cauchy_stress;

/// Index of the hoop direction in tensors in space.
pub(crate) const THETA: usize = 2;

/// Tensor in space.
pub(crate) type SpaceTensor = Tensor<3>;

/// Deformation gradient at a point. In axisymmetric coordinates the deformation gradient in space has the hoop stretch,
/// that of the circle through the point, as third entry on its diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation<const D: usize> {
    /// Deformation gradient `F = I + ∇d` in the coordinates of the mesh.
    pub gradient: Tensor<D>,
    /// Hoop stretch `1 + d_R/R`; `None` in Cartesian coordinates.
    pub hoop: Option<f64>,
}

impl<const D: usize> Deformation<D> {
    /// Returns the volume ratio `det F`.
    pub fn volume_ratio(&self) -> f64 {
        det(&self.gradient) * self.hoop.unwrap_or(1.0)
    }

    /// Returns the deformation gradient in space, for `D = 2`.
    pub(crate) fn in_space(&self) -> SpaceTensor {
        into_space(&self.gradient, self.hoop.unwrap_or(1.0))
    }

    /// Returns the stored energy per reference volume of a material.
    pub fn energy_density(&self, material: &dyn Material<D>) -> f64 {
        match self.hoop {
            None => material.energy_density(&self.gradient),
            Some(_) => material.in_space().energy_density(&self.in_space()),
        }
    }

    /// Returns the first Piola stress of a material in the coordinates of the mesh.
    pub fn first_piola(&self, material: &dyn Material<D>) -> Tensor<D> {
        match self.hoop {
            None => material.first_piola(&self.gradient),
            Some(_) => in_plane(&material.in_space().first_piola(&self.in_space())),
        }
    }

    /// Returns the derivative of the first Piola stress in the coordinates of the mesh, in the direction of a gradient
    /// `h` and of a hoop stretch.
    pub fn first_piola_derivative(&self, material: &dyn Material<D>, h: &Tensor<D>, stretch: f64) -> Tensor<D> {
        match self.hoop {
            None => material.first_piola_derivative(&self.gradient, h),
            Some(_) => {
                let law = material.in_space();
                in_plane(&law.first_piola_derivative(&self.in_space(), &into_space(h, stretch)))
            }
        }
    }

    /// Returns the Cauchy stress in the coordinates of the mesh, and for `D = 2` the stress normal to the plane.
    pub fn cauchy(&self, material: &dyn Material<D>) -> (Tensor<D>, f64) {
        if self.hoop.is_some() {
            let f = self.in_space();
            let stress = cauchy_stress(&f, &material.in_space().first_piola(&f));
            return (in_plane(&stress), stress[(THETA, THETA)]);
        }
        let across = if D == 2 { material.out_of_plane_stress(&self.gradient) } else { 0.0 };
        (cauchy_stress(&self.gradient, &material.first_piola(&self.gradient)), across)
    }
}

/// Returns the tensor in space that consists of a tensor in the plane and a third entry on the diagonal.
pub(crate) fn into_space<const D: usize>(t: &Tensor<D>, across: f64) -> SpaceTensor {
    Tensor::from_fn(|a, b| match (a, b) {
        (THETA, THETA) => across,
        (a, b) if a < D && b < D => t[(a, b)],
        _ => 0.0,
    })
}

/// Returns the entries of a tensor in space that lie in the plane.
pub(crate) fn in_plane<const D: usize>(t: &SpaceTensor) -> Tensor<D> {
    Tensor::from_fn(|a, b| t[(a, b)])
}
