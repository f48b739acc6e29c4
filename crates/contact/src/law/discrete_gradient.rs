//! The traction of a law over a step, such that its work is the change of the stored energy.

use super::{ContactLaw, ContactPoint, ContactTraction};

/// Change of the gap, relative to the contact size, below which the law is evaluated at the mean gap instead. Above it,
/// the relative round-off in the derivative of the quotient is below `1e-16/1e-12`.
const SMALLEST_CHANGE: f64 = 1e-6;

/// Returns `λ = (W(Δ^{n+1}) - W(Δ^n))/(Δ^{n+1} - Δ^n)` with its derivative by `Δ^{n+1}`
///
/// `at` is the point at the end of the step. A law without energy is evaluated at the end. At the mean of the gaps at
/// start and end, a stiff law would prescribe this mean only, and the gap would alternate from step to step.
///
/// Source: Gonzalez 2000, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity,
/// doi:10.1016/S0045-7825(00)00189-4; for contact, Armero and Petocz 1998, doi:10.1016/S0045-7825(97)00256-9.
pub(crate) fn discrete_gradient(law: &dyn ContactLaw, at: &ContactPoint, gap_at_start: f64) -> ContactTraction {
    let change = at.gap - gap_at_start;
    let start = ContactPoint { gap: gap_at_start, ..*at };
    let Some((from, to)) = law.energy_density(&start).zip(law.energy_density(at)) else {
        return law.traction(at);
    };
    if change.abs() <= SMALLEST_CHANGE * at.size {
        let mut mean = law.traction(&ContactPoint { gap: at.gap - 0.5 * change, ..*at });
        mean.by_gap = mean.by_gap.map(|derivative| 0.5 * derivative);
        return mean;
    }
    let end = law.traction(at);
    let (mut mean, slope) = (end, (to - from) / change);
    mean.by_gap[0] = (end.value[0] - slope) / change;
    mean.value[0] = slope;
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NitscheLaw, PenaltyLaw};

    #[test]
    fn a_law_without_energy_acts_at_the_end() {
        let law = NitscheLaw::new(10.0, 0.1, 0.0).unwrap();
        let at = ContactPoint { gap: 0.09, stiffness: 20.0, stress: [-1.0, 0.0, 0.0], ..ContactPoint::default() };
        let found = discrete_gradient(&law, &at, 0.11);
        assert!((found.value[0] + 3.0).abs() < 1e-12 && found == law.traction(&at), "{found:?}");
    }

    #[test]
    fn work_is_the_change_of_the_energy_and_the_derivative_is_exact() {
        let law = PenaltyLaw::new(1e3, 0.1).unwrap();
        let point = |gap: f64| ContactPoint { gap, size: 0.1, ..ContactPoint::default() };
        let energy = |gap| law.energy_density(&point(gap)).unwrap();
        for (from, to) in
            [(0.05, 0.02), (0.12, 0.03), (0.03, 0.2), (0.2, 0.3), (0.05, 0.05 + 1e-9), (0.1 + 4e-6, 0.1 - 3e-6)]
        {
            let mean = discrete_gradient(&law, &point(to), from);
            let work = mean.value[0] * (to - from);
            assert!((work - (energy(to) - energy(from))).abs() < 1e-12, "{from} {to}: {work}");
            let step = 1e-7;
            let value = |gap| discrete_gradient(&law, &point(gap), from).value[0];
            let slope = (value(to + step) - value(to - step)) / (2.0 * step);
            assert!((mean.by_gap[0] - slope).abs() < 1e-3 * 1e4, "{from} {to}: {} {slope}", mean.by_gap[0]);
        }
    }
}
