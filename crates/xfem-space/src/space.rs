//! The extended P1 space.

use cutcell::{CutMesh, PartId};
use mesh::{SimplexMesh, VertexId};

use crate::numbering::number;

/// A scalar P1 space on the active cells: `X_h^{f,std} ⊕ X_h^{f,XFEM}`. Velocity is `D` copies, pressure one.
///
/// Source: paper, Sec. 2.2.
#[derive(Clone, Debug)]
pub struct XfemSpace<const D: usize> {
    part_to_dof: Vec<u32>,
    dof_to_vertex: Vec<VertexId>,
}

impl<const D: usize> XfemSpace<D> {
    /// Creates the space on the fluid parts of a cut.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Self {
        let (part_to_dof, dof_to_vertex) = number(background, cut);
        Self { part_to_dof, dof_to_vertex }
    }

    /// Returns the number of (scalar) dofs.
    pub fn len(&self) -> usize {
        self.dof_to_vertex.len()
    }

    /// Returns whether there is no fluid.
    pub fn is_empty(&self) -> bool {
        self.dof_to_vertex.is_empty()
    }

    /// Returns the dofs of a part, `D + 1` of them, in the order of the vertices of its cell.
    #[inline]
    pub fn dofs(&self, part: PartId) -> &[u32] {
        &self.part_to_dof[part.index() * (D + 1)..][..=D]
    }

    /// Returns the vertex that a dof belongs to.
    #[inline]
    pub fn vertex(&self, dof: u32) -> VertexId {
        self.dof_to_vertex[dof as usize]
    }

    /// Returns the keys of the dofs: vertex, and place among the dofs of the vertex. They identify dofs across time
    /// steps.
    pub fn keys(&self) -> Vec<u64> {
        let n_vertices = self.dof_to_vertex.iter().map(|v| v.index() + 1).max().unwrap_or(0);
        let mut n_seen = vec![0_u64; n_vertices];
        let key = |vertex: &VertexId| {
            let place = &mut n_seen[vertex.index()];
            *place += 1;
            (*place - 1) << 32 | vertex.index() as u64
        };
        self.dof_to_vertex.iter().map(key).collect()
    }

    /// Returns the vertices of all dofs.
    pub fn vertices(&self) -> &[VertexId] {
        &self.dof_to_vertex
    }
}
