//! The Saint Venant-Kirchhoff material: Hooke's law between Green-Lagrange strain and second Piola stress.

use mesh::{Tensor, Vector, det};

use super::{LameParameters, Material, MaterialInSpace};
use crate::MAX_CELL_NODES;
use crate::kinematics::{green_lagrange, green_lagrange_derivative};

/// `W = μ E:E + λ/2 (tr E)²`, `S = 2 μ E + λ (tr E) I`, `P = F S`, in 2D in plane strain.
///
/// Source: paper, Sec. 4.1, where the law is that of the second Piola stress (the first in Sec. 2.1).
/// Units: `W`, `S`, `P`, `μ` and `λ` force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff {
    /// Lame parameters.
    pub lame: LameParameters,
}

impl SaintVenantKirchhoff {
    /// Creates the material with the given parameters.
    pub fn new(lame: LameParameters) -> Self {
        Self { lame }
    }

    /// Returns `2 μ E + λ (tr E) I`, linear in `E`.
    #[inline]
    fn hooke<const D: usize>(&self, e: &Tensor<D>) -> Tensor<D> {
        2.0 * self.lame.mu * e + Tensor::identity() * (self.lame.lambda * e.trace())
    }
}

impl<const D: usize> Material<D> for SaintVenantKirchhoff {
    fn in_space(&self) -> &MaterialInSpace {
        self
    }

    #[inline]
    fn energy_density(&self, f: &Tensor<D>) -> f64 {
        let e = green_lagrange(f);
        self.lame.mu * e.norm_squared() + 0.5 * self.lame.lambda * e.trace().powi(2)
    }

    #[inline]
    fn first_piola(&self, f: &Tensor<D>) -> Tensor<D> {
        f * self.hooke(&green_lagrange(f))
    }

    /// Returns `H S + F dS`, `dS = 2 μ dE + λ (tr dE) I`, `dE = (FᵀH + HᵀF)/2`.
    #[inline]
    fn first_piola_derivative(&self, f: &Tensor<D>, h: &Tensor<D>) -> Tensor<D> {
        h * self.hooke(&green_lagrange(f)) + f * self.hooke(&green_lagrange_derivative(f, h))
    }

    /// Computes `K_ij = λ G_i ⊗ G_j + μ G_j ⊗ G_i + (g_i·g_j) μ F Fᵀ + (g_i·S g_j) I` with `G = F g`.
    #[inline]
    fn for_each_stiffness(&self, f: &Tensor<D>, g: &[Vector<D>], visit: &mut dyn FnMut(usize, usize, &Tensor<D>)) {
        let LameParameters { mu, lambda } = self.lame;
        let stress = self.hooke(&green_lagrange(f));
        let left = f * f.transpose() * mu;
        let mut pushed = [Vector::zeros(); MAX_CELL_NODES];
        pushed.iter_mut().zip(g).for_each(|(pushed, g)| *pushed = f * g);
        for i in 0..g.len() {
            let traction = stress * g[i];
            for j in 0..=i {
                let (with_lambda, with_mu) = (pushed[i] * pushed[j].transpose(), pushed[j] * pushed[i].transpose());
                let mut block = with_lambda * lambda + with_mu * mu + left * g[i].dot(&g[j]);
                let geometric = traction.dot(&g[j]);
                (0..D).for_each(|a| block[(a, a)] += geometric);
                visit(i, j, &block);
            }
        }
    }

