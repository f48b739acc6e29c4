//! Loads on boundary facets of a body.

use algebra::{DofId, Sites};
use mesh::{FacetId, MAX_CELL_NODES, Point, ShapeFunctions, Vector, simplex_measure};

use crate::SolidCells;

/// A point on the boundary at the stage of the step, with the shape functions of the element's facet.
///
/// Component `a` of the velocity of node `i` of that facet is local row `D i + a`.
#[derive(Clone, Copy, Debug)]
pub struct SolidFacet<const D: usize> {
    /// Number of nodes.
    pub n_nodes: usize,
    /// Shape functions of the nodes.
    pub shape: ShapeFunctions,
    /// Position `X` in the reference configuration.
    pub reference: Point<D>,
    /// Quadrature weight times the reference area element (2D: length) times [`mesh::Coordinates::weight`] at `X`.
    pub reference_weight: f64,
    /// Quadrature weight in local coordinates times [`mesh::Coordinates::weight`] at the position `x`.
    pub weight: f64,
    /// Derivative of `weight` with respect to the position `x`.
    pub weight_gradient: Vector<D>,
    /// Derivatives of the position `x = X + d` with respect to the local coordinates; only the first `D - 1` are used.
    pub tangents: [Vector<D>; 2],
    /// `c_d`: derivative of displacement with respect to velocity.
    pub displacement_slope: f64,
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> SolidFacet<D> {
    /// Returns the local nodes.
    #[inline]
    pub fn nodes(&self) -> std::ops::Range<usize> {
        0..self.n_nodes
    }
}

/// Facets of the boundary of a body in one step: one item per facet, several sites.
///
/// A linear facet that is a part of a quadratic facet is integrated with the shape functions of the quadratic facet.
#[derive(Clone, Copy)]
pub struct SolidFacets<'a, const D: usize> {
    /// The cells of the body.
    pub cells: SolidCells<'a, D>,
    /// The facets.
    pub facets: &'a [FacetId],
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> Sites for SolidFacets<'_, D> {
    type Site = SolidFacet<D>;

    fn len(&self) -> usize {
        self.facets.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.cells.dofs_of(self.cells.solid.boundary().nodes(self.facets[item]), out);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let SolidCells { solid, rule, .. } = self.cells;
        let coordinates = solid.mesh().coordinates();
        let nodes = solid.boundary().nodes(self.facets[item]);
        let mut displacement = [Vector::zeros(); MAX_CELL_NODES];
        self.cells.set_at_nodes(&rule.displacement, nodes, x, &mut displacement);
        let mut reference = [Point::zeros(); MAX_CELL_NODES];
        reference.iter_mut().zip(nodes).for_each(|(slot, node)| *slot = solid.nodes()[node.index()]);
        let reference = &reference[..nodes.len()];
        for &(weight, shape) in &solid.facet_points(self.facets[item]).points {
            // The simplex at the origin with the tangents as edges.
            let mut edges = [Vector::zeros(); 3];
            (1..D).for_each(|k| edges[k] = shape.along(k - 1, reference));
            let parallelepiped = simplex_measure(&edges[..D]) * (1..D).product::<usize>() as f64;
            let moved = |k: usize| edges[k + 1] + shape.along(k, &displacement[..nodes.len()]);
            let at_rest = shape.at(reference);
            visit(&SolidFacet {
                n_nodes: nodes.len(),
                shape,
                reference: at_rest,
                reference_weight: weight * parallelepiped * coordinates.weight(&at_rest),
                weight: weight * coordinates.weight(&(at_rest + shape.at(&displacement[..nodes.len()]))),
                weight_gradient: coordinates.weight_gradient() * weight,
                tangents: [moved(0), moved(1)],
                displacement_slope: rule.displacement.slope,
                time: self.time,
            });
        }
    }
}
