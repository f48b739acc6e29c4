//! The linear cell terms and convection of one part, fused and in closed form.
//!
//! On a part the gradients `g_i = ∇N_i` are constant, so all integrals follow from `m_ij = ∫ N_i N_j`, its row sums
//! `m_i = ∫ N_i` and their sum `V`, without a loop over quadrature points. With `r = ρ/dt`, `G = ∇u` and `P = ∫ p`:
//!
//! ```text
//! linear      velocity i     μ V (G + Gᵀ) g_i - P g_i + r Σ_j m_ij (u_j - u*_j)
//!             pressure i     m_i tr G
//!             tangent        u_i u_j: (μ V g_i·g_j + r m_ij) I + μ V g_j ⊗ g_i,   u_i p_j: -m_j g_i,   p_i u_j: m_i g_jᵀ
//! convection  velocity i     ρ (G + s I) w_i,   w_i = Σ_j m_ij u_j,   s = tr G/2 with the skew part, else 0
//!             tangent        ρ ( m_ij (G + s I) + (w_i·g_j) I + ½ w_i ⊗ g_j ), the last one with the skew part only
//! ```
//!
//! The named terms in `terms/` say the same one by one; a test compares the sums. The body force is any function, and
//! stays a term.

use algebra::LocalSystem;
use mesh::{MAX_CELL_VERTICES, Tensor, Vector};
use xfem_space::PartMass;

use crate::terms::Convection;
use crate::{FluidCell, FluidForm};

/// A part with its velocities; local unknowns are those of [`FluidCell`].
pub(crate) struct PartKernel<'a, const D: usize> {
    gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    velocities: &'a [Vector<D>; MAX_CELL_VERTICES],
    mass: [[f64; MAX_CELL_VERTICES]; MAX_CELL_VERTICES],
}

impl<'a, const D: usize> PartKernel<'a, D> {
    pub(crate) fn new(
        gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
        mass: &PartMass,
        velocities: &'a [Vector<D>; MAX_CELL_VERTICES],
    ) -> Self {
        let mut kernel = Self { gradients, velocities, mass: [[0.0; MAX_CELL_VERTICES]; MAX_CELL_VERTICES] };
        for i in 0..=D {
            (0..=D).for_each(|j| kernel.mass[i][j] = mass.at(i, j));
        }
        kernel
    }

    fn grad_u(&self) -> Tensor<D> {
        (0..=D).map(|i| self.velocities[i] * self.gradients[i].transpose()).sum()
    }

    /// `Σ_j m_ij v_j`
    fn weighted(&self, i: usize, values: &[Vector<D>; MAX_CELL_VERTICES]) -> Vector<D> {
        (0..=D).map(|j| values[j] * self.mass[i][j]).sum()
    }

    /// Inertia, viscous work and incompressibility of the part that `cell` is, too.
    pub(crate) fn add_linear(&self, form: &FluidForm<'_, D>, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let g = self.gradients;
        let rate = form.inertia.as_ref().map_or(0.0, |inertia| inertia.density / inertia.dt);
        let moments = self.mass.map(|row| row.iter().sum::<f64>());
        let viscosity = form.viscous.viscosity * moments.iter().sum::<f64>();
        let pressure: f64 = cell.pressures.iter().zip(&moments).map(|(p, m)| p * m).sum();

        let grad_u = self.grad_u();
        let stress = (grad_u + grad_u.transpose()) * viscosity - Tensor::identity() * pressure;
        let mut change = *self.velocities;
        (0..=D).for_each(|j| change[j] -= cell.histories[j]);
        for i in 0..=D {
            out.add_vector(cell.velocity(i), (stress * g[i] + self.weighted(i, &change) * rate).as_slice());
            out.add(cell.pressure(i), moments[i] * grad_u.trace());
        }
        if !out.wants_tangent() {
            return;
        }
        for j in 0..=D {
            let mut diagonal = [0.0; MAX_CELL_VERTICES];
            (0..=D).for_each(|i| diagonal[i] = viscosity * g[i].dot(&g[j]) + rate * self.mass[i][j]);
            for b in 0..D {
                let rows = &mut out.column_mut(D * j + b)[..(D + 1) * (D + 1)];
                for i in 0..=D {
                    let along = viscosity * g[i][b];
                    (0..D).for_each(|a| rows[D * i + a] += along * g[j][a]);
                    rows[D * i + b] += diagonal[i];
                    rows[D * (D + 1) + i] += moments[i] * g[j][b];
                }
            }
            let rows = &mut out.column_mut(D * (D + 1) + j)[..D * (D + 1)];
            for i in 0..=D {
                (0..D).for_each(|a| rows[D * i + a] -= moments[j] * g[i][a]);
            }
        }
    }

    /// Convection.
    pub(crate) fn add_convection(&self, convection: &Convection, out: &mut LocalSystem) {
        let grad_u = self.grad_u();
        let skew = if convection.skew { 0.5 } else { 0.0 };
        let transport = (grad_u + Tensor::identity() * (skew * grad_u.trace())) * convection.density;
        let mut weighted = [Vector::zeros(); MAX_CELL_VERTICES];
        for (i, weighted) in weighted.iter_mut().enumerate().take(D + 1) {
            *weighted = self.weighted(i, self.velocities);
            out.add_vector(D * i, (transport * *weighted).as_slice());
            *weighted *= convection.density;
        }
        if !out.wants_tangent() {
            return;
        }
        for (j, g_j) in self.gradients.iter().enumerate().take(D + 1) {
            let mut diagonal = [0.0; MAX_CELL_VERTICES];
            (0..=D).for_each(|i| diagonal[i] = weighted[i].dot(g_j));
            for b in 0..D {
                let rows = &mut out.column_mut(D * j + b)[..D * (D + 1)];
                let half = skew * g_j[b];
                for i in 0..=D {
                    (0..D).for_each(|a| {
                        rows[D * i + a] += self.mass[i][j] * transport[(a, b)] + half * weighted[i][a];
                    });
                    rows[D * i + b] += diagonal[i];
                }
            }
        }
    }
}
