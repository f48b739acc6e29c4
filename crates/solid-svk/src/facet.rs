//! Loads on boundary facets of a body.

use algebra::{BlockLayout, Contributions, DofId, FieldId, LocalSystem};
use mesh::{FacetId, MAX_CELL_VERTICES, Point, Vector, simplex_measure};

use crate::error::length;
use crate::{Error, SolidMesh, StepRule};

/// A boundary facet with its vertices at the stage of the step.
#[derive(Clone, Copy, Debug)]
pub struct SolidFacet<const D: usize> {
    /// Measure (length, area) in the reference configuration.
    pub reference_measure: f64,
    /// Positions `x = X + d` of the vertices; the first `D` count.
    pub points: [Point<D>; MAX_CELL_VERTICES],
    /// `c_d`: derivative of displacement with respect to velocity.
    pub displacement_per_velocity: f64,
}

impl<const D: usize> SolidFacet<D> {
    /// Local vertices.
    #[inline]
    pub fn nodes(&self) -> std::ops::Range<usize> {
        0..D
    }

    /// First local row of the velocity of a local vertex.
    #[inline]
    pub fn velocity(&self, node: usize) -> usize {
        D * node
    }
}

/// A term of the weak form that lives on boundary facets of a body.
pub trait FacetTerm<const D: usize>: Send + Sync + std::fmt::Debug {
    /// Adds residual and tangent (with respect to velocity) of this term on one facet.
    fn add(&self, facet: &SolidFacet<D>, out: &mut LocalSystem);

    /// Whether the tangent does not depend on the state.
    fn is_linear(&self) -> bool;

    /// Name for timings and reports.
    fn name(&self) -> &'static str;
}

/// One load on a list of boundary facets of a body.
#[derive(Clone, Copy, Debug)]
pub struct SolidFacets<'a, const D: usize> {
    mesh: &'a SolidMesh<D>,
    term: &'a dyn FacetTerm<D>,
    facets: &'a [FacetId],
    step: &'a StepRule<D>,
    first_dof: usize,
}

impl<'a, const D: usize> SolidFacets<'a, D> {
    /// The load `term` on the given facets of the boundary of `mesh`.
    ///
    /// # Errors
    /// [`Error::Length`]: field or step rule do not fit the mesh. [`Error::UnknownFacet`]: no such facet.
    pub fn new(
        mesh: &'a SolidMesh<D>,
        term: &'a dyn FacetTerm<D>,
        facets: &'a [FacetId],
        step: &'a StepRule<D>,
        layout: &BlockLayout,
        field: FieldId,
    ) -> Result<Self, Error> {
        let range = layout.range(field);
        length("field of the body", range.len(), mesh.n_dofs())?;
        length("step rule", step.n_vertices(), mesh.mesh().n_vertices())?;
        let n_facets = mesh.boundary().n_facets();
        if let Some(&facet) = facets.iter().find(|f| f.index() >= n_facets) {
            return Err(Error::UnknownFacet { facet, n_facets });
        }
        Ok(Self { mesh, term, facets, step, first_dof: range.start })
    }
}

impl<const D: usize> Contributions for SolidFacets<'_, D> {
    fn len(&self) -> usize {
        self.facets.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        for vertex in self.mesh.boundary().facet(self.facets[item]) {
            out.extend((0..D).map(|a| DofId::new(self.first_dof + D * vertex.index() + a)));
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let mut points = [Point::zeros(); MAX_CELL_VERTICES];
        let mut reference = points;
        for (k, vertex) in self.mesh.boundary().facet(self.facets[item]).iter().enumerate() {
            let v = Vector::from_column_slice(&x[self.first_dof + D * vertex.index()..][..D]);
            reference[k] = self.mesh.mesh().vertex(*vertex);
            points[k] = reference[k] + self.step.stage().displacement.at(vertex.index(), &v);
        }
        let facet = SolidFacet {
            reference_measure: simplex_measure(&reference[..D]),
            points,
            displacement_per_velocity: self.step.stage().displacement.slope(),
        };
        self.term.add(&facet, out);
    }

    fn is_linear(&self) -> bool {
        self.term.is_linear()
    }

    fn name(&self) -> &'static str {
        self.term.name()
    }
}
