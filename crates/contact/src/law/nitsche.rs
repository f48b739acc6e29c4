//! Nitsche contact: consistent with the stress of the slave, with or without friction.

use mesh::{non_negative, positive};

use super::coulomb::Coulomb;
use super::{ContactLaw, ContactPoint, ContactTraction, StressSource};
use crate::Error;

/// `λ = -[γ_C (ε - Δ) - s_n]₊` with `γ_C = γ_0 (2 μ + λˢ)/h` and the normal stress `s_n`, positive in tension
///
/// The law is consistent: for `Δ = ε` it gives `λ = s_n`, so that the gap under a uniform pressure is exact for every
/// `γ_0`. In fluid `s_n` is the normal part of the jump, `n·(σˢ - Tᶠ) n`. The pressure of the fluid acts in the film,
/// and contact carries the rest of the stress.
///
/// Coulomb friction with the coefficient `μ_f` adds the tangential traction `τ = -P(γ_C g - s_t)` with the slip `g`
/// over the step, the tangential stress `s_t` and the projection `P` onto the disk of radius `-μ_f λ`. Surfaces stick
/// if the argument lies inside the disk; then `τ = s_t - γ_C g`. The slip `g` is zero in the exact solution, and small
/// in the discrete one.
///
/// Source: Chouly and Hild 2013, doi:10.1137/12088344X, with their `θ = 0` and `P_γ = γ_C (ε - Δ) - s_n`; with friction
/// Chouly 2014, doi:10.1016/j.jmaa.2013.09.019, with the slip over a step instead of the displacement; with fluid
/// Burman, Fernández and Frei 2020, doi:10.1051/m2an/2019072.
/// Units: `γ_0` and `μ_f` are numbers, `λ`, `τ` and the stresses force per area, `γ_C` force per volume, `ε`, `g` and
/// the height `h` of the slave's cell are lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NitscheLaw {
    gamma_0: f64,
    offset: f64,
    friction: f64,
}

impl NitscheLaw {
    /// Creates the law with parameter `γ_0`, offset `ε` and coefficient of friction `μ_f`.
    ///
    /// It is stable if `γ_0` is above `D` times the largest number of facets of one cell that lie on the surface. `D`
    /// is the constant of the trace inequality of linear elements.
    ///
    /// # Errors
    /// [`Error::Parameter`]: parameter not positive, offset or friction negative.
    pub fn new(gamma_0: f64, offset: f64, friction: f64) -> Result<Self, Error> {
        positive("gamma_0", gamma_0)?;
        non_negative("contact offset", offset)?;
        non_negative("friction", friction)?;
        Ok(Self { gamma_0, offset, friction })
    }

    fn coulomb(&self, at: &ContactPoint) -> Coulomb {
        let stiffness = self.gamma_0 * at.stiffness;
        Coulomb { stiffness, offset: self.offset, friction: self.friction, is_lagged: false }
    }
}

impl ContactLaw for NitscheLaw {
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
            let check = check_law(&NitscheLaw::new(10.0, 0.08, 0.0).unwrap(), &(-20..20).map(at).collect::<Vec<_>>());
            assert!(check.largest() < 1e-8, "{check:?}");
        }
    }

    #[test]
    fn friction_is_a_law() {
        let law = NitscheLaw::new(10.0, 0.08, 0.4).unwrap();
        let [mut sticks, mut slides] = [0, 0];
        for (slip, stress) in [
            ([0.01, -0.02], [7.0, 3.0, -2.0]),
            ([1e-3, 0.0], [-11.0, 0.5, 1.0]),
            ([0.0, 0.0], [-30.0, 5.0, 4.0]),
            ([-0.05, 0.0], [-3.0, 0.0, 0.0]),
        ] {
            let gap = |k: i32| 0.013 * f64::from(k) + 0.001;
            let at = |k: i32| ContactPoint { gap: gap(k), size: 0.1, stiffness: 20.0, slip, stress };
            let points = (-20..20).map(at).collect::<Vec<_>>();
            let check = check_law(&law, &points);
            assert!(check.largest() < 1e-7, "{check:?}");
            for [normal, tangential @ ..] in points.iter().map(|at| law.traction(at).value) {
                let (traction, limit) = (tangential[0].hypot(tangential[1]), -0.4 * normal);
                assert!(traction <= limit * (1.0 + 1e-12));
                *(if traction < 0.99 * limit { &mut sticks } else { &mut slides }) += i32::from(limit > 0.0);
            }
        }
        assert!(sticks > 10 && slides > 10, "{sticks} {slides}");
    }

    #[test]
    fn friction_opposes_the_slip_and_is_the_stress_without_slip() {
        let law = NitscheLaw::new(10.0, 0.1, 0.5).unwrap();
        let at = ContactPoint { gap: 0.1, stiffness: 20.0, stress: [-3.0, 1.0, -0.5], ..ContactPoint::default() };
        assert_eq!(law.traction(&at).value, [-3.0, 1.0, -0.5]);
        let slides = law.traction(&ContactPoint { slip: [1.0, 0.0], stress: [-3.0, 0.0, 0.0], ..at }).value;
        assert!((slides[1] + 1.5).abs() < 1e-15 && slides[2] == 0.0, "{slides:?}");
    }

    #[test]
    fn the_traction_is_the_stress_at_the_offset() {
        let at = ContactPoint { gap: 0.1, stiffness: 20.0, stress: [-3.0, 0.0, 0.0], ..ContactPoint::default() };
        let traction = NitscheLaw::new(10.0, 0.1, 0.0).unwrap().traction(&at);
        assert_eq!(traction.value, [-3.0, 0.0, 0.0]);
    }

    #[test]
    fn impossible_laws_are_refused() {
        assert!(NitscheLaw::new(0.0, 0.1, 0.0).is_err() && NitscheLaw::new(10.0, -0.1, 0.0).is_err());
        assert!(NitscheLaw::new(f64::NAN, 0.0, 0.0).is_err());
        assert!(NitscheLaw::new(1.0, 0.0, -0.1).is_err());
    }
}
