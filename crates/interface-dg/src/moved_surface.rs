//! The wet surface of a body at the stage of a step, compared with the surface at which the fluid is cut.

use algebra::time::Affine;
use algebra::{DofId, Sites};
use mesh::{BodyId, MAX_CELL_VERTICES, MAX_FACET_NODES, Placed, Point, Tensor, Vector, area_vector};

use crate::InterfacePoints;

/// The interface pieces of a body whose motion is unknown: one item per piece, one site per quadrature point.
///
/// Each piece has two positions: that of the cut, and that on its facet at the stage, which depends on the unknown
/// velocity.
#[derive(Clone)]
pub struct MovedSurface<'a, const D: usize> {
    points: InterfacePoints<'a, D>,
    body: BodyId,
    reference: &'a [Point<D>],
    displacement: Affine<Vector<D>>,
    /// Indices of the pieces.
    pieces: Vec<usize>,
}

/// A quadrature point of a piece, at its moved position and at that of the cut.
pub struct MovedPoint<const D: usize> {
    /// Pressure of the fluid times its weight `α` in the traction.
    pub pressure: f64,
    /// Derivatives of `pressure` with respect to the pressures of the nodes; only the first `D + 1` are used.
    pub by_pressure: [f64; MAX_CELL_VERTICES],
    /// Number of nodes of the body on the facet.
    pub n_nodes: usize,
    /// Shape values of these nodes. Local unknowns: their velocities, `D` components each, then the pressures of the
    /// fluid nodes.
    pub shape: [f64; MAX_FACET_NODES],
    /// Area vector `n dA` out of the body at the moved position minus that on the cut, with the quadrature weight and
    /// the weight of the coordinates.
    pub change: Vector<D>,
    /// The vertices of the facet among the nodes.
    pub vertices: [usize; D],
    /// Derivatives of `change` with respect to the velocities of the vertices: column `b` is that by component `b`.
    pub by_velocity: [Tensor<D>; D],
}

impl<const D: usize> MovedPoint<D> {
    /// Returns the first local row of the velocity of a node. For `n_nodes` it is the row of the first pressure.
    pub(crate) fn row(&self, node: usize) -> usize {
        D * node
    }
}

impl<'a, const D: usize> MovedSurface<'a, D> {
    /// Creates the points of a body from the reference positions of its vertices and their displacements at the stage;
    /// none if the motion of the body is prescribed.
    pub fn new(
        points: InterfacePoints<'a, D>,
        body: BodyId,
        (reference, displacement): (&'a [Point<D>], Affine<Vector<D>>),
    ) -> Self {
        let is_unknown = points.surfaces[body.index()].field().is_some();
        let pieces = points.geometry.cut.interface().iter().enumerate();
        let pieces = pieces.filter(|(_, piece)| is_unknown && piece.body == body).map(|(item, _)| item).collect();
        Self { points, body, reference, displacement, pieces }
    }

    /// Returns the force on the body at the state `x`. In axisymmetric coordinates the radial component is not set to
    /// zero ([`mesh::Coordinates::resultant`]).
    pub fn force(&self, x: &[f64]) -> Vector<D> {
        let mut force = Vector::zeros();
        (0..self.len()).for_each(|item| self.visit(item, x, |point| force -= point.change * point.pressure));
        force
    }
}

/// Returns the area vector of a facet, and its derivatives with respect to the positions of the vertices.
fn area<const D: usize>(points: &[Point<D>; D]) -> (Vector<D>, [Tensor<D>; D]) {
    let simplex = 1.0 / (1..D).product::<usize>() as f64;
    let mut edges = Tensor::<D>::zeros();
    (1..D).for_each(|k| edges.set_column(k, &(points[k] - points[0])));
    let mut by_vertex = [Tensor::<D>::zeros(); D];
    for k in 1..D {
        for b in 0..D {
            let mut varied = edges;
            varied.column_mut(k).fill(0.0);
            varied[(b, k)] = simplex;
            by_vertex[k].set_column(b, &area_vector(&varied));
        }
        let along = by_vertex[k];
        by_vertex[0] -= along;
    }
    (area_vector(&edges) * simplex, by_vertex)
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
        let (vertices, coordinates) = (surface.boundary.facet(piece.facet), surface.boundary.coordinates());
        let moved: [Point<D>; D] = std::array::from_fn(|k| {
            let velocity = surface.velocity_at(vertices[k], fields.layout, x);
            self.reference[vertices[k].index()] + self.displacement.at(vertices[k].index(), velocity)
        });
        let (of_moved, by_vertex) = area(&moved);
        let of_body = surface.boundary.nodes(piece.facet);
        let local = |vertex| of_body.iter().position(|node| node == vertex).unwrap_or_default();
        let of_facet: [usize; D] = std::array::from_fn(|k| local(&vertices[k]));
        let whole = Placed::new(surface.boundary, &positions[body]).facet_measure(piece.facet);
        let (nodes, alpha) = (geometry.space.dofs(piece.part), self.points.alpha(self.body));
        for at in values.points(item) {
            let position = moved.iter().zip(&at.in_facet).map(|(x, n)| x * *n).sum::<Point<D>>();
            let share = at.measure / whole;
            let (weight, slope) = (share * coordinates.weight(&position), self.displacement.slope);
            let by_position = coordinates.weight_gradient::<D>() * share;
            let mut by_pressure = at.fluid;
            by_pressure.iter_mut().for_each(|shape| *shape *= alpha);
            let at_nodes = nodes.iter().zip(&by_pressure);
            visit(&MovedPoint {
                pressure: at_nodes.map(|(node, shape)| fields.pressure_at(x, *node) * shape).sum(),
                by_pressure,
                n_nodes: of_body.len(),
                shape: at.solid,
                vertices: of_facet,
                change: of_moved * weight - piece.normal * at.weight,
                by_velocity: std::array::from_fn(|k| {
                    (by_vertex[k] * weight + of_moved * (by_position * at.in_facet[k]).transpose()) * slope
                }),
            });
        }
    }
}
