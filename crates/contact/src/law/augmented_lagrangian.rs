//! Augmented Lagrangian contact: exact distances of bodies that have no stress, with or without friction.

use mesh::{non_negative, positive};

use super::coulomb::Coulomb;
use super::{ContactLaw, ContactPoint, ContactTraction, StressSource};
use crate::Error;

/// `λ = -[(γ_C0/s) (ε - Δ) - m_n]₊` with the multiplier `m`, the traction of the previous solve
///
/// The step is solved again with the tractions of its last solve as multipliers until these no longer change. Then
/// `Δ = ε` where there is contact, up to a tolerance, and `λ` is the force that this needs, whatever `γ_C0` is. The
/// first solve has `m = 0` and is that of the penalty law. Such a solve reduces the error of the gap by the factor
/// `K/(K + γ_C0 A/s)`, where `A` is the area in contact and `K` the force that moves the bodies by a unit length in a
/// step, for a free body of mass `M` about `M/Δt²`. The multipliers of later solves may be accelerated.
///
/// Coulomb friction with the coefficient `μ_f` adds `τ = -P((γ_C0/s) g - m_t)` with the slip `g` over the step and the
/// projection `P` onto the disk of radius `-μ_f m_n`. Where surfaces stick, `g = 0` after the last solve up to the same
/// tolerance.
///
/// Source: Alart and Curnier 1991, doi:10.1016/0045-7825(91)90022-X, solved by the iteration of Uzawa; Simo and Laursen
/// 1992, doi:10.1016/0045-7949(92)90540-G.
/// Units: `γ_C0`, `λ`, `τ` and `m` force per area, `s`, `ε` and `g` lengths, `μ_f` a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedLagrangianLaw {
    gamma_contact_0: f64,
    offset: f64,
    tolerance: f64,
    friction: f64,
}

impl AugmentedLagrangianLaw {
    /// Creates the law with parameter `γ_C0`, offset `ε` and coefficient of friction `μ_f`. Solves are repeated until
    /// distances of surfaces in contact differ from the offset by at most `tolerance` times the contact size, and with
    /// friction also until tractions change by at most `tolerance` times the largest one.
    ///
    /// # Errors
    /// [`Error::Parameter`]: parameter or tolerance not positive, offset or friction negative.
    pub fn new(gamma_contact_0: f64, offset: f64, friction: f64, tolerance: f64) -> Result<Self, Error> {
        positive("gamma_contact_0", gamma_contact_0)?;
        non_negative("contact offset", offset)?;
        non_negative("friction", friction)?;
        positive("tolerance of the contact", tolerance)?;
        Ok(Self { gamma_contact_0, offset, tolerance, friction })
    }

    fn coulomb(&self, at: &ContactPoint) -> Coulomb {
        let stiffness = self.gamma_contact_0 / at.size;
        Coulomb { stiffness, offset: self.offset, friction: self.friction, is_lagged: true }
    }
}

impl ContactLaw for AugmentedLagrangianLaw {
    #[inline]
    fn traction(&self, at: &ContactPoint) -> ContactTraction {
        self.coulomb(at).traction(at)
    }

    #[inline]
    fn is_active(&self, at: &ContactPoint) -> bool {
        self.coulomb(at).pressing(at) > 0.0
    }

    #[inline]
    fn offset(&self) -> f64 {
        self.offset
    }

    fn stress(&self) -> StressSource {
        StressSource::Multiplier
    }

    fn accepted_change(&self, largest_traction: f64) -> f64 {
        // The limit of friction is proportional to the traction: its error is relative to the largest traction.
        let scale = if self.friction > 0.0 { self.gamma_contact_0.min(largest_traction) } else { self.gamma_contact_0 };
        self.tolerance * scale
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_law;
    use super::*;

    #[test]
    fn is_a_law() {
        for stress in [[-0.3, 0.0, 0.0], [-3.0, 3.0, -2.0], [-11.0, 0.5, 4.0], [5.0, 1.0, 0.0]] {
            let slip = [0.02, -0.01];
            let gap = |k: i32| 0.013 * f64::from(k) + 0.001;
            let at = |k: i32| ContactPoint { gap: gap(k), size: 0.1, stress, slip, ..ContactPoint::default() };
            let points = (-20..20).map(at).collect::<Vec<_>>();
            for friction in [0.0, 0.4] {
                let law = AugmentedLagrangianLaw::new(10.0, 0.08, friction, 1e-6).unwrap();
                let check = check_law(&law, &points);
                assert!(check.largest() < 1e-7, "{check:?}");
            }
        }
    }

    #[test]
    fn a_multiplier_is_kept_at_the_offset_and_the_law_without_it_is_the_penalty() {
        let law = AugmentedLagrangianLaw::new(10.0, 0.1, 0.0, 1e-6).unwrap();
        let at = ContactPoint { gap: 0.1, size: 0.1, stress: [-3.0, 0.0, 0.0], ..ContactPoint::default() };
        assert_eq!(law.traction(&at).value, [-3.0, 0.0, 0.0]);
        let below = ContactPoint { gap: 0.07, stress: [0.0; 3], ..at };
        let penalty = crate::PenaltyLaw::new(10.0, 0.1).unwrap();
        assert!((law.traction(&below).value[0] - penalty.traction(&below).value[0]).abs() < 1e-15);
    }

    #[test]
    fn impossible_laws_are_refused() {
        assert!(AugmentedLagrangianLaw::new(0.0, 0.1, 0.0, 1e-6).is_err());
        assert!(AugmentedLagrangianLaw::new(1.0, -0.1, 0.0, 1e-6).is_err());
        assert!(AugmentedLagrangianLaw::new(1.0, 0.1, 0.0, 0.0).is_err());
        assert!(AugmentedLagrangianLaw::new(1.0, 0.1, 0.0, f64::NAN).is_err());
        assert!(AugmentedLagrangianLaw::new(1.0, 0.1, -0.1, 1e-6).is_err());
    }
}
