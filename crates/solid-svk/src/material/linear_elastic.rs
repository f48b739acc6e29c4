//! Linear elasticity: Hooke's law between infinitesimal strain and stress.

use mesh::{Tensor, Vector, sym};

use super::{LameParameters, Material, MaterialInSpace};

/// `W = μ e:e + λ/2 (tr e)²`, `P = 2 μ e + λ (tr e) I`, with `e = sym(F - I)`, in 2D in plane strain.
///
/// Valid for small displacements and rotations. It is not objective: a rotation by an angle θ causes the strain θ²/2.
///
/// Source: Hooke's law; the Saint Venant-Kirchhoff material to first order in `F - I`.
/// Units: `W`, `P`, `μ` and `λ` force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    /// Lame parameters.
    pub lame: LameParameters,
}

impl LinearElastic {
    /// Creates the material with the given parameters.
    pub fn new(lame: LameParameters) -> Self {
        Self { lame }
    }

    /// Returns `2 μ e + λ (tr e) I` of the symmetric part `e` of a gradient.
    #[inline]
    fn hooke<const D: usize>(&self, gradient: &Tensor<D>) -> Tensor<D> {
        2.0 * self.lame.mu * sym(gradient) + Tensor::identity() * (self.lame.lambda * gradient.trace())
    }
}

impl<const D: usize> Material<D> for LinearElastic {
    fn in_space(&self) -> &MaterialInSpace {
        self
    }

    #[inline]
    fn energy_density(&self, f: &Tensor<D>) -> f64 {
        let e = sym(&(f - Tensor::identity()));
        self.lame.mu * e.norm_squared() + 0.5 * self.lame.lambda * e.trace().powi(2)
    }

    #[inline]
    fn first_piola(&self, f: &Tensor<D>) -> Tensor<D> {
        self.hooke(&(f - Tensor::identity()))
    }

    #[inline]
    fn first_piola_derivative(&self, _f: &Tensor<D>, h: &Tensor<D>) -> Tensor<D> {
        self.hooke(h)
    }

    /// Computes `K_ij = λ g_i ⊗ g_j + μ g_j ⊗ g_i + μ (g_i·g_j) I`.
    #[inline]
    fn for_each_stiffness(&self, _f: &Tensor<D>, g: &[Vector<D>], visit: &mut dyn FnMut(usize, usize, &Tensor<D>)) {
        let LameParameters { mu, lambda } = self.lame;
        for i in 0..g.len() {
            for j in 0..=i {
                let mut block = g[i] * g[j].transpose() * lambda + g[j] * g[i].transpose() * mu;
                let diagonal = mu * g[i].dot(&g[j]);
                (0..D).for_each(|a| block[(a, a)] += diagonal);
                visit(i, j, &block);
            }
        }
    }

    /// Returns `λ tr e`, as `e_zz = 0`.
    #[inline]
    fn out_of_plane_stress(&self, f: &Tensor<D>) -> f64 {
        self.lame.lambda * (f - Tensor::identity()).trace()
    }

    fn is_linear(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SaintVenantKirchhoff, check_material};
    use super::*;

    fn lame() -> LameParameters {
        LameParameters::new(2e6, 8e6).unwrap()
    }

    fn is_consistent<const D: usize>() {
        let check = check_material::<D>(&LinearElastic::new(lame()), 20);
        assert!(
            check.first_piola.max(check.derivative).max(check.stiffness).max(check.reference_stress) < 1e-8,
            "{check:?}"
        );
        assert!(check.objectivity > 1e-3, "finite rotations strain a linear material: {check:?}");
    }

    #[test]
    fn is_consistent_in_2d_and_3d() {
        is_consistent::<2>();
        is_consistent::<3>();
    }

    #[test]
    fn is_the_nonlinear_material_at_small_strain() {
        let h = Tensor::<3>::new(0.3, -0.8, 0.1, 0.5, 0.2, -0.4, 0.7, 0.6, -0.9);
        let (linear, nonlinear) = (LinearElastic::new(lame()), SaintVenantKirchhoff::new(lame()));
        for size in [1e-3, 1e-5] {
            let f = Tensor::identity() + size * h;
            let (p, reference) = (linear.first_piola(&f), nonlinear.first_piola(&f));
            assert!((p - reference).norm() < 4.0 * size * reference.norm(), "{p} {reference}");
        }
    }

    #[test]
    fn plane_strain_stretch() {
        // Stretch by 1 % along x: stresses (λ + 2 μ) 1 %, λ 1 %, and λ 1 % out of the plane.
        let f = Tensor::<2>::new(1.01, 0.0, 0.0, 1.0);
        let material = LinearElastic::new(lame());
        assert!((material.first_piola(&f) - Tensor::<2>::new(1.2e5, 0.0, 0.0, 8e4)).norm() < 1e-6);
        assert!((material.out_of_plane_stress(&f) - 8e4).abs() < 1e-6);
    }
}
