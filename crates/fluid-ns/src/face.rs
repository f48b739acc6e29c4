//! One face between two fluid parts as face terms see it.

use mesh::Vector;
use xfem_space::FaceValue;

/// A face with the history on it.
pub struct FluidFace<'a, const D: usize> {
    /// Geometry and jumps.
    pub value: &'a FaceValue<D>,
    /// Largest `|u*·n|` over the vertices of the face.
    pub normal_speed: f64,
    /// Largest `|u*|` over the vertices of the face.
    pub speed: f64,
}

impl<'a, const D: usize> FluidFace<'a, D> {
    /// A face with the history given per dof.
    pub fn new(value: &'a FaceValue<D>, history: &[Vector<D>]) -> Self {
        let mut face = Self { value, normal_speed: 0.0, speed: 0.0 };
        for &dof in value.face_dofs() {
            let u = history[dof as usize];
            face.normal_speed = face.normal_speed.max(u.dot(&value.normal).abs());
            face.speed = face.speed.max(u.norm());
        }
        face
    }
}

/// A penalty on jumps of normal derivatives: `c_F ([∇φ]n, [∇ψ]n)_F` for each component of a field.
pub trait FaceTerm<const D: usize>: Sync {
    /// The weight `c_F`; units: viscosity x length for velocity, length² / viscosity x length for pressure.
    fn weight(&self, face: &FluidFace<'_, D>) -> f64;
}
