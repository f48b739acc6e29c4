//! The wet surface of a body, compared with the plane facets at which the fluid is cut.

use algebra::time::Affine;
use algebra::{DofId, Sites};
use mesh::{
    BodyId, BoundaryMesh, FacetId, MAX_CELL_VERTICES, MAX_FACET_NODES, Order, Placed, Point, ShapeFunctions, Tensor,
    Vector, area_vector,
};

use crate::InterfacePoints;

/// The interface pieces of a body whose motion is unknown: one item per piece, one site per quadrature point.
///
/// A point of a piece is a point of the body. It has a place on the plane facet at which the fluid is cut, and one on
/// the surface of the element, which is curved for order 2, at the stage. The latter depends on the unknown velocity.
/// Its pressure is that of the fluid at its place on the element at the positions of the cut, so that a hydrostatic
/// pressure carries the weight of the volume of the elements.
#[derive(Clone)]
pub struct MovedSurface<'a, const D: usize> {
    points: InterfacePoints<'a, D>,
    body: BodyId,
    /// Reference positions of the nodes, and their displacements at the stage; `None`: positions of the cut.
    stage: Option<(&'a [Point<D>], Affine<Vector<D>>)>,
    /// Indices of the pieces.
    pieces: Vec<usize>,
}

/// A quadrature point of a piece.
///
/// Local unknowns: velocities of the nodes of the body on the facet, `D` components each, then the pressures of the
/// fluid nodes.
pub struct MovedPoint<const D: usize> {
    /// `α (p n dA)` on the element at the stage minus that on the plane facet of the cut, with the weight `α` of the
    /// fluid's traction and the normal `n` out of the body. The force on the body is the opposite.
    pub load: Vector<D>,
    /// Derivatives of `load` with respect to the pressures of the fluid nodes; only the first `D + 1` are used.
    pub by_pressure: [Vector<D>; MAX_CELL_VERTICES],
    /// Number of nodes of the body on the facet.
    pub n_nodes: usize,
    /// Shape values of these nodes; the others are zero.
    pub shape: [f64; MAX_FACET_NODES],
    /// Derivatives of `load` with respect to the velocities of the nodes: column `b` is that by component `b`.
    pub by_velocity: [Tensor<D>; MAX_FACET_NODES],
}

impl<const D: usize> MovedPoint<D> {
    /// Returns the first local row of the velocity of a node. For `n_nodes` it is the row of the first pressure.
    pub(crate) fn row(&self, node: usize) -> usize {
        D * node
    }
}

