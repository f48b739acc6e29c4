//! A compressible neo-Hookean material.

use mesh::{Tensor, Vector, det};

use super::{LameParameters, Material, MaterialInSpace};
use crate::MAX_CELL_NODES;

/// `W = μ/2 (F:F - D) - μ ln J + λ/2 (ln J)²`, `P = μ (F - F⁻ᵀ) + λ ln J F⁻ᵀ`, in 2D in plane strain.
///
/// The energy is unbounded for `J -> 0`, so that a cell resists any compression.
///
/// Source: Bonet, Wood 2008, Nonlinear Continuum Mechanics for Finite Element Analysis, Sec. 6.4.
/// Units: `W`, `P`, `μ` and `λ` force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// Lame parameters.
    pub lame: LameParameters,
}

impl NeoHookean {
    /// Creates the material with the given parameters.
    pub fn new(lame: LameParameters) -> Self {
        Self { lame }
    }
}

/// Returns `F⁻¹` and `ln J`; NaN for an inverted cell. The step then fails, and is divided if the time loop allows it.
fn inverse_and_log<const D: usize>(f: &Tensor<D>) -> (Tensor<D>, f64) {
    (f.try_inverse().unwrap_or_else(|| Tensor::from_element(f64::NAN)), det(f).ln())
}

impl<const D: usize> Material<D> for NeoHookean {
    fn in_space(&self) -> &MaterialInSpace {
        self
    }

    #[inline]
    fn energy_density(&self, f: &Tensor<D>) -> f64 {
        let LameParameters { mu, lambda } = self.lame;
        let log = det(f).ln();
        0.5 * mu * (f.norm_squared() - D as f64) - mu * log + 0.5 * lambda * log.powi(2)
    }

    #[inline]
    fn first_piola(&self, f: &Tensor<D>) -> Tensor<D> {
        let LameParameters { mu, lambda } = self.lame;
        let (inverse, log) = inverse_and_log(f);
        f * mu + inverse.transpose() * (lambda * log - mu)
    }

    /// Returns `μ H + (μ - λ ln J) F⁻ᵀ Hᵀ F⁻ᵀ + λ tr(F⁻¹ H) F⁻ᵀ`.
    #[inline]
    fn first_piola_derivative(&self, f: &Tensor<D>, h: &Tensor<D>) -> Tensor<D> {
        let LameParameters { mu, lambda } = self.lame;
        let (inverse, log) = inverse_and_log(f);
        let turned = (inverse * h * inverse).transpose();
        h * mu + turned * (mu - lambda * log) + inverse.transpose() * (lambda * (inverse * h).trace())
    }

    /// Computes `K_ij = λ c_i ⊗ c_j + (μ - λ ln J) c_j ⊗ c_i + μ (g_i·g_j) I` with `c = F⁻ᵀ g`.
    #[inline]
    fn for_each_stiffness(&self, f: &Tensor<D>, g: &[Vector<D>], visit: &mut dyn FnMut(usize, usize, &Tensor<D>)) {
        let LameParameters { mu, lambda } = self.lame;
        let (inverse, log) = inverse_and_log(f);
        let mut current = [Vector::zeros(); MAX_CELL_NODES];
        current.iter_mut().zip(g).for_each(|(current, g)| *current = inverse.transpose() * g);
        for i in 0..g.len() {
            for j in 0..=i {
                let (along, across) = (current[i] * current[j].transpose(), current[j] * current[i].transpose());
                let mut block = along * lambda + across * (mu - lambda * log);
                let diagonal = mu * g[i].dot(&g[j]);
                (0..D).for_each(|a| block[(a, a)] += diagonal);
                visit(i, j, &block);
            }
        }
    }

    /// Returns `λ ln J / J`, as `F_zz = 1`.
    #[inline]
    fn out_of_plane_stress(&self, f: &Tensor<D>) -> f64 {
        self.lame.lambda * det(f).ln() / det(f)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SaintVenantKirchhoff, check_material};
    use super::*;

    fn material() -> NeoHookean {
        NeoHookean::new(LameParameters::new(2e6, 8e6).unwrap())
    }

    fn is_a_material<const D: usize>() {
        let check = check_material::<D>(&material(), 20);
        assert!(check.largest() < 1e-6, "{check:?}");
        assert!(check.stiffness < 1e-13 && check.objectivity < 1e-12 && check.reference_stress < 1e-14, "{check:?}");
        // Hooke's law at small strain.
        let (f, h) = (Tensor::<D>::identity(), Tensor::<D>::from_fn(|a, b| (3 * a + b) as f64 - 2.0));
        let hooke = SaintVenantKirchhoff::new(material().lame).first_piola_derivative(&f, &h);
        assert!((material().first_piola_derivative(&f, &h) - hooke).norm() < 1e-14 * hooke.norm());
    }

    #[test]
    fn is_a_material_in_2d_and_3d() {
        is_a_material::<2>();
        is_a_material::<3>();
    }

    #[test]
    fn uniform_expansion() {
        // F = s I in space: P = (μ (s - 1/s) + 3 λ ln s / s) I.
        for s in [0.2_f64, 0.9, 1.5] {
            let p = material().first_piola(&(Tensor::<3>::identity() * s));
            let expected = 2e6 * (s - 1.0 / s) + 3.0 * 8e6 * s.ln() / s;
            assert!((p - Tensor::<3>::identity() * expected).norm() < 1e-12 * expected.abs());
        }
    }

    #[test]
    fn an_inverted_cell_has_no_stress() {
        let f = Tensor::<2>::new(-1.0, 0.0, 0.0, 1.0);
        assert!(material().first_piola(&f).iter().any(|p| p.is_nan()) && material().energy_density(&f).is_nan());
    }
}
