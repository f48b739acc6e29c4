//! Lagrange elements of order 1 and 2 on simplices: nodes, shape functions, division into linear simplices.
//!
//! The nodes of a simplex are its vertices, followed for order 2 by the middles of its edges in the order of [`EDGES`].
//! A point is given by barycentric coordinates `λ_0 .. λ_n`, its local coordinates are `ξ_k = λ_k`, k from 1.

use crate::{MAX_CELL_VERTICES, Point, Tensor, Vector, VertexId, det};

/// Number of nodes of the largest cell, a tetrahedron of order 2; local arrays have this length.
pub const MAX_CELL_NODES: usize = 10;

/// Number of nodes of the largest facet, a triangle of order 2; local arrays have this length.
pub const MAX_FACET_NODES: usize = 6;

/// Local vertices of the edges of a simplex. Entry 0 is the edge of a segment, entries 0–2 those of a triangle.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

/// Barycentric coordinates of a point; those beyond the dimension of the simplex are zero.
pub type Barycentric = [f64; MAX_CELL_VERTICES];

/// Order of the shape functions of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Linear, with nodes at the vertices.
    #[default]
    Linear,
    /// Quadratic, with nodes at the vertices and on the edges.
    Quadratic,
}

impl Order {
    /// Returns the degree of the shape functions.
    pub fn degree(self) -> usize {
        match self {
            Self::Linear => 1,
            Self::Quadratic => 2,
        }
    }

    /// Returns the number of nodes of a simplex of a dimension from 0 to 3.
    pub fn n_nodes(self, dimension: usize) -> usize {
        dimension + 1 + self.edges(dimension).len()
    }

