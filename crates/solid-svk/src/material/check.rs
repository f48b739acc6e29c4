//! Consistency of a material law with itself.

use algebra::worse;
use mesh::{Tensor, Vector, det};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use super::Material;

/// Relative deviations found by [`check_material`]; all of them should be small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialCheck {
    /// First Piola stress against central differences of the energy.
    pub first_piola: f64,
    /// Derivative of the first Piola stress against central differences of the stress.
    pub derivative: f64,
    /// Blocks of the stiffness against the derivative, relative to the largest of them.
    pub stiffness: f64,
    /// Energy and stress after a rotation of space: `W(QF) = W(F)`, `P(QF) = Q P(F)`.
    pub objectivity: f64,
    /// Stress of the undeformed state.
    pub reference_stress: f64,
}

impl MaterialCheck {
    /// Returns the largest of the deviations.
    pub fn largest(&self) -> f64 {
        [self.derivative, self.stiffness, self.objectivity, self.reference_stress]
            .into_iter()
            .fold(self.first_piola, worse)
    }
}

/// Returns the largest deviation of the blocks of the stiffness from [`Material::first_piola_derivative`]. The
/// directions are the first `D + 1` columns of the two tensors.
fn stiffness_deviation<const D: usize>(material: &dyn Material<D>, f: &Tensor<D>, pair: &[Tensor<D>; 2]) -> f64 {
    let g: Vec<Vector<D>> = (0..=D).map(|i| pair[i / D].column(i % D).into_owned()).collect();
    let (mut largest, mut deviation, mut n_blocks) = (0.0_f64, 0.0_f64, 0);
    material.for_each_stiffness(f, &g, &mut |i, j, block| {
        n_blocks += 1;
        for (row, column, block) in [(i, j, *block), (j, i, block.transpose())] {
            for b in 0..D {
                let mut h = Tensor::<D>::zeros();
                h.set_row(b, &g[column].transpose());
                let expected = material.first_piola_derivative(f, &h) * g[row];
                largest = worse(largest, expected.norm());
                deviation = worse(deviation, (expected - block.column(b)).norm());
            }
        }
    });
    let is_complete = n_blocks == (D + 1) * (D + 2) / 2;
    if is_complete { deviation / largest } else { f64::INFINITY }
}

/// Checks a material law at pseudo-random deformations: `P` is the derivative of `W`, `dP` that of `P`, the
/// stiffness follows from it, energy and stress are objective, and the reference state is free of stress.
pub fn check_material<const D: usize>(material: &dyn Material<D>, n_states: usize) -> MaterialCheck {
    let mut random = SplitMix64::seed_from_u64(1);
    let mut tensor = || Tensor::<D>::from_fn(|_, _| random.random_range(-1.0..1.0));
    let identity = Tensor::<D>::identity();
    let step = f64::EPSILON.cbrt();
    let mut check = MaterialCheck::default();
    // The derivative at the reference in a random direction sets the scale of stresses.
    let scale = material.first_piola_derivative(&identity, &tensor()).norm();
    check.reference_stress = worse(0.0, material.first_piola(&identity).norm() / scale);
    for _ in 0..n_states {
        let f = identity + 0.25 * tensor();
        let h = tensor();
        if det(&f) <= 0.0 {
            continue;
        }
        let (ahead, behind) = (f + step * h, f - step * h);
        let p = material.first_piola(&f);
        let slope = (material.energy_density(&ahead) - material.energy_density(&behind)) / (2.0 * step);
        check.first_piola = worse(check.first_piola, (slope - p.dot(&h)).abs() / scale);
        let slope = (material.first_piola(&ahead) - material.first_piola(&behind)) / (2.0 * step);
        let derivative = material.first_piola_derivative(&f, &h);
        check.derivative = worse(check.derivative, (slope - derivative).norm() / scale);
        check.stiffness = worse(check.stiffness, stiffness_deviation(material, &f, &[tensor(), tensor()]));
        // Cayley's transform of a skew tensor is a rotation.
        let skew = 0.5 * (h - h.transpose());
        if let Some(inverse) = (identity + skew).try_inverse() {
            let q = inverse * (identity - skew);
            let energy = material.energy_density(&(q * f)) - material.energy_density(&f);
            let stress = material.first_piola(&(q * f)) - q * p;
            check.objectivity = worse(check.objectivity, (energy.abs() + stress.norm()) / scale);
        }
    }
    check
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LameParameters, LinearElastic, MaterialInSpace};

    /// A law with a stress that is NaN.
    #[derive(Debug)]
    struct Nan(LinearElastic);

    impl Material<2> for Nan {
        fn in_space(&self) -> &MaterialInSpace {
            &self.0
        }

        fn energy_density(&self, f: &Tensor<2>) -> f64 {
            self.0.energy_density(f)
        }

        fn first_piola(&self, _f: &Tensor<2>) -> Tensor<2> {
            Tensor::from_element(f64::NAN)
        }

        fn first_piola_derivative(&self, f: &Tensor<2>, h: &Tensor<2>) -> Tensor<2> {
            self.0.first_piola_derivative(f, h)
        }

        fn out_of_plane_stress(&self, f: &Tensor<2>) -> f64 {
            self.0.out_of_plane_stress(f)
        }
    }

    #[test]
    fn nan_is_the_largest_deviation() {
        let law = Nan(LinearElastic::new(LameParameters { mu: 1.0, lambda: 2.0 }));
        assert_eq!(check_material(&law, 3).largest(), f64::INFINITY);
    }
}