    /// Returns `S_zz / J = λ (tr E) / J`, as `E_zz = 0` and `F_zz = 1`.
    #[inline]
    fn out_of_plane_stress(&self, f: &Tensor<D>) -> f64 {
        self.lame.lambda * green_lagrange(f).trace() / det(f)
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_material;
    use super::*;
    use crate::kinematics::cauchy_stress;

    fn ball() -> SaintVenantKirchhoff {
        SaintVenantKirchhoff::new(LameParameters::new(2e6, 8e6).unwrap())
    }

    fn is_a_material<const D: usize>() {
        let check = check_material::<D>(&ball(), 20);
        assert!(check.largest() < 1e-8, "{check:?}");
        assert!(check.objectivity < 1e-12 && check.reference_stress < 1e-14, "{check:?}");
    }

    #[test]
    fn is_a_material_in_2d_and_3d() {
        is_a_material::<2>();
        is_a_material::<3>();
    }

    fn close(computed: f64, printed: f64) {
        // Seven digits are printed.
        assert!((computed - printed).abs() < 1e-6 * printed.abs(), "{computed:e} {printed:e}");
    }

    #[test]
    fn plane_strain_uniaxial_states() {
        // Stretch l, lateral stretch √(1 - ν/(1 - ν) (l² - 1)), P11 = E/(1 - ν²) l (l² - 1)/2, Cauchy stress.
        for [l1, l2, p11, sigma11] in [
            [0.8, 1.113553, -9.6e5, -8.621054e5],
            [0.9, 1.061446, -5.7e5, -5.370035e5],
            [1.05, 0.965229, 3.5875e5, 3.716735e5],
            [1.1, 0.927362, 7.7e5, 8.303124e5],
            [1.2, 0.840635, 1.76e6, 2.093656e6],
        ] {
            let exact = (1.0 - 2.0 / 3.0 * (l1 * l1 - 1.0_f64)).sqrt();
            close(exact, l2);
            let f = Tensor::<2>::new(l1, 0.0, 0.0, exact);
            let p = ball().first_piola(&f);
            close(p[(0, 0)], p11);
            assert!(p[(1, 1)].abs() < 1e-7 && p[(0, 1)] == 0.0);
            close(cauchy_stress(&f, &p)[(0, 0)], sigma11);
        }
    }

    #[test]
    fn uniaxial_and_confined_states_in_3d() {
        // Stretch l, lateral stretch √(1 - ν (l² - 1)), P11 = E l (l² - 1)/2, Cauchy stress, and without lateral
        // strain P11 = (λ + 2 μ) l (l² - 1)/2.
        for [l1, l2, p11, sigma11, confined] in [
            [0.8, 1.069579, -8.064e5, -7.048951e5, -1.728e6],
            [0.9, 1.037304, -4.788e5, -4.449814e5, -1.026e6],
            [1.05, 0.979285, 3.0135e5, 3.142336e5, 6.4575e5],
            [1.1, 0.957079, 6.468e5, 7.061135e5, 1.386e6],
            [1.2, 0.907744, 1.4784e6, 1.794175e6, 3.168e6],
        ] {
            let exact = (1.0 - 0.4 * (l1 * l1 - 1.0_f64)).sqrt();
            close(exact, l2);
            let f = Tensor::<3>::from_diagonal(&mesh::Vector::<3>::new(l1, exact, exact));
            let p = ball().first_piola(&f);
            close(p[(0, 0)], p11);
            assert!(p[(1, 1)].abs() < 1e-7 && p[(2, 2)].abs() < 1e-7);
            close(cauchy_stress(&f, &p)[(0, 0)], sigma11);
            let f = Tensor::<3>::from_diagonal(&mesh::Vector::<3>::new(l1, 1.0, 1.0));
            close(ball().first_piola(&f)[(0, 0)], confined);
        }
    }

    #[test]
    fn simple_shear() {
        // Shear g: P = [[q, μ g + (λ/2 + μ) g³], [μ g, q]], q = (λ/2 + μ) g².
        let f = Tensor::<2>::new(1.0, 0.1, 0.0, 1.0);
        let p = ball().first_piola(&f);
        assert!((p - Tensor::<2>::new(6e4, 2.06e5, 2e5, 6e4)).norm() < 1e-6);
        let sigma = cauchy_stress(&f, &p);
        assert!((sigma - Tensor::<2>::new(8.06e4, 2.06e5, 2.06e5, 6e4)).norm() < 1e-6);
    }
}
