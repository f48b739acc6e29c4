//! The closed part of a surface, which borders no fluid, with the pressure that is continued onto it.

use std::sync::Arc;

use algebra::{DofId, Sites};
use mesh::{FacetId, MAX_FACET_NODES, SimplexRule, Tensor, Vector};

use crate::FluidStress;
use crate::moved_facet::MovedFacet;

/// The closed part of the surface of a body whose motion is unknown: one item per facet.
///
/// The quadrature points are those of the facet, and those of its interface pieces with negative weights, so that the
/// integrals over wet and closed part add up to that over the facet. The pressure acts on the elements at the same
/// positions as on the wet part ([`crate::MovedSurface`]). The resultant of a constant pressure on the whole surface is
/// therefore zero, and that of a hydrostatic pressure is the buoyancy.
#[derive(Clone)]
pub struct ClosedPoints<'a, const D: usize> {
    stress: Arc<FluidStress<'a, D>>,
    facets: Vec<FacetId>,
    rule: &'static SimplexRule,
}

/// A quadrature point of the closed part.
pub struct ClosedPoint<const D: usize> {
    /// Traction `-p n` on the body, times the weight: force (2D: per unit depth).
    pub force: Vector<D>,
    /// Number of nodes of the body on the facet.
    pub n_nodes: usize,
    /// Shape values of these nodes. Local unknowns: their velocities, `D` components each, then the pressures of the
    /// fluid nodes of the piece at the rim.
    pub shape: [f64; MAX_FACET_NODES],
    /// Derivatives of the force with respect to the velocities of the nodes: column `b` is that by component `b`.
    pub by_velocity: [Tensor<D>; MAX_FACET_NODES],
    /// Derivatives of the force with respect to these pressures, areas.
    pub by_pressure: Vec<Vector<D>>,
}

impl<'a, const D: usize> ClosedPoints<'a, D> {
    /// Creates the points on the surface of the body on which `stress` acts; none if its motion is prescribed.
    pub fn new(stress: Arc<FluidStress<'a, D>>) -> Self {
        let boundary = stress.surface().boundary();
        let degree = 2 * boundary.order().degree() + boundary.coordinates().degree();
        let facets = if stress.motion().0.field().is_some() { stress.closed().collect() } else { Vec::new() };
        Self { stress, facets, rule: SimplexRule::of_degree(D - 1, degree) }
    }

    /// Returns the force of the pressure on the closed part. In axisymmetric coordinates the radial component is not
    /// set to zero ([`mesh::Coordinates::resultant`]).
    pub fn force(&self, x: &[f64]) -> Vector<D> {
        let mut force = Vector::zeros();
        (0..self.len()).for_each(|item| self.visit(item, x, |point| force += point.force));
        force
    }
}

impl<const D: usize> Sites for ClosedPoints<'_, D> {
    type Site = ClosedPoint<D>;

    fn len(&self) -> usize {
        self.facets.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let (facet, (motion, layout)) = (self.facets[item], self.stress.motion());
        let nodes = motion.boundary.nodes(facet).iter();
        out.extend(motion.field().iter().flat_map(|field| nodes.clone().flat_map(|v| layout.node(*field, v.index()))));
        out.extend(self.stress.rim_pressures(facet).map(|(dof, _)| dof));
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (facet, stress, (motion, layout)) = (self.facets[item], &self.stress, self.stress.motion());
        let (boundary, whole) = (motion.boundary, stress.surface().facet_measure(facet));
        let moved = MovedFacet::new(motion, facet, |node| motion.velocity_at(node, layout, x));
        let mut at = |at: [f64; D], share: f64| {
            let functions = boundary.shape(facet, &at);
            let area = moved.area(&functions);
            let pressure = stress.closed_pressure(facet, &moved.place(&functions), x);
            let mut shape = [0.0; MAX_FACET_NODES];
            shape.copy_from_slice(&functions.values[..MAX_FACET_NODES]);
            visit(&ClosedPoint {
                force: area.vector * -(share * pressure),
                n_nodes: moved.n_nodes,
                shape,
                by_velocity: area.by_velocity.map(|derivative| derivative * -(share * pressure)),
                by_pressure: stress.rim_pressures(facet).map(|(_, of_rim)| area.vector * -(share * of_rim)).collect(),
            });
        };
        for (local, weight) in self.rule.points().iter().zip(self.rule.weights()) {
            at(std::array::from_fn(|k| local[k]), *weight);
            for piece in stress.pieces_of(facet) {
                let of_vertex = |k: usize| (0..D).map(|corner| local[corner] * piece.barycentric[corner][k]).sum();
                at(std::array::from_fn(of_vertex), -weight * piece.measure / whole);
            }
        }
    }
}
