//! Penalty contact with an offset.

use mesh::{non_negative, positive};

use super::{ContactLaw, ContactPoint, ContactTraction};
use crate::Error;

/// `λ = -(γ_C0/s) [ε - Δ]₊`, with stored energy `1/2 (γ_C0/s) [ε - Δ]₊²`
///
/// Source: paper, Eq. (6) and Remark 2, whose last equality has the wrong sign.
/// Units: `γ_C0` and `λ` force per area, `s` and `ε` lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyLaw {
    gamma_contact_0: f64,
    offset: f64,
}

impl PenaltyLaw {
    /// Creates the law with penalty parameter `gamma_contact_0` and offset `ε`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: parameter not positive, offset negative.
    pub fn new(gamma_contact_0: f64, offset: f64) -> Result<Self, Error> {
        positive("gamma_contact_0", gamma_contact_0)?;
        non_negative("contact offset", offset)?;
        Ok(Self { gamma_contact_0, offset })
    }
}

impl ContactLaw for PenaltyLaw {
    #[inline]
    fn traction(&self, at: &ContactPoint) -> ContactTraction {
        if !self.is_active(at) {
            return ContactTraction::default();
        }
        let gamma_contact = self.gamma_contact_0 / at.size;
        ContactTraction {
            value: [-gamma_contact * (self.offset - at.gap), 0.0, 0.0],
            by_gap: [gamma_contact, 0.0, 0.0],
            ..ContactTraction::default()
        }
    }

    #[inline]
    fn is_active(&self, at: &ContactPoint) -> bool {
        at.gap < self.offset
    }

    #[inline]
    fn offset(&self) -> f64 {
        self.offset
    }

    #[inline]
    fn energy_density(&self, at: &ContactPoint) -> Option<f64> {
        Some(0.5 * self.gamma_contact_0 / at.size * (self.offset - at.gap).max(0.0).powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::super::check_law;
    use super::*;

    #[test]
    fn is_a_law() {
        for offset in [0.0, 0.1] {
            let at = |k: i32| ContactPoint { gap: 0.013 * f64::from(k) + 0.001, size: 0.1, ..ContactPoint::default() };
            let check = check_law(&PenaltyLaw::new(1e8, offset).unwrap(), &(-20..20).map(at).collect::<Vec<_>>());
            assert!(check.largest() < 1e-8, "{check:?}");
        }
    }

    #[test]
    fn nothing_happens_at_the_offset() {
        let law = PenaltyLaw::new(1e8, 0.1).unwrap();
        let at = ContactPoint { gap: 0.1, size: 0.1, ..ContactPoint::default() };
        assert_eq!(law.traction(&at), ContactTraction::default());
        assert!(!law.is_active(&at) && law.energy_density(&at) == Some(0.0));
    }

    #[test]
    fn impossible_laws_are_refused() {
        assert!(PenaltyLaw::new(0.0, 0.1).is_err());
        assert!(PenaltyLaw::new(1.0, -0.1).is_err());
        assert!(PenaltyLaw::new(1.0, f64::NAN).is_err());
    }
}
