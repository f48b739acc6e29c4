//! Evaluation of sampled signals and curves.

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the root mean square.
pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Returns the least and the largest value.
pub(super) fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)])
}

/// Returns the abscissa at which the straight line through two points reaches a height.
pub(super) fn passage([a, b]: [(f64, f64); 2], height: f64) -> f64 {
    a.0 + (b.0 - a.0) * (height - a.1) / (b.1 - a.1)
}

/// Returns where a curve passes a height upwards: the index of the first point that is not below, and the abscissa.
pub(super) fn rises(curve: &[(f64, f64)], height: f64) -> Vec<(usize, f64)> {
    let is_rise = |k: &usize| curve[k - 1].1 < height && curve[*k].1 >= height;
    (1..curve.len()).filter(is_rise).map(|k| (k, passage([curve[k - 1], curve[k]], height))).collect()
}

/// Returns the highest point of a curve with equal steps: the vertex of a parabola through three points, if it is
/// between them.
pub(super) fn peak(curve: &[(f64, f64)]) -> (f64, f64) {
    curve.windows(3).fold((f64::NAN, f64::NEG_INFINITY), |highest, w| {
        let (slope, curvature) = (0.5 * (w[2].1 - w[0].1), w[2].1 - 2.0 * w[1].1 + w[0].1);
        let steps = Some(-slope / curvature).filter(|steps| steps.abs() <= 1.0).unwrap_or(0.0);
        let vertex = (w[1].0 + steps * (w[2].0 - w[1].0), w[1].1 + 0.5 * steps * slope);
        if vertex.1 > highest.1 { vertex } else { highest }
    })
}

/// Returns the curve with negative values.
pub(super) fn negative(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    curve.iter().map(|&(x, y)| (x, -y)).collect()
}

/// Returns a curve in its last cycles, with the abscissa from their begin. Cycles are those between passages, as
/// [`rises`] returns them.
pub(super) fn last_cycles(curve: &[(f64, f64)], passages: &[(usize, f64)], n_cycles: usize) -> Vec<(f64, f64)> {
    let (first, begin) = passages[passages.len().saturating_sub(n_cycles + 1)];
    curve[first..].iter().map(|(x, value)| (x - begin, *value)).collect()
}

/// Returns half of the sum and of the difference of the largest and the least value of a curve with equal steps.
pub(super) fn mean_and_amplitude(curve: &[(f64, f64)]) -> [f64; 2] {
    let (low, high) = (-peak(&negative(curve)).1, peak(curve).1);
    [0.5 * (high + low), 0.5 * (high - low)]
}

/// Returns whether values differ by at most a fraction of their mean.
pub(super) fn is_steady(values: impl Iterator<Item = f64>, fraction: f64) -> bool {
    let values: Vec<f64> = values.collect();
    let [least, largest] = range(&values);
    largest - least <= fraction * mean(&values).abs()
}

/// Returns the number between two others at which a condition becomes true, by bisection.
pub(super) fn bisect([mut low, mut high]: [f64; 2], is_above: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_above(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Returns the differences of the values to parabolas, each fitted to a value and `wing` neighbours on either side.
///
/// Source: Savitzky and Golay 1964, doi:10.1021/ac60214a047.
pub(super) fn rough(values: &[f64], wing: usize) -> Vec<f64> {
    let offsets = || (0..=2 * wing).map(|k| k as f64 - wing as f64);
    let n = offsets().count() as f64;
    let moment = |power: i32| offsets().map(|k| k.powi(power)).sum::<f64>();
    let (second, fourth) = (moment(2), moment(4));
    let weights: Vec<f64> = offsets().map(|k| (fourth - second * k * k) / (n * fourth - second * second)).collect();
    let smooth = |window: &[f64]| window.iter().zip(&weights).map(|(v, w)| v * w).sum::<f64>();
    values.windows(2 * wing + 1).map(|window| window[wing] - smooth(window)).collect()
}

/// Returns the slope of a curve in logarithms, by linear regression.
pub(super) fn slope(curve: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = curve.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let (xy, xx) = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x).powi(2)));
    xy / xx
}

/// Returns 1 if the second numbers of a curve decrease from point to point, else 0.
pub(super) fn falls(curve: &[(f64, f64)]) -> f64 {
    f64::from(curve.windows(2).all(|w| w[1].1 < w[0].1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_no_noise() {
        let values: Vec<f64> = (0..30).map(f64::from).map(|k| 3.0 - 0.2 * k + 0.01 * k * k).collect();
        assert!(rms(&rough(&values, 5)) < 1e-13);
    }

    #[test]
    fn noise_is_found_on_a_smooth_signal() {
        // Share of an alternating sign in the fit to eleven values, with weights (-36, 9, 44, 69, 84, 89, ...)/429.
        let kept = (89.0 - 2.0 * (84.0 - 69.0 + 44.0 - 9.0 - 36.0)) / 429.0;
        let values: Vec<f64> =
            (0..200).map(|k| f64::from(k % 2 * 2 - 1) * 1e-2 + (f64::from(k) * 0.03).sin()).collect();
        let expected = 1e-2 * (1.0 - kept);
        assert!((rms(&rough(&values, 5)) / expected - 1.0).abs() < 1e-3, "{} {expected}", rms(&rough(&values, 5)));
    }

    #[test]
    fn peaks_and_rises_lie_between_the_points() {
        let curve: Vec<_> = (0..20).map(|k| 0.25 * f64::from(k)).map(|x| (x, 2.0 - (x - 3.1) * (x - 3.1))).collect();
        let (x, y) = peak(&curve);
        assert!((x - 3.1).abs() < 1e-12 && (y - 2.0).abs() < 1e-12, "{x} {y}");
        // Between the points (1.5, -0.56) and (1.75, 0.1775).
        let [(7, x)] = rises(&curve, 0.0)[..] else { panic!("one rise") };
        assert!((x - (1.5 + 0.25 * 0.56 / 0.7375)).abs() < 1e-12, "{x}");
    }

    #[test]
    fn the_slope_is_the_power() {
        assert!((slope(&[(0.4, 0.16), (0.2, 0.04), (0.1, 0.01)]) - 2.0).abs() < 1e-12);
    }
}
