//! The wet surface of a body, compared with the plane facets at which the fluid is cut.

use algebra::{DofId, Sites};
use mesh::{BodyId, MAX_CELL_VERTICES, MAX_FACET_NODES, Order, Placed, Tensor, Vector};

use crate::InterfacePoints;
use crate::moved_facet::MovedFacet;

/// The interface pieces of a body whose motion is unknown: one item per piece, one site per quadrature point.
///
/// A point of a piece is a point of the body. It has a place on the plane facet at which the fluid is cut, and one on
/// the surface of the element, which is curved for order 2. The pressure acts on the element at the stage, which
/// depends on the unknown velocity, or at the positions of the cut ([`body::SurfaceMotion::stage`]). The pressure is
/// evaluated at the point of the element at the positions of the cut, not on the plane facet. A hydrostatic pressure
/// therefore carries the weight of the fluid that the elements displace.
#[derive(Clone)]
pub struct MovedSurface<'a, const D: usize> {
    points: InterfacePoints<'a, D>,
    body: BodyId,
    /// Indices of the pieces.
    pieces: Vec<usize>,
}

/// A quadrature point of a piece.
///
/// Local unknowns: velocities of the nodes of the body on the facet, `D` components each, then the pressures of the
/// fluid nodes.
pub struct MovedPoint<const D: usize> {
    /// `α (p n dA)` on the element where the pressure acts minus that on the plane facet of the cut, with the weight
    /// `α` of the fluid's traction and the normal `n` out of the body: force (2D: per unit depth). The force on the
    /// body is `-load`.
    pub load: Vector<D>,
    /// Derivatives of `load` with respect to the pressures of the fluid nodes, areas; only the first `D + 1` are used.
    pub by_pressure: [Vector<D>; MAX_CELL_VERTICES],
    /// Number of nodes of the body on the facet.
    pub n_nodes: usize,
    /// Shape values of these nodes; the others are zero.
    pub shape: [f64; MAX_FACET_NODES],
    /// Derivatives of `load` with respect to the velocities of the nodes: column `b` is that by component `b`.
    pub by_velocity: [Tensor<D>; MAX_FACET_NODES],
}

impl<'a, const D: usize> MovedSurface<'a, D> {
    /// Creates the points of a body; none if its motion is prescribed.
    pub fn new(points: InterfacePoints<'a, D>, body: BodyId) -> Self {
        let is_unknown = points.surfaces[body.index()].field().is_some();
        let pieces = points.geometry.cut.interface().iter().enumerate();
        let pieces = pieces.filter(|(_, piece)| is_unknown && piece.body == body).map(|(item, _)| item).collect();
        Self { points, body, pieces }
    }

    /// Returns the force on the body at the state `x`. In axisymmetric coordinates the radial component is not set to
    /// zero ([`mesh::Coordinates::resultant`]).
    pub fn force(&self, x: &[f64]) -> Vector<D> {
        let mut force = Vector::zeros();
        (0..self.len()).for_each(|item| self.visit(item, x, |point| force -= point.load));
        force
    }
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
        let InterfacePoints { geometry, fields, values, .. } = &self.points;
        let item = self.pieces[item];
        let (piece, surface) = (&geometry.cut.interface()[item], self.points.surfaces[self.body.index()]);
        let boundary = surface.boundary;
        let facet = MovedFacet::new(surface, piece.facet, |node| surface.velocity_at(node, fields.layout, x));
        let whole = Placed::new(boundary, &surface.geometry).facet_measure(piece.facet);
        let (nodes, alpha) = (geometry.space.dofs(piece.part), self.points.alpha(self.body));
        let gradients = values.gradients(item);
        for at in values.points(item) {
            let shape = boundary.shape(piece.facet, &at.in_facet);
            // A facet of measure zero at the cut has no wet points. Zero avoids a division by zero.
            let share = if whole > 0.0 { alpha * at.measure / whole } else { 0.0 };
            let (moved, of_cut) = (facet.area(&shape), piece.normal * (alpha * at.weight));
            // From the plane facet of the cut to the element; zero for order 1 but for round-off.
            let offset = match boundary.order() {
                Order::Linear => Vector::zeros(),
                Order::Quadratic => facet.place(&shape) - at.point,
            };
            let on_element = |i: usize| at.fluid[i] + gradients[i].dot(&offset);
            let by_pressure = std::array::from_fn(|i| moved.vector * (share * on_element(i)) - of_cut * at.fluid[i]);
            let at_nodes = || nodes.iter().map(|node| fields.pressure_at(x, *node)).enumerate();
            let pressure = at_nodes().map(|(i, p)| p * on_element(i)).sum::<f64>();
            visit(&MovedPoint {
                load: at_nodes().map(|(i, p)| by_pressure[i] * p).sum(),
                by_pressure,
                n_nodes: facet.n_nodes,
                shape: at.solid,
                by_velocity: moved.by_velocity.map(|derivative| derivative * (share * pressure)),
            });
        }
    }
}
