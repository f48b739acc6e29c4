//! Tests of a contact law: sign, monotonicity and derivatives.

use algebra::worse;

use super::{ContactLaw, ContactPoint, ContactTraction};

/// Deviations found by [`check_law`], relative to the largest traction; all of them should be small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawCheck {
    /// Largest tension: the normal traction must not be positive.
    pub tension: f64,
    /// Largest decrease of the normal traction from one point to the next. Points are given with increasing gaps. It
    /// is 1 if a point leaves contact when its gap or normal stress decreases, or without slip and tangential stress.
    pub monotonicity: f64,
    /// Traction at inactive points.
    pub inactive: f64,
    /// Derivatives with respect to gap, slip and stress, compared with central differences away from kinks.
    pub derivative: f64,
    /// Normal traction compared with the difference quotient of the stored energy by the gap, if the law has one. Also
    /// the change of both with slip and stress, which must be zero: a step computes the traction from an energy of the
    /// gap alone.
    pub energy: f64,
}

impl LawCheck {
    /// Returns the largest of the deviations.
    pub fn largest(&self) -> f64 {
        [self.monotonicity, self.inactive, self.derivative, self.energy].into_iter().fold(self.tension, worse)
    }
}

/// Returns the point with one argument changed.
fn moved(at: &ContactPoint, argument: usize, by: f64) -> ContactPoint {
    let mut moved = *at;
    match argument {
        0 => moved.gap += by,
        1 | 2 => moved.slip[argument - 1] += by,
        _ => moved.stress[argument - 3] += by,
    }
    moved
}

