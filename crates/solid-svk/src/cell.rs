//! Cells of a body, and their points, with the local data that terms evaluate.

use algebra::time::{Affine, StepRule};
use algebra::{BlockLayout, DofId, FieldId, Sites};
use mesh::{CellId, Vector, VertexId};

use crate::MAX_CELL_NODES;
use crate::deformation::Deformation;
use crate::{CellPoint, SolidMesh};

/// A cell in the reference configuration with its accelerations at the stage of the step.
///
/// Component `a` of the velocity of node `i` is local row `D i + a`.
#[derive(Clone, Copy, Debug)]
pub struct SolidCell<'a, const D: usize> {
    /// Group of the cell, by which density and material are chosen ([`SolidMesh::with_groups`]).
    pub group: usize,
    /// Number of nodes.
    pub n_nodes: usize,
    /// Mass matrix of the cell for unit density, `n_nodes × n_nodes`, row by row: `m_ij = ∫ N_i N_j`, or as
    /// redistributed by [`SolidMesh::without_mass_at`].
    pub mass: &'a [f64],
    /// Accelerations `a`, one per node; the remaining entries are zero.
    pub acceleration: [Vector<D>; MAX_CELL_NODES],
    /// `c_a`: derivative of acceleration with respect to velocity.
    pub acceleration_slope: f64,
}

impl<const D: usize> SolidCell<'_, D> {
    /// Returns the local nodes.
    #[inline]
    pub fn nodes(&self) -> std::ops::Range<usize> {
        0..self.n_nodes
    }

    /// Returns the row `m_i0, m_i1, ..` of the mass matrix.
    #[inline]
    pub fn mass_of(&self, node: usize) -> &[f64] {
        &self.mass[node * self.n_nodes..][..self.n_nodes]
    }
}

/// A quadrature point of a cell with the deformation at the stage of the step.
///
/// Component `a` of the velocity of node `i` is local row `D i + a`.
#[derive(Clone, Copy, Debug)]
pub struct SolidPoint<'a, const D: usize> {
    /// Group of the cell, as in [`SolidCell`].
    pub group: usize,
    /// Quadrature weight times the reference volume element times [`mesh::Coordinates::weight`].
    pub weight: f64,
    /// Gradients of the shape functions, one per node.
    pub gradients: &'a [Vector<D>],
    /// Index of the radial component, and the values `N_i/R`, one per node; `None` in Cartesian coordinates.
    pub hoop: Option<(usize, &'a [f64])>,
    /// Deformation.
    pub deformation: Deformation<D>,
    /// `c_d`: derivative of displacement with respect to velocity.
    pub displacement_slope: f64,
}

/// Returns the first local row of the velocity of a local node.
#[inline]
pub(crate) fn row<const D: usize>(node: usize) -> usize {
    D * node
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
    /// Velocities of the nodes.
    pub velocity: FieldId,
}

/// The points of the cells of a body in one step: one item per cell, one site per point ([`SolidMesh::points`]).
#[derive(Clone, Copy)]
pub struct SolidPoints<'a, const D: usize> {
    /// The cells.
    pub cells: SolidCells<'a, D>,
}

impl<const D: usize> SolidCells<'_, D> {
    /// Appends the dofs of nodes.
    pub(crate) fn dofs_of(&self, nodes: &[VertexId], out: &mut Vec<DofId>) {
        nodes.iter().for_each(|node| out.extend(self.layout.node(self.velocity, node.index())));
    }

    /// Returns the velocity of a node at the state `x`.
    #[inline]
    pub(crate) fn velocity_at(&self, node: VertexId, x: &[f64]) -> Vector<D> {
        self.layout.at(self.velocity, node.index(), x).into()
    }

    /// Writes the values of an affine function of the velocity at nodes, for the state `x`, to `local`.
    #[inline]
    pub(crate) fn set_at_nodes(
        &self,
        affine: &Affine<Vector<D>>,
        nodes: &[VertexId],
        x: &[f64],
        local: &mut [Vector<D>; MAX_CELL_NODES],
    ) {
        for (slot, node) in local.iter_mut().zip(nodes) {
            *slot = affine.at(node.index(), self.velocity_at(*node, x));
        }
    }
}

impl<'a, const D: usize> Sites for SolidCells<'a, D> {
    type Site = SolidCell<'a, D>;

    fn len(&self) -> usize {
        self.solid.mesh().n_cells()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.dofs_of(self.solid.cell(CellId::new(item)), out);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (cell, acceleration) = (CellId::new(item), &self.rule.acceleration);
        let nodes = self.solid.cell(cell);
        // The accelerations are written in place: copies of the array cost as much as the term.
        let mut site = SolidCell {
            group: self.solid.group(cell),
            n_nodes: nodes.len(),
            mass: self.solid.mass(cell),
            acceleration: [Vector::zeros(); MAX_CELL_NODES],
            acceleration_slope: acceleration.slope,
        };
        self.set_at_nodes(acceleration, nodes, x, &mut site.acceleration);
        visit(&site);
    }
}

impl<'a, const D: usize> Sites for SolidPoints<'a, D> {
    type Site = SolidPoint<'a, D>;

    fn len(&self) -> usize {
        self.cells.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.cells.dofs(item, out);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (cell, rule) = (CellId::new(item), &self.cells.rule.displacement);
        let mut displacement = [Vector::zeros(); MAX_CELL_NODES];
        self.cells.set_at_nodes(rule, self.cells.solid.cell(cell), x, &mut displacement);
        let group = self.cells.solid.group(cell);
        for point in self.cells.solid.points(cell) {
            let CellPoint { weight, gradients, hoop } = point;
            let deformation = point.deformation(&displacement);
            visit(&SolidPoint { group, weight, gradients, hoop, deformation, displacement_slope: rule.slope });
        }
    }
}
