//! The limit of a sequence of numbers.

/// The limit of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limit {
    pub(super) value: f64,
    /// Half of the width of the interval that should contain the limit.
    pub(super) uncertainty: f64,
    /// Observed order; `None` where the differences do not shrink or change sign.
    pub(super) order: Option<f64>,
    /// Whether the differences between the members of the sequence shrink.
    pub(super) shrinks: bool,
}

/// Range of orders to which observed ones are limited.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Safety factors of the uncertainty: where the differences shrink, and where they do not.
const SAFETY: [f64; 2] = [1.25, 3.0];
/// Largest relative deviation of the ratio of the sizes from a constant.
const SAME_RATIO: f64 = 1e-6;

/// Returns the limit of `t(h)` for `h` to zero by Richardson extrapolation of the last three of `(h, t)`, which must
/// have a constant ratio; the observed order is limited to [`ORDERS`], and the uncertainty is that of the
/// grid convergence index (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413, doi:10.1115/1.2910291).
///
/// Where differences grow or change sign there is no order: the limit is the last member, with three times the largest
/// difference as uncertainty.
pub(super) fn richardson(sequence: &[(f64, f64)]) -> Option<Limit> {
    let [.., (h1, t1), (h2, t2), (h3, t3)] = *sequence else { return None };
    let ratio = h2 / h3;
    if ratio <= 1.0 || (h1 / h2 / ratio - 1.0).abs() > SAME_RATIO {
        return None;
    }
    let differences: Vec<f64> = sequence.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).collect();
    let shrinks = differences.windows(2).all(|pair| pair[1] < pair[0]);
    let (before, last) = (t2 - t1, t3 - t2);
    if before * last <= 0.0 || last.abs() >= before.abs() {
        let uncertainty = SAFETY[1] * before.abs().max(last.abs());
        return Some(Limit { value: t3, uncertainty, order: None, shrinks });
    }
    let order = (before / last).ln() / ratio.ln();
    let step = last / (ratio.powf(order.clamp(*ORDERS.start(), *ORDERS.end())) - 1.0);
    Some(Limit { value: t3 + step, uncertainty: SAFETY[0] * step.abs(), order: Some(order), shrinks })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_the_size_is_extrapolated_exactly() {
        for order in [0.6, 1.0, 1.9] {
            let sequence = [0.4, 0.2, 0.1, 0.05].map(|h: f64| (h, 0.3 + 2.0 * h.powf(order)));
            let limit = richardson(&sequence).unwrap();
            assert!((limit.value - 0.3).abs() < 1e-12 && (limit.order.unwrap() - order).abs() < 1e-10, "{limit:?}");
            assert!(limit.shrinks && limit.uncertainty >= 0.3 - limit.value);
        }
    }

    #[test]
    fn an_unbelievable_order_is_limited() {
        let sequence = [0.4, 0.2, 0.1].map(|h: f64| (h, h.powi(4)));
        let limit = richardson(&sequence).unwrap();
        let last = 0.1_f64.powi(4) - 0.2_f64.powi(4);
        assert!((limit.value - (0.1_f64.powi(4) + last / 3.0)).abs() < 1e-15);
    }

    #[test]
    fn no_order_where_differences_grow_or_change_sign() {
        for third in [1.5, 4.0] {
            let limit = richardson(&[(0.4, 1.0), (0.2, 2.0), (0.1, third)]).unwrap();
            assert!(limit.order.is_none() && limit.value == third && limit.uncertainty >= 3.0, "{limit:?}");
        }
        assert!(!richardson(&[(0.4, 1.0), (0.2, 2.0), (0.1, 4.0)]).unwrap().shrinks);
    }

    #[test]
    fn sizes_without_a_constant_ratio_have_no_limit() {
        assert!(richardson(&[(0.4, 1.0), (0.2, 2.0), (0.15, 4.0)]).is_none());
        assert!(richardson(&[(0.4, 1.0), (0.2, 2.0)]).is_none());
    }
}