/// Checks a law at the given points, in the order of increasing gaps: sign, monotonicity, and the derivatives with
/// respect to everything that the law may depend on.
pub fn check_law(law: &dyn ContactLaw, points: &[ContactPoint]) -> LawCheck {
    let normal = |at: &ContactPoint| law.traction(at).value[0];
    let largest = |values: [f64; 3]| values.iter().fold(0.0_f64, |m, v| worse(m, v.abs()));
    let scale = points.iter().map(|at| largest(law.traction(at).value)).fold(f64::MIN_POSITIVE, f64::max);
    let mut check = LawCheck::default();
    let mut before = f64::NEG_INFINITY;
    for at in points {
        let ContactTraction { value, by_gap, by_slip, by_stress } = law.traction(at);
        check.tension = worse(check.tension, value[0] / scale);
        check.monotonicity = worse(check.monotonicity, (before - value[0]) / scale);
        before = value[0];
        let normal_only = ContactPoint { slip: [0.0; 2], stress: [at.stress[0], 0.0, 0.0], ..*at };
        let others = [moved(at, 0, -at.size), moved(at, 3, -scale), normal_only];
        if law.is_active(at) && !others.iter().all(|other| law.is_active(other)) {
            check.monotonicity = worse(check.monotonicity, 1.0);
        }
        if !law.is_active(at) {
            check.inactive = worse(check.inactive, largest(value) / scale);
        }
        let derivatives = [by_gap, by_slip[0], by_slip[1], by_stress[0], by_stress[1], by_stress[2]];
        for (argument, derivative) in derivatives.iter().enumerate() {
            // Lengths vary on the scale of the contact size, stresses on the scale of the traction.
            let size = if argument < 3 { at.size } else { scale };
            let step = f64::EPSILON.cbrt() * size;
            let (below, above) = (moved(at, argument, -step), moved(at, argument, step));
            if law.is_active(&below) != law.is_active(&above) {
                continue;
            }
            let (from, to) = (law.traction(&below).value, law.traction(&above).value);
            for k in 0..3 {
                let slope = (to[k] - from[k]) / (2.0 * step);
                check.derivative = worse(check.derivative, (slope - derivative[k]).abs() * size / scale);
            }
        }
        let step = f64::EPSILON.cbrt() * at.size;
        let (below, above) = (moved(at, 0, -step), moved(at, 0, step));
        if law.is_active(&below) == law.is_active(&above)
            && let (Some(from), Some(to)) = (law.energy_density(&below), law.energy_density(&above))
        {
            let slope = (to - from) / (2.0 * step);
            check.energy = worse(check.energy, (slope - normal(at)).abs() / scale);
            let by_slip = by_slip.iter().map(|column| column[0].abs() * at.size / scale);
            let by_others = by_slip.chain(by_stress.iter().map(|column| column[0].abs()));
            check.energy = by_others.fold(check.energy, worse);
            let energy = |argument: usize, by: f64| law.energy_density(&moved(at, argument, by)).unwrap_or(f64::NAN);
            for (argument, size) in [(1, at.size), (2, at.size), (3, scale), (4, scale), (5, scale)] {
                let change = energy(argument, 0.1 * size) - energy(argument, -0.1 * size);
                check.energy = worse(check.energy, change.abs() / (scale * at.size));
            }
        }
    }
    check
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PenaltyLaw, StressSource};

    /// A penalty with changes of its traction, where it acts, and of its energy.
    #[derive(Debug)]
    struct Changed {
        penalty: PenaltyLaw,
        traction: fn(&ContactPoint, &mut ContactTraction),
        energy: fn(&ContactPoint, f64) -> f64,
    }

    impl ContactLaw for Changed {
        fn traction(&self, at: &ContactPoint) -> ContactTraction {
            let mut traction = self.penalty.traction(at);
            if self.is_active(at) {
                (self.traction)(at, &mut traction);
            }
            traction
        }

        fn is_active(&self, at: &ContactPoint) -> bool {
            self.penalty.is_active(at)
        }

        fn offset(&self) -> f64 {
            self.penalty.offset()
        }

        fn energy_density(&self, at: &ContactPoint) -> Option<f64> {
            self.penalty.energy_density(at).map(|energy| (self.energy)(at, energy))
        }

        fn stress(&self) -> StressSource {
            StressSource::Solid
        }
    }

    /// Checks a penalty with changes at points with gaps around zero.
    fn check_changed(
        traction: fn(&ContactPoint, &mut ContactTraction),
        energy: fn(&ContactPoint, f64) -> f64,
    ) -> LawCheck {
        let law = Changed { penalty: PenaltyLaw::new(1e3, 0.1).unwrap(), traction, energy };
        let at = |k: i32| ContactPoint { gap: 0.013 * f64::from(k) + 0.001, size: 0.1, ..ContactPoint::default() };
        check_law(&law, &(-20..20).map(at).collect::<Vec<_>>())
    }

    #[test]
    fn laws_that_are_not_active_where_they_must_be_are_found() {
        #[derive(Debug)]
        struct Limited(PenaltyLaw, fn(&ContactPoint) -> bool);
        impl ContactLaw for Limited {
            fn traction(&self, at: &ContactPoint) -> ContactTraction {
                if self.is_active(at) { self.0.traction(at) } else { ContactTraction::default() }
            }

            fn is_active(&self, at: &ContactPoint) -> bool {
                self.0.is_active(at) && self.1(at)
            }

            fn offset(&self) -> f64 {
                self.0.offset()
            }
        }
        let at = ContactPoint {
            gap: 0.05,
            size: 0.1,
            slip: [0.01, 0.0],
            stress: [-1.0, 2.0, 0.0],
            ..ContactPoint::default()
        };
        let found = |limit| check_law(&Limited(PenaltyLaw::new(1e3, 0.1).unwrap(), limit), &[at]).monotonicity;
        let limits: [fn(&ContactPoint) -> bool; 4] =
            [|at| at.gap > 0.0, |at| at.stress[0] > -10.0, |at| at.slip[0] > 0.0, |at| at.stress[1] > 1.0];
        assert_eq!(limits.map(found), [1.0; 4]);
        assert_eq!(found(|_| true), 0.0);
    }

    #[test]
    fn values_of_nan_are_the_largest_deviation() {
        let of_derivative = check_changed(
            |at, traction| {
                if at.gap < -0.2 {
                    traction.by_gap[0] = f64::NAN;
                }
            },
            |_, energy| energy,
        );
        let of_energy = check_changed(|_, _| (), |at, energy| if at.gap < -0.2 { f64::NAN } else { energy });
        assert_eq!([of_derivative, of_energy].map(|check| check.largest()), [f64::INFINITY; 2]);
        assert!(check_changed(|_, _| (), |_, energy| energy).largest() < 1e-7);
    }

    /// Checks a penalty that decreases with the normal stress, and states the energy of the penalty alone.
    #[test]
    fn an_energy_with_a_stress_is_found() {
        let check = check_changed(
            |at, traction| {
                traction.value[0] += 1e-3 * at.stress[0];
                traction.by_stress[0][0] = 1e-3;
            },
            |_, energy| energy,
        );
        assert!(check.derivative < 1e-8 && check.energy >= 1e-3, "{check:?}");
    }
}
