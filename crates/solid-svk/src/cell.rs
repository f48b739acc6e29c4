//! Cells of a body with the local data that terms evaluate.

use algebra::time::StepRule;
use algebra::{BlockLayout, DofId, FieldId, LocalSystem, Sites};
use mesh::{CellId, MAX_CELL_VERTICES, Tensor, Vector, VertexId};

use crate::SolidMesh;
use crate::kinematics::gradient;

/// A cell in the reference configuration with the local state at the stage of the step.
///
/// Arrays have one entry per vertex of the cell; the remaining entries are zero. Component `a` of the velocity of vertex
/// `i` is local row `D i + a`.
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
    pub displacement_slope: f64,
    /// `c_a`: derivative of acceleration with respect to velocity.
    pub acceleration_slope: f64,
}

impl<const D: usize> SolidCell<'_, D> {
    /// Returns the local vertices.
    #[inline]
    pub fn nodes(&self) -> std::ops::RangeInclusive<usize> {
        0..=D
    }

    /// Returns the first local row of the velocity of a local vertex.
    #[inline]
    pub fn row(&self, node: usize) -> usize {
        D * node
    }

    /// Returns the gradient of the displacement, constant on the cell.
    #[inline]
    pub fn grad_displacement(&self) -> Tensor<D> {
        gradient(&self.displacement[..=D], &self.gradients[..=D])
    }

    /// Adds a vector to the residual of a node.
    #[inline]
    pub(crate) fn add(&self, node: usize, value: Vector<D>, out: &mut LocalSystem) {
        out.add_vector::<D>(self.row(node), value);
    }
}

/// The cells of a body in one step: one item and one site per cell.
#[derive(Clone, Copy)]
pub struct SolidCells<'a, const D: usize> {
    /// The body.
    pub solid: &'a SolidMesh<D>,
    /// The step of the time scheme.
    pub rule: &'a StepRule<Vector<D>>,
    /// The layout.
    pub layout: &'a BlockLayout,
    /// Velocities of the vertices.
    pub velocity: FieldId,
}

impl<const D: usize> SolidCells<'_, D> {
    /// Appends the dofs of vertices.
    pub(crate) fn dofs_of(&self, vertices: &[VertexId], out: &mut Vec<DofId>) {
        vertices.iter().for_each(|vertex| out.extend(self.layout.node(self.velocity, vertex.index())));
    }

    /// Returns the velocity of a vertex at the state `x`.
    pub(crate) fn velocity_at(&self, vertex: VertexId, x: &[f64]) -> Vector<D> {
        self.layout.at(self.velocity, vertex.index(), x).into()
    }
}

impl<'a, const D: usize> Sites for SolidCells<'a, D> {
    type Site = SolidCell<'a, D>;

    fn len(&self) -> usize {
        self.solid.mesh().n_cells()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.dofs_of(self.solid.mesh().cell(CellId::new(item)), out);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (cell, stage) = (CellId::new(item), self.rule);
        let mut site = SolidCell {
            volume: self.solid.volume(cell),
            gradients: self.solid.gradients(cell),
            displacement: [Vector::zeros(); MAX_CELL_VERTICES],
            acceleration: [Vector::zeros(); MAX_CELL_VERTICES],
            displacement_slope: stage.displacement.slope,
            acceleration_slope: stage.acceleration.slope,
        };
        for (k, vertex) in self.solid.mesh().cell(cell).iter().enumerate() {
            let v = self.velocity_at(*vertex, x);
            site.displacement[k] = stage.displacement.at(vertex.index(), v);
            site.acceleration[k] = stage.acceleration.at(vertex.index(), v);
        }
        visit(&site);
    }
}