impl<'a, const D: usize> MovedSurface<'a, D> {
    /// Creates the points of a body; none if its motion is prescribed. `stage` has the reference positions of its nodes
    /// and their displacements at the stage. Without it the surface is that of the cut, so that only curved elements
    /// differ from it.
    pub fn new(
        points: InterfacePoints<'a, D>,
        body: BodyId,
        stage: Option<(&'a [Point<D>], Affine<Vector<D>>)>,
    ) -> Self {
        let is_unknown = points.surfaces[body.index()].field().is_some();
        let pieces = points.geometry.cut.interface().iter().enumerate();
        let pieces = pieces.filter(|(_, piece)| is_unknown && piece.body == body).map(|(item, _)| item).collect();
        Self { points, body, stage, pieces }
    }

    /// Returns the force on the body at the state `x`. In axisymmetric coordinates the radial component is not set to
    /// zero ([`mesh::Coordinates::resultant`]).
    pub fn force(&self, x: &[f64]) -> Vector<D> {
        let mut force = Vector::zeros();
        (0..self.len()).for_each(|item| self.visit(item, x, |point| force -= point.load));
        force
    }
}

/// Returns the area vector per share of a facet at a point, and its derivatives with respect to the positions of the
/// nodes. The facet is a part of that of an element with the given nodes. The mean over all points is the area vector
/// of the element along this part; for order 1 it is constant.
pub(crate) fn area<const D: usize>(
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

/// Returns a list with a point for each node of the body on a facet, of which the first ones are used.
pub(crate) fn on_facet<const D: usize>(
    boundary: &BoundaryMesh<D>,
    facet: FacetId,
    at: impl Fn(usize) -> Point<D>,
) -> [Point<D>; MAX_FACET_NODES] {
    let nodes = boundary.nodes(facet);
    std::array::from_fn(|k| nodes.get(k).map_or(Point::zeros(), |node| at(node.index())))
}

impl<const D: usize> Sites for MovedSurface<'_, D> {
    type Site = MovedPoint<D>;

    fn len(&self) -> usize {
        self.pieces.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let InterfacePoints { geometry, fields, surfaces, .. } = &self.points;
        let (piece, surface) = (&geometry.cut.interface()[self.pieces[item]], surfaces[self.body.index()]);
        let nodes = surface.boundary.nodes(piece.facet).iter();
        out.extend(surface.field().iter().flat_map(|f| nodes.clone().flat_map(|v| fields.layout.node(*f, v.index()))));
        let of_fluid = geometry.space.dofs(piece.part).iter();
        out.extend(of_fluid.flat_map(|&node| fields.layout.node(fields.pressure, node as usize)));
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let InterfacePoints { geometry, fields, values, positions, .. } = &self.points;
        let (item, body) = (self.pieces[item], self.body.index());
        let (piece, surface) = (&geometry.cut.interface()[item], self.points.surfaces[body]);
        let boundary = surface.boundary;
        let (coordinates, n_nodes) = (boundary.coordinates(), boundary.nodes(piece.facet).len());
        let velocity_of = |node: usize| surface.velocity_at(mesh::VertexId::new(node), fields.layout, x);
        let cut = on_facet(boundary, piece.facet, |node| positions[body][node]);
        let (moved, slope) = match &self.stage {
            Some((reference, displacement)) => {
                let at_stage = |node| reference[node] + displacement.at(node, velocity_of(node));
                (on_facet(boundary, piece.facet, at_stage), displacement.slope)
            }
            None => (cut, 0.0),
        };
        let whole = Placed::new(boundary, &positions[body]).facet_measure(piece.facet);
        let (nodes, alpha) = (geometry.space.dofs(piece.part), self.points.alpha(self.body));
        let gradients = values.gradients(item);
        for at in values.points(item) {
            let shape = boundary.shape(piece.facet, &at.in_facet);
            // A facet without a measure has no area at any position.
            let share = if whole > 0.0 { at.measure / whole } else { 0.0 };
            let (of_moved, by_node) = area(boundary.order(), &shape, &moved[..n_nodes]);
            let weight = share * coordinates.weight(&shape.at(&moved[..n_nodes]));
            let by_position = coordinates.weight_gradient::<D>() * share;
            let (of_moved, of_cut) = (of_moved * alpha, piece.normal * (alpha * at.weight));
            // From the plane facet of the cut to the element; zero for order 1 but for round-off.
            let offset = match boundary.order() {
                Order::Linear => Vector::zeros(),
                Order::Quadratic => shape.at(&cut[..n_nodes]) - at.point,
            };
            let on_element = |i: usize| at.fluid[i] + gradients[i].dot(&offset);
            let by_pressure = std::array::from_fn(|i| of_moved * (weight * on_element(i)) - of_cut * at.fluid[i]);
            let at_nodes = || nodes.iter().map(|node| fields.pressure_at(x, *node)).enumerate();
            let pressure = at_nodes().map(|(i, p)| p * on_element(i)).sum::<f64>();
            visit(&MovedPoint {
                load: at_nodes().map(|(i, p)| by_pressure[i] * p).sum(),
                by_pressure,
                n_nodes,
                shape: at.solid,
                by_velocity: std::array::from_fn(|k| {
                    let by_area = by_node[k] * (alpha * weight);
                    (by_area + of_moved * (by_position * at.solid[k]).transpose()) * (slope * pressure)
                }),
            });
        }
    }
}