    /// Returns the edges of a simplex that carry a node.
    fn edges(self, dimension: usize) -> &'static [[usize; 2]] {
        match self {
            Self::Linear => &[],
            Self::Quadratic => &EDGES[..dimension * (dimension + 1) / 2],
        }
    }

    /// Appends the nodes of the simplex with the given vertices; `on_edge` returns the node of an edge, given by its
    /// ends in ascending order.
    pub fn push_nodes(
        self,
        vertices: &[VertexId],
        mut on_edge: impl FnMut([VertexId; 2]) -> VertexId,
        out: &mut Vec<VertexId>,
    ) {
        out.extend_from_slice(vertices);
        for ends in self.edges(vertices.len() - 1) {
            let mut ends = ends.map(|k| vertices[k]);
            ends.sort_unstable();
            out.push(on_edge(ends));
        }
    }

    /// Returns the linear simplices through all nodes, of the orientation of the whole: local nodes, the first
    /// `dimension + 1` of each.
    pub fn parts(self, dimension: usize) -> &'static [[usize; MAX_CELL_VERTICES]] {
        match (self, dimension) {
            (Self::Linear, _) => &[[0, 1, 2, 3]],
            (_, 1) => &[[0, 2, 0, 0], [2, 1, 0, 0]],
            (_, 2) => &[[0, 3, 4, 0], [3, 1, 5, 0], [4, 5, 2, 0], [3, 5, 4, 0]],
            // Four corners, and four around the diagonal of the octahedron that remains.
            _ => &[
                [0, 4, 5, 7],
                [4, 1, 6, 8],
                [5, 6, 2, 9],
                [7, 8, 9, 3],
                [8, 5, 6, 4],
                [8, 5, 9, 6],
                [8, 5, 7, 9],
                [8, 5, 4, 7],
            ],
        }
    }

    /// Returns the middle of a part.
    pub fn middle(self, dimension: usize, part: usize) -> Barycentric {
        let weight = 1.0 / (dimension + 1) as f64;
        self.in_part(dimension, part, &std::array::from_fn(|k| if k <= dimension { weight } else { 0.0 }))
    }

    /// Returns a point of a part, given by its coordinates in the part.
    pub fn in_part(self, dimension: usize, part: usize, at: &Barycentric) -> Barycentric {
        let mut point = [0.0; MAX_CELL_VERTICES];
        for (&node, weight) in self.parts(dimension)[part][..=dimension].iter().zip(at) {
            for (sum, coordinate) in point.iter_mut().zip(self.node(dimension, node)) {
                *sum += weight * coordinate;
            }
        }
        point
    }

    /// Returns the part of a segment or triangle in which a point lies, and the smallest of its coordinates there.
    pub fn part_at(self, dimension: usize, at: &Barycentric) -> (usize, f64) {
        let smallest = |coordinates: &mut dyn Iterator<Item = f64>| coordinates.fold(f64::INFINITY, f64::min);
        let corners = &at[..=dimension];
        match (self, corners.iter().position(|l| *l >= 0.5)) {
            (Self::Linear, _) => (0, smallest(&mut corners.iter().copied())),
            (_, Some(corner)) => {
                let doubled =
                    corners.iter().enumerate().map(|(k, l)| if k == corner { 2.0 * l - 1.0 } else { 2.0 * l });
                (corner, smallest(&mut { doubled }))
            }
            (_, None) => (dimension + 1, smallest(&mut corners.iter().map(|l| 1.0 - 2.0 * l))),
        }
    }

    /// Returns the barycentric coordinates of the mean of some nodes of a cell, given the identifiers of all its nodes
    /// and of these.
    pub fn middle_of(self, dimension: usize, cell: &[VertexId], nodes: &[VertexId]) -> Barycentric {
        let mut middle = [0.0; MAX_CELL_VERTICES];
        for (local, _) in cell.iter().enumerate().filter(|(_, node)| nodes.contains(node)) {
            for (sum, coordinate) in middle.iter_mut().zip(self.node(dimension, local)) {
                *sum += coordinate / nodes.len() as f64;
            }
        }
        middle
    }

    /// Returns the position of a node.
    pub fn node(self, dimension: usize, node: usize) -> Barycentric {
        let mut point = [0.0; MAX_CELL_VERTICES];
        match node.checked_sub(dimension + 1) {
            None => point[node] = 1.0,
            Some(edge) => EDGES[edge].iter().for_each(|&end| point[end] = 0.5),
        }
        point
    }

    /// Evaluates the shape functions of a simplex at a point: `λ_i`, or `λ_i (2 λ_i - 1)` and `4 λ_i λ_j`.
    pub fn shape(self, dimension: usize, at: &Barycentric) -> ShapeFunctions {
        let mut shape = ShapeFunctions { values: [0.0; MAX_CELL_NODES], derivatives: [[0.0; 3]; MAX_CELL_NODES] };
        let mut set = |node: usize, value: f64, by: &[(usize, f64)]| {
            shape.values[node] = value;
            // λ_0 = 1 - Σ ξ_k
            for &(vertex, slope) in by {
                match vertex.checked_sub(1) {
                    None => shape.derivatives[node][..dimension].iter_mut().for_each(|d| *d -= slope),
                    Some(k) => shape.derivatives[node][k] += slope,
                }
            }
        };
        for (i, &l) in at[..=dimension].iter().enumerate() {
            match self {
                Self::Linear => set(i, l, &[(i, 1.0)]),
                Self::Quadratic => set(i, l * (2.0 * l - 1.0), &[(i, 4.0 * l - 1.0)]),
            }
        }
        for (edge, &[i, j]) in self.edges(dimension).iter().enumerate() {
            set(dimension + 1 + edge, 4.0 * at[i] * at[j], &[(i, 4.0 * at[j]), (j, 4.0 * at[i])]);
        }
        shape
    }
}

/// Shape functions at a point of the reference simplex; entries beyond the nodes are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFunctions {
    /// Values.
    pub values: [f64; MAX_CELL_NODES],
    /// Derivatives with respect to the local coordinates; those beyond the dimension are zero.
    pub derivatives: [[f64; 3]; MAX_CELL_NODES],
}

impl ShapeFunctions {
    /// Returns `Σ N_i x_i`.
    #[inline]
    pub fn at<const D: usize>(&self, nodes: &[Vector<D>]) -> Vector<D> {
        nodes.iter().zip(&self.values).map(|(x, value)| x * *value).sum()
    }

    /// Returns `Σ ∂N_i/∂ξ_k x_i`.
    #[inline]
    pub fn along<const D: usize>(&self, k: usize, nodes: &[Vector<D>]) -> Vector<D> {
        nodes.iter().zip(&self.derivatives).map(|(x, by)| x * by[k]).sum()
    }

