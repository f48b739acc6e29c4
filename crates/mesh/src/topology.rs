//! Facets of a simplicial mesh and their cells.

use std::collections::HashMap;

use crate::{CellId, Error, FacetId, VertexId};

/// Facets with their vertices and cells.
#[derive(Clone, Debug)]
pub(crate) struct Topology {
    /// Stride `D`; oriented outwards from the first cell.
    pub(crate) facet_to_vertex: Vec<VertexId>,
    /// The second entry is `None` on the boundary.
    pub(crate) facet_to_cell: Vec<[Option<CellId>; 2]>,
    /// Stride `D + 1`; local facet `i` is opposite to local vertex `i`.
    pub(crate) cell_to_facet: Vec<FacetId>,
}

impl Topology {
    /// Finds the facets of cells. `cell_to_vertex` has stride `D + 1`.
    ///
    /// # Errors
    /// [`Error::NonManifold`]: more than two cells share a facet.
    pub(crate) fn new<const D: usize>(cell_to_vertex: &[VertexId]) -> Result<Self, Error> {
        let stride = D + 1;
        let n_cells = cell_to_vertex.len() / stride;
        let mut topology = Self {
            facet_to_vertex: Vec::with_capacity(2 * n_cells * D),
            facet_to_cell: Vec::with_capacity(2 * n_cells),
            cell_to_facet: Vec::with_capacity(n_cells * stride),
        };
        let mut sorted_to_facet: HashMap<[VertexId; 3], FacetId> = HashMap::with_capacity(2 * n_cells);
        for (index, vertices) in cell_to_vertex.chunks_exact(stride).enumerate() {
            let cell = CellId::new(index);
            for local in 0..stride {
                let oriented = outward_facet::<D>(vertices, local);
                let mut key = [VertexId(u32::MAX); 3];
                key[..D].copy_from_slice(&oriented[..D]);
                key.sort_unstable();
                let next = FacetId::new(topology.facet_to_cell.len());
                let facet = *sorted_to_facet.entry(key).or_insert(next);
                if facet == next {
                    topology.facet_to_vertex.extend_from_slice(&oriented[..D]);
                    topology.facet_to_cell.push([Some(cell), None]);
                } else {
                    let cells = &mut topology.facet_to_cell[facet.index()];
                    if let [Some(a), Some(b)] = *cells {
                        return Err(Error::NonManifold { facet, cells: [a, b] });
                    }
                    cells[1] = Some(cell);
                }
                topology.cell_to_facet.push(facet);
            }
        }
        Ok(topology)
    }
}

/// Returns the vertices of a local facet of a positively oriented cell, with the normal out of the cell (2D: to the
/// right of the edge; 3D: right-hand rule). Only the first `D` entries are used.
pub(crate) fn outward_facet<const D: usize>(cell: &[VertexId], local: usize) -> [VertexId; 3] {
    let mut facet = [VertexId(u32::MAX); 3];
    for (slot, k) in (0..D).zip((0..=D).filter(|&k| k != local)) {
        facet[slot] = cell[k];
    }
    // Without vertex `local`, the orientation has the sign (-1)^local.
    if local % 2 == 1 {
        facet.swap(0, 1);
    }
    facet
}
