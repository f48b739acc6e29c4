//! Stress of a solid on its surface.

use algebra::{DofId, Sites};
use body::{ByDof, SurfaceStress};
use mesh::{CellId, FacetId, Tensor, Vector, VertexId, det};

use crate::kinematics::deformation_gradient;
use crate::{Material, SolidCell, SolidCells};

/// Traction of the cell behind a facet, `P N / (|F|/|F̂|) = σ n`: nominal stress over the current measure of the facet.
///
/// It is constant on a facet. The displacement is that of the stage of the step.
pub struct SolidStress<'a, const D: usize> {
    /// The cells of the body.
    pub cells: SolidCells<'a, D>,
    /// The material.
    pub material: &'a dyn Material<D>,
}

impl<const D: usize> SolidStress<'_, D> {
    fn cell(&self, facet: FacetId) -> Option<CellId> {
        self.cells.solid.boundary().facet_to_cell(facet)
    }

    /// Computes the traction by Nanson's formula, `σ n = P N / |J F⁻ᵀ N|`, and its derivatives with respect to the
    /// velocities of the vertices of the cell.
    fn traction(
        &self,
        vertices: &[VertexId],
        cell: &SolidCell<'_, D>,
        normal: &Vector<D>,
        derivatives: &mut ByDof<D>,
    ) -> Vector<D> {
        let f = deformation_gradient(&cell.grad_displacement());
        let Some(inverse) = f.try_inverse() else { return Vector::zeros() };
        // a = J F⁻ᵀ N: current area vector per reference area; da = (tr(H F⁻¹) I - (H F⁻¹)ᵀ) a.
        let area = inverse.transpose() * normal * det(&f);
        let ratio = area.norm();
        let nominal = self.material.first_piola(&f) * normal;
        let traction = nominal / ratio;
        for (node, vertex) in vertices.iter().enumerate() {
            for (b, dof) in self.cells.layout.node(self.cells.velocity, vertex.index()).enumerate() {
                let mut h = Tensor::<D>::zeros();
                h.set_row(b, &(cell.gradients[node] * cell.displacement_slope).transpose());
                let h_inverse = h * inverse;
                let d_area = area * h_inverse.trace() - h_inverse.transpose() * area;
                let d_ratio = area.dot(&d_area) / ratio;
                let d_nominal = self.material.first_piola_derivative(&f, &h) * normal;
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
        let Some(cell) = self.cell(facet) else { return Vector::zeros() };
        let solid = self.cells.solid;
        let normal = solid.placed(solid.mesh().vertices()).facet_normal(facet);
        let (vertices, mut traction) = (solid.mesh().cell(cell), Vector::zeros());
        self.cells.visit(cell.index(), x, |site| traction = self.traction(vertices, site, &normal, derivatives));
        traction
    }

    /// Returns `θ Δt n·C(n ⊗ n) n |∂K|/|K|`, with the stiffness `C` of the reference state and the facets `∂K` of the cell that lie on the
    /// surface. For isotropic materials `n·C(n ⊗ n) n = 2 μ + λ` is the largest eigenvalue of the acoustic tensor of the direction n.
    fn trace_bound(&self, facet: FacetId) -> f64 {
        let Some(cell) = self.cell(facet) else { return 0.0 };
        let (solid, mesh) = (self.cells.solid, self.cells.solid.mesh());
        let normal = solid.placed(mesh.vertices()).facet_normal(facet);
        let along = normal * normal.transpose();
        let stiffness = normal.dot(&(self.material.first_piola_derivative(&Tensor::identity(), &along) * normal));
        let on_surface = mesh.cell_to_facet(cell).iter().filter(|facet| mesh.is_boundary(**facet));
        let measure: f64 = on_surface.map(|facet| mesh.facet_measure(*facet)).sum();
        self.cells.rule.displacement.slope * stiffness * measure / solid.volume(cell)
    }
}
