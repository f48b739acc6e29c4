//! Material laws: stored energy, first Piola stress and its directional derivative.

mod check;
mod linear_elastic;
mod neo_hookean;
mod saint_venant_kirchhoff;

pub use check::{MaterialCheck, check_material};
pub use linear_elastic::LinearElastic;
pub use neo_hookean::NeoHookean;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;

use mesh::{Tensor, Vector, positive, require};

use crate::{Error, MAX_CELL_NODES};

/// A material in space.
pub type MaterialInSpace = dyn Material<3>;

/// A hyperelastic material; in 2D in plane strain.
///
/// The derivative is directional, so that no tensor of fourth order is ever formed.
pub trait Material<const D: usize>: Send + Sync + std::fmt::Debug {
    /// Returns the same material in space, which is evaluated in axisymmetric coordinates.
    fn in_space(&self) -> &MaterialInSpace;

    /// Returns the stored energy per reference volume at the deformation gradient `f`.
    ///
    /// Units: energy per volume, in 2D of a unit depth.
    fn energy_density(&self, f: &Tensor<D>) -> f64;

    /// Returns the first Piola stress `P = ∂W/∂F`.
    ///
    /// Units: force per area.
    fn first_piola(&self, f: &Tensor<D>) -> Tensor<D>;

    /// Returns the derivative of the first Piola stress at `f` in direction `h`.
    fn first_piola_derivative(&self, f: &Tensor<D>, h: &Tensor<D>) -> Tensor<D>;

    /// Calls `visit(i, j, K_ij)` for all `j <= i` with the blocks of the stiffness between directions `g`, at most
    /// [`MAX_CELL_NODES`]:
    ///
    /// `(K_ij)_ab = (dP[e_b ⊗ g_j] g_i)_a`, and `K_ji = K_ijᵀ` because the stress has an energy.
    ///
    /// Most of the time of an assembly is spent in this method: override it if the blocks have a closed form.
    fn for_each_stiffness(&self, f: &Tensor<D>, g: &[Vector<D>], visit: &mut dyn FnMut(usize, usize, &Tensor<D>)) {
        for j in 0..g.len() {
            let mut blocks = [Tensor::<D>::zeros(); MAX_CELL_NODES];
            for b in 0..D {
                let mut h = Tensor::<D>::zeros();
                h.set_row(b, &g[j].transpose());
                let dp = self.first_piola_derivative(f, &h);
                (j..g.len()).for_each(|i| blocks[i].set_column(b, &(dp * g[i])));
            }
            (j..g.len()).for_each(|i| visit(i, j, &blocks[i]));
        }
    }

    /// Returns the Cauchy stress normal to the plane in plane strain; undefined in 3D, where it is never called.
    fn out_of_plane_stress(&self, f: &Tensor<D>) -> f64;

    /// Returns whether the stress is linear in `f - I`; internal work is then assembled once per nonlinear solve.
    fn is_linear(&self) -> bool {
        false
    }
}

/// Lame parameters of an isotropic material. In 2D (plane strain) they have the values of the material in 3D.
///
/// Units: force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LameParameters {
    /// Shear modulus.
    pub mu: f64,
    /// First parameter.
    pub lambda: f64,
}

impl LameParameters {
    /// Returns the parameters given directly.
    ///
    /// # Errors
    /// [`Error::Parameter`]: `mu` not positive, or the bulk modulus `lambda + 2 mu/3` not positive.
    pub fn new(mu: f64, lambda: f64) -> Result<Self, Error> {
        positive("shear modulus mu", mu)?;
        let is_stable = lambda.is_finite() && 3.0 * lambda + 2.0 * mu > 0.0;
        require(is_stable, "lambda", lambda, "finite and above -2 mu/3")?;
        Ok(Self { mu, lambda })
    }

    /// Returns the parameters of a material with Young's modulus `young` and Poisson's ratio `poisson`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: `young` not positive, or `poisson` not between -1 and 1/2.
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, Error> {
        positive("Young's modulus", young)?;
        require(poisson > -1.0 && poisson < 0.5, "Poisson's ratio", poisson, "between -1 and 1/2")?;
        let mu = young / (2.0 * (1.0 + poisson));
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Self::new(mu, lambda)
    }

    /// Returns Young's modulus.
    pub fn young(&self) -> f64 {
        self.mu * (3.0 * self.lambda + 2.0 * self.mu) / (self.lambda + self.mu)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::cauchy_stress;

    fn plane_strain_is_the_plane_state_in_3d<M: Material<2> + Material<3>>(material: M, tolerance: f64) {
        let f = Tensor::<2>::new(1.1, 0.2, -0.1, 0.95);
        let mut f3 = Tensor::<3>::identity();
        f3.fixed_view_mut::<2, 2>(0, 0).copy_from(&f);
        let sigma = cauchy_stress(&f3, &material.first_piola(&f3));
        assert!((sigma[(2, 2)] - material.out_of_plane_stress(&f)).abs() < 1e-9);
        assert!((sigma.fixed_view::<2, 2>(0, 0) - cauchy_stress(&f, &material.first_piola(&f))).norm() < tolerance);
    }

    #[test]
    fn plane_strain_is_the_plane_state_in_3d_of_every_material() {
        let lame = LameParameters::new(2e6, 8e6).unwrap();
        plane_strain_is_the_plane_state_in_3d(NeoHookean::new(lame), 1e-8);
        plane_strain_is_the_plane_state_in_3d(SaintVenantKirchhoff::new(lame), 1e-9);
    }

    #[test]
    fn the_moduli_of_the_paper() {
        // Material of the ball in the paper, Sec. 4: mu = 2e6, lambda = 8e6.
        let lame = LameParameters::from_young_poisson(5.6e6, 0.4).unwrap();
        assert!((lame.mu - 2e6).abs() < 1e-8 && (lame.lambda - 8e6).abs() < 1e-8);
        assert!((lame.young() - 5.6e6).abs() < 1e-8);
    }

    #[test]
    fn impossible_materials_are_refused() {
        assert!(LameParameters::new(0.0, 1.0).is_err());
        assert!(LameParameters::new(f64::NAN, 1.0).is_err());
        assert!(LameParameters::new(1.0, -1.0).is_err());
        assert!(LameParameters::from_young_poisson(1.0, 0.5).is_err());
        assert!(LameParameters::from_young_poisson(-1.0, 0.3).is_err());
    }
}
