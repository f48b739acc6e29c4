//! From (part, vertex) pairs to dofs.

use cutcell::{CutMesh, PartId};
use mesh::{SimplexMesh, VertexId};

use crate::Classes;

/// Returns the dof of each (part, local vertex) pair, and the vertex of each dof. Dofs are numbered in the order of
/// their first pair.
pub(crate) fn number<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> (Vec<u32>, Vec<VertexId>) {
    let stride = D + 1;
    let mut classes = Classes::new(cut.n_parts() * stride);
    let pair = |part: PartId, vertex: VertexId| {
        let cell = background.cell(cut.part_cell(part));
        cell.iter().position(|&v| v == vertex).map(|local| (part.index() * stride + local) as u32)
    };
    for face in cut.part_faces() {
        for &vertex in background.facet(face.facet) {
            if let (Some(a), Some(b)) = (pair(face.parts[0], vertex), pair(face.parts[1], vertex)) {
                classes.merge(a, b);
            }
        }
    }
    let mut pair_to_dof = vec![u32::MAX; cut.n_parts() * stride];
    let mut dof_to_vertex = Vec::with_capacity(background.n_vertices());
    for part in cut.all_parts() {
        for (local, &vertex) in background.cell(cut.part_cell(part)).iter().enumerate() {
            let index = part.index() * stride + local;
            let root = classes.lowest(index as u32) as usize;
            if pair_to_dof[root] == u32::MAX {
                pair_to_dof[root] = dof_to_vertex.len() as u32;
                dof_to_vertex.push(vertex);
            }
            pair_to_dof[index] = pair_to_dof[root];
        }
    }
    (pair_to_dof, dof_to_vertex)
}
