//! Stress of a solid on its surface.

use std::sync::Arc;

use algebra::{DofId, Sites};
use body::{ByDof, SurfaceStress};
use mesh::{CellId, FacetId, Tensor, Vector, det};

use crate::{Material, SolidCells};

/// Traction of the cell behind a facet, `P N / (|F|/|F̂|) = σ n`: nominal stress over the current measure of the facet.
///
/// It is that of the middle of the facet, so constant on it. The displacement is that of the stage of the step.
pub struct SolidStress<'a, const D: usize> {
    /// The cells of the body.
    pub cells: SolidCells<'a, D>,
    /// The material of each group of cells.
    pub materials: &'a [Arc<dyn Material<D>>],
}

impl<const D: usize> SolidStress<'_, D> {
    fn cell(&self, facet: FacetId) -> Option<CellId> {
        self.cells.solid.boundary().facet_to_cell(facet)
    }

    /// Computes the traction by Nanson's formula, `σ n = P N / |J F⁻ᵀ N|`, and its derivatives with respect to the
    /// velocities of the nodes of the cell.
    fn traction(&self, facet: FacetId, cell: CellId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let SolidCells { solid, rule, layout, velocity } = self.cells;
        let (nodes, point) = (solid.cell(cell), solid.surface_point(facet));
        let displacement = self.cells.at_nodes(&rule.displacement, nodes, x);
        let deformation = point.deformation(&displacement[..nodes.len()]);
        let f = deformation.gradient;
        let Some(inverse) = f.try_inverse() else { return Vector::zeros() };
        // a = J F⁻ᵀ N: current area vector per reference area; da = (tr(H F⁻¹) I - (H F⁻¹)ᵀ) a.
        let normal = solid.placed(solid.nodes()).facet_normal(facet);
        // In axisymmetric coordinates circles are stretched too.
        let stretch = deformation.hoop.unwrap_or(1.0);
        let area = inverse.transpose() * normal * (det(&f) * stretch);
        let ratio = area.norm();
        let material = self.materials[solid.group(cell)].as_ref();
        let nominal = deformation.first_piola(material) * normal;
        let traction = nominal / ratio;
        for (k, (node, g)) in nodes.iter().zip(point.gradients).enumerate() {
            for (b, dof) in layout.node(velocity, node.index()).enumerate() {
                let mut h = Tensor::<D>::zeros();
                h.set_row(b, &(g * rule.displacement.slope).transpose());
                let of_circles = point.hoop.filter(|(radial, _)| b == *radial);
                let d_stretch = of_circles.map_or(0.0, |(_, shapes)| shapes[k] * rule.displacement.slope);
                let h_inverse = h * inverse;
                let d_area = area * (h_inverse.trace() + d_stretch / stretch) - h_inverse.transpose() * area;
                let d_ratio = area.dot(&d_area) / ratio;
                let d_nominal = deformation.first_piola_derivative(material, &h, d_stretch) * normal;
                derivatives.push((dof, (d_nominal - traction * d_ratio) / ratio));
            }
        }
        traction
    }
}

impl<const D: usize> SurfaceStress<D> for SolidStress<'_, D> {
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>) {
        if let Some(cell) = self.cell(facet) {
            self.cells.dofs(cell.index(), out);
        }
    }

    fn at(&self, facet: FacetId, _: &[f64], x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        derivatives.clear();
        self.cell(facet).map_or_else(Vector::zeros, |cell| self.traction(facet, cell, x, derivatives))
    }

    /// Returns `θ Δt p (p - 1 + D)/D n·C(n ⊗ n) n |∂K|/|K|`, with the order `p`, the stiffness `C` of the reference state and the facets `∂K` of the cell
    /// that lie on the surface. For isotropic materials `n·C(n ⊗ n) n = 2 μ + λ` is the largest eigenvalue of the acoustic tensor of the direction n.
    ///
    /// The factor is that of polynomials of degree `q = p - 1`, which the gradients are: `∫_F |y|² <= (q + 1)(q + D)/D |F|/|K| ∫_K |y|²` for a
    /// facet F. The squares of values in the middles of the parts of a facet sum to less than the integral. On a cell with curved edges the bound
    /// holds up to the variation of its Jacobian.
    ///
    /// Source: Warburton, Hesthaven 2003, On the constants in hp-finite element trace inverse inequalities, Comput. Methods Appl. Mech. Eng. 192,
    /// doi:10.1016/S0045-7825(03)00294-9, Theorem 5.
    fn trace_bound(&self, facet: FacetId) -> f64 {
        let Some(cell) = self.cell(facet) else { return 0.0 };
        let solid = self.cells.solid;
        let normal = solid.placed(solid.nodes()).facet_normal(facet);
        let along = normal * normal.transpose();
        let material = &self.materials[solid.group(cell)];
        let stiffness = normal.dot(&(material.first_piola_derivative(&Tensor::identity(), &along) * normal));
        let p = solid.order().degree();
        let factor = (p * (p - 1 + D)) as f64 / D as f64;
        let trace = factor * solid.surface_measure(cell) / solid.volume(cell);
        self.cells.rule.displacement.slope * stiffness * trace
    }
}
