//! A body in its reference configuration: mesh, boundary, gradients and volumes of the cells.

use mesh::{BoundaryMesh, CellId, MAX_CELL_VERTICES, Placed, Point, SimplexMesh, Vector};

use crate::Error;

/// Everything about the mesh of a body that is constant in time; built once, borrowed in every step.
#[derive(Clone, Debug)]
pub struct SolidMesh<const D: usize> {
    mesh: SimplexMesh<D>,
    boundary: BoundaryMesh<D>,
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    volumes: Vec<f64>,
}

impl<const D: usize> SolidMesh<D> {
    /// Creates a body that occupies the mesh in its reference configuration.
    ///
    /// # Errors
    /// [`Error::DegenerateCell`]: a cell without finite gradients.
    pub fn new(mesh: SimplexMesh<D>) -> Result<Self, Error> {
        let mut gradients = Vec::with_capacity(mesh.n_cells());
        let mut volumes = Vec::with_capacity(mesh.n_cells());
        for cell in mesh.cells() {
            let simplex = mesh.simplex(cell);
            let of_cell = simplex.barycentric_gradients().ok_or(Error::DegenerateCell { cell })?;
            if of_cell.iter().any(|g| !g.norm_squared().is_finite()) {
                return Err(Error::DegenerateCell { cell });
            }
            gradients.push(of_cell);
            volumes.push(simplex.volume());
        }
        let boundary = mesh.boundary();
        Ok(Self { mesh, boundary, gradients, volumes })
    }

    /// Returns the mesh.
    pub fn mesh(&self) -> &SimplexMesh<D> {
        &self.mesh
    }

    /// Returns the boundary of the mesh.
    pub fn boundary(&self) -> &BoundaryMesh<D> {
        &self.boundary
    }

    /// Returns the boundary at the given positions of the vertices.
    pub fn placed<'m>(&'m self, positions: &'m [Point<D>]) -> Placed<'m, D> {
        Placed::new(&self.boundary, positions)
    }

    /// Returns the gradients of the shape functions of a cell; only the first `D + 1` are used, the others are zero.
    #[inline]
    pub fn gradients(&self, cell: CellId) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[cell.index()]
    }

    /// Returns the reference volume of a cell.
    #[inline]
    pub fn volume(&self, cell: CellId) -> f64 {
        self.volumes[cell.index()]
    }
}
