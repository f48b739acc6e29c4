//! What turns the forms of this library into those of the published comparison, for comparing errors only.

use std::collections::HashMap;

use algebra::{Constraints, Contributions, DofId, LocalSystem};
use cutcell::PartId;
use fluid_ns::FluidFields;
use mesh::{MAX_CELL_VERTICES, Point, SimplexRule, Tensor, Vector};

use crate::unfitted_stokes::{UnfittedStokes, VISCOSITY, velocity};

/// `-μ (∇uᵀ, ∇v)_Ω + μ (∇uᵀ n^f, v)_Σ + μ (u - g, ∇vᵀ n^f)_Σ`: with it the viscous form `2 μ (D(u), ∇v)` becomes
/// `μ (∇u, ∇v)`, and the traction on the ball `μ ∇u n - p n`. One item per part, then one per interface piece.
pub(crate) struct TransposedGradient<'a, const D: usize> {
    pub(crate) stokes: &'a UnfittedStokes<D>,
    pub(crate) fields: FluidFields<'a>,
}

impl<const D: usize> TransposedGradient<'_, D> {
    fn part(&self, item: usize) -> PartId {
        let n_parts = self.stokes.cut.n_parts();
        if item < n_parts { PartId(item as u32) } else { self.stokes.cut.interface()[item - n_parts].part }
    }
}

impl<const D: usize> Contributions for TransposedGradient<'_, D> {
    fn name(&self) -> &'static str {
        "transposed gradient"
    }

    fn len(&self) -> usize {
        self.stokes.cut.n_parts() + self.stokes.cut.interface().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        for &dof in self.stokes.space.dofs(self.part(item)) {
            out.extend((0..D).map(|a| self.fields.layout.dof(self.fields.velocity, D * dof as usize + a)));
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let part = self.part(item);
        let g = self.stokes.parts.gradients(part);
        let dofs = self.stokes.space.dofs(part);
        let mut u = [Vector::<D>::zeros(); MAX_CELL_VERTICES];
        u.iter_mut().zip(dofs).for_each(|(u, &dof)| *u = self.fields.velocity_at(x, dof));
        let grad_u: Tensor<D> = u.iter().zip(g).map(|(u, g)| u * g.transpose()).sum();
        let n_parts = self.stokes.cut.n_parts();
        let Some(piece) = item.checked_sub(n_parts) else {
            let weight = -VISCOSITY * self.stokes.parts.points(part).iter().map(|q| q.weight).sum::<f64>();
            for i in 0..=D {
                out.add_vector(D * i, (grad_u.transpose() * g[i] * weight).as_slice());
                for j in 0..=D {
                    out.add_block(D * i, D * j, D, (g[j] * g[i].transpose() * weight).as_slice());
                }
            }
            return;
        };
        let n = -self.stokes.cut.interface()[piece].normal;
        for q in self.stokes.pieces.points(piece) {
            let weight = VISCOSITY * q.weight;
            let jump = u.iter().zip(&q.fluid).map(|(u, n)| u * *n).sum::<Vector<D>>() - velocity(&q.point, 0.0);
            for i in 0..=D {
                let force = grad_u.transpose() * n * q.fluid[i] + n * g[i].dot(&jump);
                out.add_vector(D * i, (force * weight).as_slice());
                for j in 0..=D {
                    let k = g[j] * n.transpose() * q.fluid[i] + n * g[i].transpose() * q.fluid[j];
                    out.add_block(D * i, D * j, D, (k * weight).as_slice());
                }
            }
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Velocities on the sides of a square as the other code sets them: the L2 projection on each edge, and the mean of both
/// edges at each vertex. Dofs that are not constrained stay so.
pub(crate) fn project_sides(stokes: &mut UnfittedStokes<2>) {
    let rule = SimplexRule::of_degree(1, 4);
    let mut at_vertex: HashMap<u32, (Vector<2>, f64)> = HashMap::new();
    for facet in stokes.background.facets().filter(|&facet| stokes.background.is_boundary(facet)) {
        let ends = stokes.background.facet(facet);
        let corners: Vec<Point<2>> = ends.iter().map(|&v| stokes.background.vertex(v)).collect();
        for (k, end) in ends.iter().enumerate() {
            let (sum, n) = at_vertex.entry(end.0).or_insert((Vector::zeros(), 0.0));
            *n += 1.0;
            for (l, weight) in rule.points().iter().zip(rule.weights()) {
                let u = velocity(&(corners[0] * l[0] + corners[1] * l[1]), 0.0);
                // The dual basis of the two shape functions on an edge of unit length.
                *sum += u * (weight * (6.0 * l[k] - 2.0));
            }
        }
    }
    let of_dof = |dof: usize| stokes.space.vertex((dof / 2) as u32).0;
    let mut projected = Constraints::new();
    for (dof, _) in stokes.constraints.iter() {
        let (sum, n) = at_vertex[&of_dof(dof.index())];
        projected.set(dof, sum[dof.index() % 2] / n);
    }
    stokes.constraints = projected;
}
