//! Nitsche contact: consistent with the stress of the slave.

use mesh::{non_negative, positive};

use super::{ContactLaw, ContactPoint, ContactTraction, StressSource};
use crate::Error;

/// `λ = -[γ_C (ε - Δ) - s_n]₊` with `γ_C = γ_0 (2 μ + λˢ)/h` and the normal stress `s_n`, positive in tension
///
/// The law is consistent: for `Δ = ε` it gives `λ = s_n`, so that the gap under a uniform pressure is exact for every
/// `γ_0`. In fluid `s_n` is the normal part of the jump, `n·(σˢ - Tᶠ) n`. The pressure of the fluid acts in the film,
/// and contact carries the rest of the stress.
///
/// Source: Chouly and Hild 2013, doi:10.1137/12088344X, with their `θ = 0` and `P_γ = γ_C (ε - Δ) - s_n`; with fluid Burman,
/// Fernández and Frei 2020, doi:10.1051/m2an/2019072.
/// Units: `γ_0` is a number, `λ` and `s_n` force per area, `γ_C` force per volume, `ε` and the height `h` of the
/// slave's cell are lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NitscheLaw {
    gamma_0: f64,
    offset: f64,
}

impl NitscheLaw {
    /// Creates the law with parameter `γ_0` and offset `ε`.
    ///
    /// It is stable if `γ_0` is above `D` times the largest number of facets of one cell that lie on the surface. `D`
    /// is the constant of the trace inequality of linear elements.
    ///
    /// # Errors
    /// [`Error::Parameter`]: parameter not positive, offset negative.
    pub fn new(gamma_0: f64, offset: f64) -> Result<Self, Error> {
        positive("gamma_0", gamma_0)?;
        non_negative("contact offset", offset)?;
        Ok(Self { gamma_0, offset })
    }

    /// Returns `γ_C (ε - Δ) - s_n`.
    fn pressing(&self, at: &ContactPoint) -> f64 {
        self.gamma_0 * at.stiffness * (self.offset - at.gap) - at.stress[0]
    }
}

impl ContactLaw for NitscheLaw {
    #[inline]
    fn traction(&self, at: &ContactPoint) -> ContactTraction {
        let pressing = self.pressing(at);
        if pressing <= 0.0 {
            return ContactTraction::default();
        }
        let mut traction = ContactTraction::default();
        traction.value[0] = -pressing;
        traction.by_gap[0] = self.gamma_0 * at.stiffness;
        traction.by_stress[0][0] = 1.0;
        traction
    }

    #[inline]
    fn is_active(&self, at: &ContactPoint) -> bool {
        self.pressing(at) > 0.0
    }

    #[inline]
    fn offset(&self) -> f64 {
        self.offset
    }

    fn stress(&self) -> StressSource {
        StressSource::Jump
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_law;
    use super::*;

    #[test]
    fn is_a_law() {
        for stress in [[0.0; 3], [7.0, 3.0, -2.0], [-11.0, 0.5, 4.0]] {
            let gap = |k: i32| 0.013 * f64::from(k) + 0.001;
            let at =
                |k: i32| ContactPoint { gap: gap(k), size: 0.1, stiffness: 20.0, stress, ..ContactPoint::default() };
            let check = check_law(&NitscheLaw::new(10.0, 0.08).unwrap(), &(-20..20).map(at).collect::<Vec<_>>());
            assert!(check.largest() < 1e-8, "{check:?}");
        }
    }

    #[test]
    fn the_traction_is_the_stress_at_the_offset() {
        let at = ContactPoint { gap: 0.1, stiffness: 20.0, stress: [-3.0, 0.0, 0.0], ..ContactPoint::default() };
        let traction = NitscheLaw::new(10.0, 0.1).unwrap().traction(&at);
        assert_eq!(traction.value, [-3.0, 0.0, 0.0]);
    }

    #[test]
    fn impossible_laws_are_refused() {
        assert!(NitscheLaw::new(0.0, 0.1).is_err() && NitscheLaw::new(10.0, -0.1).is_err());
        assert!(NitscheLaw::new(f64::NAN, 0.0).is_err());
    }
}
