//! A body in its reference configuration: mesh, boundary, gradients and volumes of the cells.

use algebra::{BlockLayout, FieldId};
use mesh::{BoundaryMesh, CellId, MAX_CELL_VERTICES, Placed, Point, SimplexMesh, Vector};

use crate::Error;
use crate::error::length;

/// Everything about the mesh of a body that is constant in time; built once, borrowed in every step.
#[derive(Clone, Debug)]
pub struct SolidMesh<const D: usize> {
    mesh: SimplexMesh<D>,
    boundary: BoundaryMesh<D>,
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    volumes: Vec<f64>,
}

impl<const D: usize> SolidMesh<D> {
    /// A body that occupies the mesh in its reference configuration.
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

    /// The mesh.
    pub fn mesh(&self) -> &SimplexMesh<D> {
        &self.mesh
    }

    /// The boundary of the mesh.
    pub fn boundary(&self) -> &BoundaryMesh<D> {
        &self.boundary
    }

    /// The boundary seen at the given positions of the vertices.
    pub fn placed<'m>(&'m self, positions: &'m [Point<D>]) -> Placed<'m, D> {
        Placed::new(&self.boundary, positions)
    }

    /// Number of unknowns: `D` components of velocity per vertex.
    pub fn n_dofs(&self) -> usize {
        D * self.mesh.n_vertices()
    }

    /// Gradients of the shape functions of a cell; the first `D + 1` count, the others are zero.
    #[inline]
    pub fn gradients(&self, cell: CellId) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[cell.index()]
    }

    /// Reference volume of a cell.
    #[inline]
    pub fn volume(&self, cell: CellId) -> f64 {
        self.volumes[cell.index()]
    }

    /// Velocities of the vertices from the global vector.
    ///
    /// # Errors
    /// [`Error::Length`]: the field does not have the dofs of this body.
    pub fn velocity(&self, layout: &BlockLayout, field: FieldId, x: &[f64]) -> Result<Vec<Vector<D>>, Error> {
        let range = layout.range(field);
        length("field of the body", range.len(), self.n_dofs())?;
        Ok(x[range].chunks_exact(D).map(Vector::from_column_slice).collect())
    }

    /// Writes velocities of the vertices to the global vector.
    ///
    /// # Errors
    /// [`Error::Length`]: the field does not have the dofs of this body, or not one velocity per vertex.
    pub fn set_velocity(
        &self,
        layout: &BlockLayout,
        field: FieldId,
        velocity: &[Vector<D>],
        x: &mut [f64],
    ) -> Result<(), Error> {
        let range = layout.range(field);
        length("field of the body", range.len(), self.n_dofs())?;
        length("velocity", velocity.len(), self.mesh.n_vertices())?;
        for (slot, v) in x[range].chunks_exact_mut(D).zip(velocity) {
            slot.copy_from_slice(v.as_slice());
        }
        Ok(())
    }

    /// Positions of the vertices after a displacement: `x = X + d`.
    ///
    /// # Errors
    /// [`Error::Length`]: not one displacement per vertex.
    pub fn positions(&self, displacement: &[Vector<D>]) -> Result<Vec<Point<D>>, Error> {
        length("displacement", displacement.len(), self.mesh.n_vertices())?;
        Ok(self.mesh.vertices().iter().zip(displacement).map(|(x, d)| x + d).collect())
    }
}
