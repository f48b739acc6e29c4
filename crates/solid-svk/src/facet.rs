//! Loads on boundary facets of a body.

use algebra::{DofId, Sites};
use mesh::{FacetId, MAX_CELL_VERTICES, Point, simplex_measure};

use crate::SolidCells;

/// A boundary facet with its vertices at the stage of the step.
///
/// Component `a` of the velocity of vertex `i` is local row `D i + a`.
#[derive(Clone, Copy, Debug)]
pub struct SolidFacet<const D: usize> {
    /// Positions `X` of the vertices in the reference configuration; only the first `D` are used.
    pub reference: [Point<D>; MAX_CELL_VERTICES],
    /// Measure (length, area) in the reference configuration.
    pub reference_measure: f64,
    /// Positions `x = X + d` of the vertices; only the first `D` are used.
    pub points: [Point<D>; MAX_CELL_VERTICES],
    /// `c_d`: derivative of displacement with respect to velocity.
    pub displacement_slope: f64,
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> SolidFacet<D> {
    /// Returns the local vertices.
    #[inline]
    pub fn nodes(&self) -> std::ops::Range<usize> {
        0..D
    }

    /// Returns the first local row of the velocity of a local vertex.
    #[inline]
    pub fn row(&self, node: usize) -> usize {
        D * node
    }
}

/// Facets of the boundary of a body in one step: one item and one site per facet.
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
        self.cells.dofs_of(self.cells.solid.boundary().facet(self.facets[item]), out);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let SolidCells { solid, rule, .. } = self.cells;
        let displacement = &rule.displacement;
        let mut points = [Point::zeros(); MAX_CELL_VERTICES];
        let mut reference = points;
        for (k, vertex) in solid.boundary().facet(self.facets[item]).iter().enumerate() {
            let v = self.cells.velocity_at(*vertex, x);
            reference[k] = solid.mesh().vertex(*vertex);
            points[k] = reference[k] + displacement.at(vertex.index(), v);
        }
        let reference_measure = simplex_measure(&reference[..D]);
        let displacement_slope = displacement.slope;
        visit(&SolidFacet { reference, reference_measure, points, displacement_slope, time: self.time });
    }
}
