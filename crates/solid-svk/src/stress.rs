//! Stress of a solid on its surface.

use std::sync::Arc;

use algebra::{DofId, Sites};
use body::{ByDof, SurfaceStress};
use mesh::{CellId, FacetId, Point, Tensor, Vector, VertexId};

use crate::{MAX_CELL_NODES, Material, SolidCells};

/// Traction of the cell behind a facet, `P N |F̂|/|F|`: the nominal traction `P N`, converted from the measure `|F̂|`
/// of the facet in the reference state to its measure `|F|` at given positions. At the current positions it is `σ n`.
///
/// The traction is evaluated in the middle of the facet with the displacement at the stage of the step, and is constant
/// on the facet. Its integral over the facet at `positions` is the force in the weak form of the solid, however
/// the facet grows in the step.
pub struct SolidStress<'a, const D: usize> {
    /// The cells of the body.
    pub cells: SolidCells<'a, D>,
    /// The material of each group of cells.
    pub materials: &'a [Arc<dyn Material<D>>],
    /// Positions of the nodes at which integrals over the surface are evaluated.
    pub positions: &'a [Point<D>],
}

/// Orders by which the constant of the trace inequality is raised for integrals with the weight of a radius.
const ORDERS_OF_WEIGHT: usize = 2;

/// Returns `p (p - 1 + D)/D`, the constant of the trace inequality of polynomials of degree `p - 1`.
fn trace_constant<const D: usize>(p: usize) -> f64 {
    (p * (p - 1 + D)) as f64 / D as f64
}

impl<const D: usize> SolidStress<'_, D> {
    fn cell(&self, facet: FacetId) -> Option<CellId> {
        self.cells.solid.boundary().facet_to_cell(facet)
    }

    /// Computes the traction and its derivatives with respect to the velocities of the nodes of the cell.
    fn traction(&self, facet: FacetId, cell: CellId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let SolidCells { solid, rule, layout, velocity } = self.cells;
        let (nodes, point) = (solid.cell(cell), solid.surface_point(facet));
        let mut displacement = [Vector::zeros(); MAX_CELL_NODES];
        self.cells.set_at_nodes(&rule.displacement, nodes, x, &mut displacement);
        let deformation = point.deformation(&displacement[..nodes.len()]);
        let normal = solid.placed(solid.nodes()).facet_normal(facet);
        let measure = |positions| solid.placed(positions).weighted_measure(facet);
        let at_positions = measure(self.positions);
        // A facet on the axis of axisymmetric coordinates has no area.
        let ratio = if at_positions > 0.0 { measure(solid.nodes()) / at_positions } else { 0.0 };
        let material = self.materials[solid.group(cell)].as_ref();
        for (k, (node, g)) in nodes.iter().zip(point.gradients).enumerate() {
            for (b, dof) in layout.node(velocity, node.index()).enumerate() {
                let mut h = Tensor::<D>::zeros();
                h.set_row(b, &(g * rule.displacement.slope).transpose());
                // In axisymmetric coordinates a radial displacement changes the hoop stretch.
                let of_circles = point.hoop.filter(|(radial, _)| b == *radial);
                let d_stretch = of_circles.map_or(0.0, |(_, shapes)| shapes[k] * rule.displacement.slope);
                derivatives.push((dof, deformation.first_piola_derivative(material, &h, d_stretch) * normal * ratio));
            }
        }
        deformation.first_piola(material) * normal * ratio
    }

    /// Returns the stiffness `n·C(n ⊗ n) n` of the reference state along the normal of a facet, `2 μ + λ` in isotropic
    /// materials.
    fn stiffness_along_normal(&self, facet: FacetId, cell: CellId) -> f64 {
        let solid = self.cells.solid;
        let normal = solid.placed(solid.nodes()).facet_normal(facet);
        let along = normal * normal.transpose();
        let material = &self.materials[solid.group(cell)];
        normal.dot(&(material.first_piola_derivative(&Tensor::identity(), &along) * normal))
    }

    /// Returns `p (p - 1 + D)/D` for the order `p`: the constant of the trace inequality of polynomials of degree
    /// `p - 1`.
    fn trace_factor(&self) -> f64 {
        trace_constant::<D>(self.cells.solid.order().degree())
    }
}

impl<const D: usize> SurfaceStress<D> for SolidStress<'_, D> {
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>) {
        if let Some(cell) = self.cell(facet) {
            self.cells.dofs(cell.index(), out);
        }
    }

    fn on(&self, facet: FacetId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        derivatives.clear();
        self.cell(facet).map_or_else(Vector::zeros, |cell| self.traction(facet, cell, x, derivatives))
    }

    /// Returns `c_d p (p - 1 + D)/D n·C(n ⊗ n) n |∂K|/|K|`, with the derivative `c_d` of the displacement at the stage
    /// with respect to the velocity, `Δt` with implicit Euler, the order `p`, the stiffness `C` of the reference state
    /// and the facets `∂K` of the cell on the surface. For isotropic materials `n·C(n ⊗ n) n = 2 μ + λ` is the largest
    /// eigenvalue of the acoustic tensor of the direction n.
    ///
    /// The factor is that of polynomials of degree `q = p - 1`, the degree of the gradients:
    /// `∫_F |y|² <= (q + 1)(q + D)/D |F|/|K| ∫_K |y|²` for a facet F. The sum of the squares in the middles of the
    /// parts of a facet is less than the integral. With rotational symmetry the integrals have the weight `2 π r`, and
    /// the constant is that of two more orders: 6 and 10 for orders 1 and 2, where the largest one of order 2 over
    /// triangles of any radii is 7.6. On a cell with curved edges the bound holds up to the variation of its Jacobian.
    ///
    /// Source: Warburton, Hesthaven 2003, On the constants in hp-finite element trace inverse inequalities, Comput.
    /// Methods Appl. Mech. Eng. 192, doi:10.1016/S0045-7825(03)00294-9, Theorem 5.
    fn trace_bound(&self, facet: FacetId) -> f64 {
        let Some(cell) = self.cell(facet) else { return 0.0 };
        let solid = self.cells.solid;
        let volume: f64 = solid.points(cell).map(|point| point.weight).sum();
        let is_weighted = solid.boundary().coordinates().radial().is_some();
        let p = solid.order().degree() + if is_weighted { ORDERS_OF_WEIGHT } else { 0 };
        let trace = trace_constant::<D>(p) * solid.surface_measure(cell) / volume;
        self.cells.rule.displacement.slope * self.stiffness_along_normal(facet, cell) * trace
    }

    /// Returns `p (p - 1 + D)/D n·C(n ⊗ n) n/h` with the order `p` and the height `h` of the cell over the facet;
    /// `(2 μ + λ)/h` for linear elements of an isotropic material.
    fn stiffness(&self, facet: FacetId) -> f64 {
        let Some(cell) = self.cell(facet) else { return 0.0 };
        let solid = self.cells.solid;
        let surface = solid.placed(solid.nodes());
        let (corner, normal) = (surface.facet_points(facet)[0], surface.facet_normal(facet));
        let behind = |node: &VertexId| (corner - solid.nodes()[node.index()]).dot(&normal);
        let height = solid.cell(cell).iter().map(behind).fold(0.0, f64::max);
        self.trace_factor() * self.stiffness_along_normal(facet, cell) / height
    }
}
