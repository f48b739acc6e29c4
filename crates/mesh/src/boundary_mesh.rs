//! The oriented boundary of a solid.

use crate::{CellId, Coordinates, FacetId, Tag, VertexId};

/// Oriented facets of a closed surface. Normals point out of the solid (2D: to the right of the edge; 3D: right-hand
/// rule).
///
/// Vertices have the ids of the solid mesh, so that its positions can be used. They are not stored: see
/// [`crate::Placed`].
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryMesh<const D: usize> {
    facet_to_vertex: Vec<VertexId>,
    facet_to_cell: Vec<CellId>,
    tags: Vec<Option<Tag>>,
    coordinates: Coordinates,
}

impl<const D: usize> BoundaryMesh<D> {
    /// Creates a boundary from its facets.
    ///
    /// Shapes: `facet_to_vertex` has stride `D`; `facet_to_cell` and `tags` have one entry per facet. `facet_to_cell`
    /// is empty for a surface without a volume mesh.
    ///
    /// # Panics
    /// If the lengths do not match.
    pub fn new(facet_to_vertex: Vec<VertexId>, facet_to_cell: Vec<CellId>, tags: Vec<Option<Tag>>) -> Self {
        let n = facet_to_vertex.len() / D;
        let length = facet_to_vertex.len();
        assert!(n * D == length, "a facet has {D} vertices, so that {length} vertices do not make whole facets");
        assert!(facet_to_cell.is_empty() || facet_to_cell.len() == n, "one cell per facet, or none at all");
        assert_eq!(tags.len(), n, "one tag per facet");
        Self { facet_to_vertex, facet_to_cell, tags, coordinates: Coordinates::default() }
    }

    /// Creates a surface without a volume mesh, from its facets (stride `D`).
    ///
    /// # Panics
    /// If the number of vertices is not a multiple of `D`.
    pub fn from_facets(facet_to_vertex: Vec<VertexId>) -> Self {
        let tags = vec![None; facet_to_vertex.len() / D];
        Self::new(facet_to_vertex, Vec::new(), tags)
    }

    /// Returns the surface in the given coordinates; those of a new surface are Cartesian.
    #[must_use]
    pub fn with_coordinates(self, coordinates: Coordinates) -> Self {
        Self { coordinates, ..self }
    }

    /// Returns the coordinates.
    #[inline]
    pub fn coordinates(&self) -> Coordinates {
        self.coordinates
    }

    /// Returns the surface with the opposite orientation.
    pub fn reversed(&self) -> Self {
        let mut reversed = self.clone();
        reversed.facet_to_vertex.chunks_exact_mut(D).for_each(|facet| facet.swap(0, 1));
        reversed
    }

    /// Returns the number of facets.
    pub fn n_facets(&self) -> usize {
        self.tags.len()
    }

    /// Returns all facets in ascending order.
    pub fn facets(&self) -> impl Iterator<Item = FacetId> + use<D> {
        (0..self.n_facets()).map(FacetId::new)
    }

    /// Returns the vertices of a facet, `D` of them.
    #[inline]
    pub fn facet(&self, facet: FacetId) -> &[VertexId] {
        &self.facet_to_vertex[facet.index() * D..][..D]
    }

    /// Returns the vertices of facets, each once, in order.
    pub fn vertices_of(&self, facets: &[FacetId]) -> Vec<VertexId> {
        let mut vertices: Vec<_> = facets.iter().flat_map(|&facet| self.facet(facet)).copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// Returns the cell behind a facet; `None` for a surface without a volume mesh.
    #[inline]
    pub fn facet_to_cell(&self, facet: FacetId) -> Option<CellId> {
        self.facet_to_cell.get(facet.index()).copied()
    }

    /// Returns the tag of a facet.
    pub fn tag(&self, facet: FacetId) -> Option<Tag> {
        self.tags[facet.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "a facet has 2 vertices, so that 3 vertices do not make whole facets")]
    fn an_incomplete_facet_is_refused() {
        BoundaryMesh::<2>::from_facets([0, 1, 2].map(VertexId).to_vec());
    }
}
