//! A facet of a body at the positions of the cut and at those at which the pressure of the fluid acts.

use body::SurfaceMotion;
use mesh::{FacetId, MAX_FACET_NODES, Order, Point, ShapeFunctions, Tensor, Vector, area_vector};

/// A facet of the surface with its element: for order 1 the facet itself, for order 2 a curved element, of which the
/// facet is a linear part.
///
/// The pressure acts at the stage of the step, which depends on the unknown velocities, or at the positions of the cut
/// ([`SurfaceMotion::stage`]).
pub(crate) struct MovedFacet<'a, const D: usize> {
    surface: &'a SurfaceMotion<'a, D>,
    pub(crate) n_nodes: usize,
    /// Positions of the nodes of the element at the cut.
    cut: [Point<D>; MAX_FACET_NODES],
    /// Positions of these nodes where the pressure acts.
    moved: [Point<D>; MAX_FACET_NODES],
    /// Derivative of these positions with respect to the velocities.
    slope: f64,
}

/// The area vector of a surface at a point.
pub(crate) struct MovedArea<const D: usize> {
    /// Vector along the normal out of the body, times the weight of the coordinates. Its mean over a linear part is the
    /// area vector of the element along this part.
    pub(crate) vector: Vector<D>,
    /// Derivatives with respect to the velocities of the nodes: column `b` is that by component `b`.
    pub(crate) by_velocity: [Tensor<D>; MAX_FACET_NODES],
}

impl<'a, const D: usize> MovedFacet<'a, D> {
    /// Creates the facet for velocities of the vertices.
    pub(crate) fn new(
        surface: &'a SurfaceMotion<'a, D>,
        facet: FacetId,
        velocity: impl Fn(mesh::VertexId) -> Vector<D>,
    ) -> Self {
        let boundary = surface.boundary;
        let cut = boundary.at_nodes(facet, |node| surface.geometry[node.index()]);
        let (moved, slope) = match &surface.stage {
            Some(stage) => (boundary.at_nodes(facet, |node| stage.at(node.index(), velocity(node))), stage.slope),
            None => (cut, 0.0),
        };
        Self { surface, n_nodes: boundary.nodes(facet).len(), cut, moved, slope }
    }

    /// Returns the place of a point on the element at the cut. For order 1 it is the place on the facet.
    pub(crate) fn place(&self, shape: &ShapeFunctions) -> Point<D> {
        shape.at(&self.cut[..self.n_nodes])
    }

    /// Returns the area vector at a point where the pressure acts.
    pub(crate) fn area(&self, shape: &ShapeFunctions) -> MovedArea<D> {
        let (boundary, nodes) = (self.surface.boundary, &self.moved[..self.n_nodes]);
        let coordinates = boundary.coordinates();
        let (weight, by_position) = (coordinates.weight(&shape.at(nodes)), coordinates.weight_gradient::<D>());
        let (area, by_node) = area(boundary.order(), shape, nodes);
        let by_weight = |k: usize| area * (by_position * shape.values[k]).transpose();
        MovedArea {
            vector: area * weight,
            by_velocity: std::array::from_fn(|k| (by_node[k] * weight + by_weight(k)) * self.slope),
        }
    }
}

/// Returns the first local row of the velocity of a node of a facet. For the number of nodes it is the row of the first
/// pressure.
pub(crate) fn row<const D: usize>(node: usize) -> usize {
    D * node
}

/// Returns the area vector of an element at a point, and its derivatives with respect to the positions of the nodes.
/// The mean over a linear part of the element is the area vector along this part; for order 1 it is constant.
fn area<const D: usize>(
    order: Order,
    shape: &ShapeFunctions,
    nodes: &[Point<D>],
) -> (Vector<D>, [Tensor<D>; MAX_FACET_NODES]) {
    let share = 1.0 / ((1..D).product::<usize>() * order.parts(D - 1).len()) as f64;
    let mut tangents = Tensor::<D>::zeros();
    (1..D).for_each(|k| tangents.set_column(k, &shape.along(k - 1, nodes)));
    let mut by_node = [Tensor::<D>::zeros(); MAX_FACET_NODES];
    for k in 1..D {
        let mut by_tangent = Tensor::<D>::zeros();
        for b in 0..D {
            let mut varied = tangents;
            varied.column_mut(k).fill(0.0);
            varied[(b, k)] = share;
            by_tangent.set_column(b, &area_vector(&varied));
        }
        for (by, derivative) in by_node.iter_mut().zip(&shape.derivatives[..nodes.len()]) {
            *by += by_tangent * derivative[k - 1];
        }
    }
    (area_vector(&tangents) * share, by_node)
}
