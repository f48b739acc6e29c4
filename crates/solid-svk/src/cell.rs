//! One cell of a body: what a term sees.

use mesh::{CellId, MAX_CELL_VERTICES, Tensor, Vector};

use algebra::LocalSystem;

use crate::kinematics::gradient;
use crate::{SolidMesh, StepRule};

/// A cell in the reference configuration with the local state at the stage of the step.
///
/// Arrays have one entry per vertex of the cell; entries beyond are zero.
#[derive(Clone, Copy, Debug)]
pub struct SolidCell<'a, const D: usize> {
    /// Reference volume.
    pub volume: f64,
    /// Gradients of the shape functions.
    pub gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    /// Displacements `d`.
    pub displacement: [Vector<D>; MAX_CELL_VERTICES],
    /// Accelerations `a`.
    pub acceleration: [Vector<D>; MAX_CELL_VERTICES],
    /// `c_d`: derivative of displacement with respect to velocity.
    pub displacement_per_velocity: f64,
    /// `c_a`: derivative of acceleration with respect to velocity.
    pub acceleration_per_velocity: f64,
}

impl<'a, const D: usize> SolidCell<'a, D> {
    /// A cell of a body at the velocities `velocity` (those of the body, `D` per vertex).
    #[inline]
    pub fn new(mesh: &'a SolidMesh<D>, step: &StepRule<D>, cell: CellId, velocity: &[f64]) -> Self {
        let mut displacement = [Vector::zeros(); MAX_CELL_VERTICES];
        let mut acceleration = [Vector::zeros(); MAX_CELL_VERTICES];
        let stage = step.stage();
        for (k, vertex) in mesh.mesh().cell(cell).iter().enumerate() {
            let v = Vector::from_column_slice(&velocity[D * vertex.index()..][..D]);
            displacement[k] = stage.displacement.at(vertex.index(), &v);
            acceleration[k] = stage.acceleration.at(vertex.index(), &v);
        }
        Self {
            volume: mesh.volume(cell),
            gradients: mesh.gradients(cell),
            displacement,
            acceleration,
            displacement_per_velocity: stage.displacement.slope(),
            acceleration_per_velocity: stage.acceleration.slope(),
        }
    }

    /// Local vertices.
    #[inline]
    pub fn nodes(&self) -> std::ops::RangeInclusive<usize> {
        0..=D
    }

    /// First local row of the velocity of a local vertex.
    #[inline]
    pub fn velocity(&self, node: usize) -> usize {
        D * node
    }

    /// Gradient of the displacement, constant on the cell.
    #[inline]
    pub fn grad_displacement(&self) -> Tensor<D> {
        gradient(&self.displacement[..=D], &self.gradients[..=D])
    }
}

/// A term of the weak form that lives on the reference cells of a body.
pub trait SolidTerm<const D: usize> {
    /// Adds residual and tangent (with respect to velocity) of this term on one cell.
    fn add(&self, cell: &SolidCell<'_, D>, out: &mut LocalSystem);
}
