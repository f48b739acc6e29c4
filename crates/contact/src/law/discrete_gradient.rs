//! The traction of a law over a step, such that its work is the change of the stored energy.

use super::{ContactLaw, ContactPoint, ContactTraction};
use crate::Local;

/// Change of the gap, relative to the contact size, below which the law is evaluated at the mean gap instead. Above it,
/// the relative round-off in the derivative of the quotient is below `1e-16/1e-12`. Correspondingly for the motion.
const SMALLEST_CHANGE: f64 = 1e-6;

/// Difference between the change of the gap and the advance, relative to the contact size, that counts as round-off.
const SMALLEST_DIFFERENCE: f64 = 1e-12;

/// Returns the traction `λ n + c r` of a law with the stored energy `W`, and its derivative by the advance
///
/// `λ = (W(Δ^{n+1}) - W(Δ^n))/(Δ^{n+1} - Δ^n)`,   `c = -λ D/max(|r|², D², δ²)`,   `D = Δ^{n+1} - Δ^n + n · r`
///
/// `r` is the motion of the slave's point over the step relative to its projection: `advance` is `n · r`, and the slip
/// is the rest. Where `|D|` and a millionth `δ` of the contact size are below `|r|`, the work `f · r` is minus the
/// change of the energy. At a plane at rest `D = 0`. Where the normal turns, `D` is of second order in the motion of
/// the step, and `c r` turns the normal to about its mean. A point that moves with its projection while the facet turns
/// has `|D| > |r|`: no force along `r` has this work, and `c r` is limited to `λ`.
///
/// `at` is the point at the end of the step. A law without energy is evaluated at the end. At the mean of the gaps at
/// start and end, a stiff law would prescribe this mean only, and the gap would alternate from step to step.
///
/// Source: Gonzalez 2000, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity,
/// doi:10.1016/S0045-7825(00)00189-4; for contact, Armero and Petocz 1998, doi:10.1016/S0045-7825(97)00256-9.
pub(crate) fn discrete_gradient(
    law: &dyn ContactLaw,
    at: &ContactPoint,
    gap_at_start: f64,
    advance: f64,
) -> (ContactTraction, Local) {
    let mut traction = law.traction(at);
    let start = ContactPoint { gap: gap_at_start, ..*at };
    let Some((from, to)) = law.energy_density(&start).zip(law.energy_density(at)) else {
        return (traction, Local::default());
    };
    let change = at.gap - gap_at_start;
    let (pressure, by_gap) = if change.abs() <= SMALLEST_CHANGE * at.size {
        let mean = law.traction(&ContactPoint { gap: at.gap - 0.5 * change, ..*at });
        (mean.value[0], 0.5 * mean.by_gap[0])
    } else {
        let slope = (to - from) / change;
        (slope, (traction.value[0] - slope) / change)
    };
    (traction.value[0], traction.by_gap[0]) = (pressure, by_gap);

    let (motion, difference) = ([advance, at.slip[0], at.slip[1]], change + advance);
    if difference.abs() <= SMALLEST_DIFFERENCE * at.size {
        return (traction, Local::default());
    }
    let squared: f64 = motion.iter().map(|component| component * component).sum();
    let smallest = (SMALLEST_CHANGE * at.size).powi(2);
    let is_bounded = difference * difference > squared.max(smallest);
    let largest = if is_bounded { difference * difference } else { squared.max(smallest) };
    let factor = -pressure * difference / largest;
    // Derivatives by the difference and by the components of the motion.
    let by_difference = if is_bounded { -factor } else { factor } / difference;
    let by_motion =
        if !is_bounded && squared > smallest { motion.map(|r| -2.0 * factor * r / largest) } else { [0.0; 3] };
    let factor_by_gap = by_difference - by_gap * difference / largest;
    let mut by_advance = motion.map(|component| (by_difference + by_motion[0]) * component);
    by_advance[0] += factor;
    for (i, component) in motion.iter().enumerate() {
        traction.value[i] += factor * component;
        traction.by_gap[i] += factor_by_gap * component;
        for k in 0..2 {
            traction.by_slip[k][i] += by_motion[k + 1] * component;
        }
    }
    for k in 0..2 {
        traction.by_slip[k][k + 1] += factor;
    }
    (traction, by_advance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NitscheLaw, PenaltyLaw};

    #[test]
    fn a_law_without_energy_acts_at_the_end() {
        let law = NitscheLaw::new(10.0, 0.1, 0.0).unwrap();
        let at = ContactPoint { gap: 0.09, stiffness: 20.0, stress: [-1.0, 0.0, 0.0], ..ContactPoint::default() };
        let found = discrete_gradient(&law, &at, 0.11, 0.0).0;
        assert!((found.value[0] + 3.0).abs() < 1e-12 && found == law.traction(&at), "{found:?}");
    }

    #[test]
    fn work_is_the_change_of_the_energy_whatever_the_motion() {
        let law = PenaltyLaw::new(1e3, 0.1).unwrap();
        let from = 0.05;
        let found = |gap: f64, [advance, slip @ ..]: Local| {
            let at = ContactPoint { gap, slip, size: 0.1, ..ContactPoint::default() };
            (law.energy_density(&at).unwrap(), discrete_gradient(&law, &at, from, advance))
        };
        let motions = [[0.02, 0.03, -0.01], [-0.05, 0.03, 0.1], [1e-3, 2e-3, 1e-3], [0.0; 3], [1e-9, -1e-9, 2e-9]];
        for (to, motion) in [0.02, 0.09, 0.2, 0.05 + 1e-9].into_iter().flat_map(|to| motions.map(|motion| (to, motion)))
        {
            let (energy, (traction, by_advance)) = found(to, motion);
            let work: f64 = traction.value.iter().zip(motion).map(|(force, motion)| force * motion).sum();
            let length = motion.iter().map(|r| r * r).sum::<f64>().sqrt();
            let difference = (to - from + motion[0]).abs();
            if difference < length && length > 1e-7 {
                assert!((work + energy - found(from, motion).0).abs() < 1e-12, "{to}: {work}");
            }
            // Contact pushes, with at most twice the traction of the law.
            let pressure = discrete_gradient(
                &law,
                &ContactPoint { gap: to, size: 0.1, ..ContactPoint::default() },
                from,
                from - to,
            );
            let correction = (0..3).map(|i| (traction.value[i] - pressure.0.value[i]).powi(2)).sum::<f64>().sqrt();
            assert!(traction.value[0] <= 0.0 && correction <= pressure.0.value[0].abs() * (1.0 + 1e-12));
            let step = 1e-8 * if length > 1e-7 { 1.0 } else { 0.01 };
            let derivatives = [traction.by_gap, by_advance, traction.by_slip[0], traction.by_slip[1]];
            for (k, derivative) in derivatives.iter().enumerate() {
                let value = |t: f64| {
                    let moved = std::array::from_fn(|i| motion[i] + if i + 1 == k { t } else { 0.0 });
                    found(to + if k == 0 { t } else { 0.0 }, moved).1.0.value
                };
                for (i, (right, left)) in value(step).iter().zip(value(-step)).enumerate() {
                    let slope = (right - left) / (2.0 * step);
                    let error = (derivative[i] - slope).abs();
                    assert!(error < 1e-4 * slope.abs().max(1e4), "{to} {motion:?} {k} {i}: {} {slope}", derivative[i]);
                }
            }
        }
    }

    #[test]
    fn work_is_the_change_of_the_energy_and_the_derivative_is_exact() {
        let law = PenaltyLaw::new(1e3, 0.1).unwrap();
        let point = |gap: f64| ContactPoint { gap, size: 0.1, ..ContactPoint::default() };
        let energy = |gap| law.energy_density(&point(gap)).unwrap();
        for (from, to) in
            [(0.05, 0.02), (0.12, 0.03), (0.03, 0.2), (0.2, 0.3), (0.05, 0.05 + 1e-9), (0.1 + 4e-6, 0.1 - 3e-6)]
        {
            let mean = discrete_gradient(&law, &point(to), from, from - to).0;
            let work = mean.value[0] * (to - from);
            assert!((work - (energy(to) - energy(from))).abs() < 1e-12, "{from} {to}: {work}");
            let step = 1e-7;
            let value = |gap| discrete_gradient(&law, &point(gap), from, from - gap).0.value[0];
            let slope = (value(to + step) - value(to - step)) / (2.0 * step);
            assert!((mean.by_gap[0] - slope).abs() < 1e-3 * 1e4, "{from} {to}: {} {slope}", mean.by_gap[0]);
        }
    }
}