    /// Appends the gradients of the shape functions of a cell with the given nodes, and returns the determinant of the
    /// map from the reference cell. It is NaN where gradients are not finite.
    pub fn push_gradients<const D: usize>(&self, nodes: &[Point<D>], gradients: &mut Vec<Vector<D>>) -> f64 {
        let mut jacobian = Tensor::<D>::zeros();
        (0..D).for_each(|k| jacobian.set_column(k, &self.along(k, nodes)));
        let inverse = jacobian.try_inverse().unwrap_or_else(|| Tensor::from_element(f64::NAN));
        let local = |by: &[f64; 3]| Vector::<D>::from_fn(|k, _| by[k]);
        gradients.extend(self.derivatives[..nodes.len()].iter().map(|by| inverse.transpose() * local(by)));
        if inverse.norm_squared().is_finite() { det(&jacobian) } else { f64::NAN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDERS: [Order; 2] = [Order::Linear, Order::Quadratic];

    #[test]
    fn points_are_in_the_part_that_they_were_given_in() {
        for (order, dimension) in ORDERS.into_iter().flat_map(|order| [1, 2].map(|n| (order, n))) {
            for part in 0..order.parts(dimension).len() {
                for at in [[0.7, 0.3, 0.0], [0.1, 0.9, 0.0], [0.2, 0.5, 0.3], [0.5, 0.1, 0.4]] {
                    let [a, b, c] = if dimension == 1 { [at[0], 1.0 - at[0], 0.0] } else { at };
                    let (found, smallest) = order.part_at(dimension, &order.in_part(dimension, part, &[a, b, c, 0.0]));
                    let expected = if dimension == 1 { a.min(b) } else { a.min(b).min(c) };
                    assert!(found == part || expected == 0.0, "{order:?}, {dimension}: {found} for {part}");
                    assert!((smallest - expected).abs() < 1e-15, "{smallest} {expected}");
                }
            }
        }
    }

    #[test]
    fn shape_functions_are_one_at_their_node_and_sum_to_one() {
        for (order, dimension) in ORDERS.into_iter().flat_map(|order| (1..=3).map(move |n| (order, n))) {
            let n = order.n_nodes(dimension);
            for k in 0..n {
                let shape = order.shape(dimension, &order.node(dimension, k));
                assert!((0..MAX_CELL_NODES).all(|i| shape.values[i] == f64::from(u8::from(i == k))));
            }
            // Derivatives by differences, exact for polynomials of degree 2.
            let at = |xi: [f64; 3]| [1.0 - xi.iter().take(dimension).sum::<f64>(), xi[0], xi[1], xi[2]];
            let point: [f64; 3] = std::array::from_fn(|k| if k < dimension { 0.1 + 0.2 * k as f64 } else { 0.0 });
            let shape = order.shape(dimension, &at(point));
            assert!((shape.values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for k in 0..dimension {
                let moved = |by: f64| {
                    let mut moved = point;
                    moved[k] += by;
                    order.shape(dimension, &at(moved)).values
                };
                let (ahead, behind) = (moved(0.25), moved(-0.25));
                assert!((0..n).all(|i| (2.0 * (ahead[i] - behind[i]) - shape.derivatives[i][k]).abs() < 1e-14));
            }
        }
    }

    #[test]
    fn parts_fill_the_simplex_and_keep_its_orientation() {
        fn fill<const D: usize>() {
            for order in ORDERS {
                let place = |node: usize| Vector::<D>::from_fn(|k, _| order.node(D, node)[k + 1]);
                let parts = order.parts(D);
                let mut sum = 0.0;
                for (part, nodes) in parts.iter().enumerate() {
                    let corners: Vec<_> = nodes[..=D].iter().map(|&node| place(node)).collect();
                    let volume = crate::Simplex::<D>::new(&corners).volume();
                    sum += volume;
                    assert!((volume * parts.len() as f64 * (1..=D).product::<usize>() as f64 - 1.0).abs() < 1e-14);
                    let middle = order.middle(D, part);
                    let centroid = crate::Simplex::<D>::new(&corners).centroid();
                    assert!((0..D).all(|k| (middle[k + 1] - centroid[k]).abs() < 1e-15));
                }
                assert!((sum * (1..=D).product::<usize>() as f64 - 1.0).abs() < 1e-14);
                // Every node is a corner of a part.
                assert!((0..order.n_nodes(D)).all(|node| parts.iter().any(|part| part[..=D].contains(&node))));
            }
        }
        fill::<2>();
        fill::<3>();
    }
}
