//! The oriented boundary of a solid.

use crate::{
    CellId, Coordinates, FacetId, MAX_CELL_VERTICES, MAX_FACET_NODES, Order, ShapeFunctions, Tag, Vector, VertexId,
};

/// Oriented facets of a closed surface. Normals point out of the solid (2D: to the right of the edge; 3D: right-hand
/// rule).
///
/// Vertices have the ids of the solid mesh, so that its positions can be used. They are not stored: see
/// [`crate::Placed`].
///
/// Facets may be the parts of the facets of elements of order 2 ([`BoundaryMesh::of_elements`]). Geometry is that of
/// the parts; fields of the solid have the shape functions of the elements.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryMesh<const D: usize> {
    facet_to_vertex: Vec<VertexId>,
    facet_to_cell: Vec<CellId>,
    tags: Vec<Option<Tag>>,
    coordinates: Coordinates,
    order: Order,
    /// Nodes of the facets of elements; empty for order 1. Stride: nodes of such a facet.
    element_to_node: Vec<VertexId>,
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
        let (order, element_to_node) = (Order::Linear, Vec::new());
        Self { facet_to_vertex, facet_to_cell, tags, coordinates: Coordinates::default(), order, element_to_node }
    }

    /// Creates the boundary of a solid with elements of some order. Facets are the parts of those of the elements
    /// ([`Order::parts`]), one element after another.
    ///
    /// Shapes: `element_to_node` has the stride [`Order::n_nodes`] in dimension `D - 1`; `element_to_cell` and `tags`
    /// have one entry per facet of an element.
    ///
    /// # Panics
    /// If the lengths do not match.
    pub fn of_elements(
        order: Order,
        element_to_node: Vec<VertexId>,
        element_to_cell: &[CellId],
        tags: &[Option<Tag>],
    ) -> Self {
        let parts = order.parts(D - 1);
        let part = |nodes: &[VertexId], part: &[usize; MAX_CELL_VERTICES]| part.map(|k| nodes.get(k).copied());
        let elements = element_to_node.chunks_exact(order.n_nodes(D - 1));
        let vertices =
            elements.flat_map(|nodes| parts.iter().flat_map(|of| part(nodes, of).into_iter().take(D).flatten()));
        let repeated = |n: usize| (0..n * parts.len()).map(|facet| facet / parts.len());
        let boundary = Self::new(
            vertices.collect(),
            repeated(element_to_cell.len()).map(|element| element_to_cell[element]).collect(),
            repeated(tags.len()).map(|element| tags[element]).collect(),
        );
        let element_to_node = if order == Order::Linear { Vec::new() } else { element_to_node };
        Self { order, element_to_node, ..boundary }
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

    /// Returns the surface with the opposite orientation, for obstacles: its order is 1.
    pub fn reversed(&self) -> Self {
        let mut reversed = Self { order: Order::Linear, element_to_node: Vec::new(), ..self.clone() };
        reversed.facet_to_vertex.chunks_exact_mut(D).for_each(|facet| facet.swap(0, 1));
        reversed
    }

    /// Returns the order of the elements of the solid.
    pub fn order(&self) -> Order {
        self.order
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

    /// Returns the index of the facet of an element that a facet is a part of, and the index of the part.
    #[inline]
    pub fn element_of(&self, facet: FacetId) -> (usize, usize) {
        let n_parts = self.order.parts(D - 1).len();
        (facet.index() / n_parts, facet.index() % n_parts)
    }

    /// Splits a list of facets in which the parts of an element follow each other into the parts of each element.
    pub fn by_element<'f>(&self, facets: &'f [FacetId]) -> impl Iterator<Item = &'f [FacetId]> + use<'f, D> {
        let n_parts = self.order.parts(D - 1).len();
        facets.chunk_by(move |a, b| a.index() / n_parts == b.index() / n_parts)
    }

    /// Returns the nodes of the facet of an element that a facet is a part of; for order 1 the vertices of the facet.
    #[inline]
    pub fn nodes(&self, facet: FacetId) -> &[VertexId] {
        if self.order == Order::Linear {
            return self.facet(facet);
        }
        let n = self.order.n_nodes(D - 1);
        &self.element_to_node[self.element_of(facet).0 * n..][..n]
    }

    /// Returns a value for each node of a facet ([`BoundaryMesh::nodes`]); the other entries are zero.
    #[inline]
    pub fn at_nodes(&self, facet: FacetId, of: impl Fn(VertexId) -> Vector<D>) -> [Vector<D>; MAX_FACET_NODES] {
        let nodes = self.nodes(facet);
        std::array::from_fn(|k| nodes.get(k).map_or(Vector::zeros(), |node| of(*node)))
    }

    /// Returns the shape functions of the nodes ([`BoundaryMesh::nodes`]) at a point of a facet with the given
    /// barycentric coordinates in the facet. Derivatives are those with respect to the coordinates of the element.
    #[inline]
    pub fn shape(&self, facet: FacetId, at: &[f64; D]) -> ShapeFunctions {
        let mut in_part = [0.0; MAX_CELL_VERTICES];
        in_part[..D].copy_from_slice(at);
        self.order.shape(D - 1, &self.order.in_part(D - 1, self.element_of(facet).1, &in_part))
    }

    /// Returns all parts of the facet of an element; for order 1 the facet itself.
    pub fn parts_of(&self, element: usize) -> impl Iterator<Item = FacetId> + use<D> {
        let n_parts = self.order.parts(D - 1).len();
        (element * n_parts..(element + 1) * n_parts).map(FacetId::new)
    }

    /// Returns the vertices of facets, each once, in order.
    pub fn vertices_of(&self, facets: &[FacetId]) -> Vec<VertexId> {
        each_once(facets.iter().flat_map(|&facet| self.facet(facet)))
    }

    /// Returns the nodes of facets ([`BoundaryMesh::nodes`]), each once, in order.
    pub fn nodes_of(&self, facets: &[FacetId]) -> Vec<VertexId> {
        each_once(facets.iter().flat_map(|&facet| self.nodes(facet)))
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

/// Returns vertices, each once, in order.
fn each_once<'v>(vertices: impl Iterator<Item = &'v VertexId>) -> Vec<VertexId> {
    let mut vertices: Vec<_> = vertices.copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "a facet has 2 vertices, so that 3 vertices do not make whole facets")]
    fn an_incomplete_facet_is_refused() {
        BoundaryMesh::<2>::from_facets([0, 1, 2].map(VertexId).to_vec());
    }

    /// Checks nodes and shape functions of the parts of one facet of an element of order 2: they are one at a vertex of
    /// a part for its node, and the parts are those of the element.
    fn of_one_element<const D: usize>(n_nodes: usize, n_parts: usize) {
        let nodes: Vec<VertexId> = (10..10 + n_nodes).map(VertexId::new).collect();
        let boundary = BoundaryMesh::<D>::of_elements(Order::Quadratic, nodes.clone(), &[CellId::new(3)], &[None]);
        assert_eq!((boundary.n_facets(), boundary.order()), (n_parts, Order::Quadratic));
        for facet in boundary.facets() {
            assert_eq!((boundary.nodes(facet), boundary.facet_to_cell(facet)), (&nodes[..], Some(CellId::new(3))));
            for (k, vertex) in boundary.facet(facet).iter().enumerate() {
                let shape = boundary.shape(facet, &std::array::from_fn(|l| f64::from(u8::from(k == l))));
                let found = nodes.iter().zip(&shape.values).map(|(node, value)| (*value == 1.0).then_some(*node));
                assert_eq!(found.flatten().collect::<Vec<_>>(), [*vertex]);
            }
        }
        let reversed = boundary.reversed();
        assert_eq!((reversed.order(), reversed.nodes(FacetId(0))), (Order::Linear, reversed.facet(FacetId(0))));
    }

    #[test]
    fn parts_have_the_shape_functions_of_their_element() {
        of_one_element::<2>(3, 2);
        of_one_element::<3>(6, 4);
        // A quarter of a segment: λ (2 λ - 1) and 4 λ μ with λ = 3/4, μ = 1/4.
        let segment = BoundaryMesh::<2>::of_elements(Order::Quadratic, [0, 1, 2].map(VertexId).to_vec(), &[], &[None]);
        assert_eq!(segment.shape(FacetId(0), &[0.5, 0.5]).values[..3], [0.375, -0.125, 0.75]);
        let linear = BoundaryMesh::<3>::from_facets([4, 5, 6].map(VertexId).to_vec());
        assert_eq!(linear.shape(FacetId(0), &[0.2, 0.5, 0.3]).values[..4], [0.2, 0.5, 0.3, 0.0]);
    }
}
