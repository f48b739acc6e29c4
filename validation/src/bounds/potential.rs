//! A rigid disk that falls through an ideal fluid onto a wall: a lower bound of all contact times.

/// Gap over the wall in cm, and added mass over the mass of the disk, in the box of the paper with no pressure on its
/// open sides: radius 4, box (-10, 10) x (0, 15), from a boundary-element solution of potential flow.
const ADDED_MASS: [(f64, f64); 12] = [
    (0.05, 1.892_26),
    (0.1, 1.791_50),
    (0.2, 1.663_67),
    (0.5, 1.453_32),
    (0.7, 1.366_30),
    (1.0, 1.270_26),
    (1.5, 1.158_14),
    (2.0, 1.077_26),
    (3.0, 0.959_18),
    (4.0, 0.865_81),
    (5.0, 0.777_51),
    (6.0, 0.682_12),
];
/// Gravity, cm/s^2.
const GRAVITY: f64 = 1e3;
/// Number of intervals of the integration.
const INTERVALS: usize = 600;

/// Returns the gap in which the ball of a scenario (its TOML text) starts, and that at which contact begins; `None` if
/// the table of added masses does not hold for it.
pub(crate) fn gaps(scenario: &str) -> Option<(f64, f64)> {
    let scenario: toml::Table = scenario.parse().ok()?;
    // Numbers are written with or without a decimal point.
    let number = |value: &toml::Value| value.clone().try_into::<f64>().ok();
    let height = |value: &toml::Value, key: &str| number(value.get(key)?.as_array()?.last()?);
    let contact = scenario.get("contact")?.as_array()?.first()?;
    let bodies = scenario.get("body")?.as_array()?;
    let shape = |name: &toml::Value| bodies.iter().find(|body| body.get("name") == Some(name))?.get("shape");
    let ball = shape(contact.get("body")?)?;
    let radius = number(ball.get("radius")?)?;
    let obstacle = contact.get("obstacle")?;
    let ground = match obstacle.get("name") {
        Some(name) => height(shape(name)?, "max")?,
        None => height(obstacle, "point")?,
    };
    // The table is that of one radius.
    (radius == 4.0).then_some((height(ball, "centre")? - radius - ground, number(contact.get("offset")?)?))
}

/// A moment of the fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Falling {
    /// Time since the start from rest, s.
    pub(crate) time: f64,
    /// Gap, cm.
    pub(crate) gap: f64,
    /// Speed, cm/s.
    pub(crate) speed: f64,
}

/// Returns the added mass over the mass of the disk at a gap, with a monotone cubic in the logarithm of the gap;
/// constant outside of the table.
pub(crate) fn added_mass(gap: f64) -> f64 {
    let table = ADDED_MASS.map(|(gap, mass)| (gap.ln(), mass));
    let last = table.len() - 1;
    let x = gap.ln().clamp(table[0].0, table[last].0);
    let k = table.iter().rposition(|(at, _)| *at <= x).unwrap_or(0).min(last - 1);
    let secant = |k: usize| (table[k + 1].1 - table[k].1) / (table[k + 1].0 - table[k].0);
    // Fritsch and Butland: the harmonic mean of neighbouring secants keeps the interpolant monotone.
    let slope = |k: usize| match k {
        0 => secant(0),
        k if k == last => secant(last - 1),
        k => {
            let (a, b) = (secant(k - 1), secant(k));
            if a * b <= 0.0 { 0.0 } else { 2.0 * a * b / (a + b) }
        }
    };
    let h = table[k + 1].0 - table[k].0;
    let t = (x - table[k].0) / h;
    let (value, next) = (table[k].1, table[k + 1].1);
    let begin = value * (1.0 + 2.0 * t) * (1.0 - t).powi(2) + h * slope(k) * t * (1.0 - t).powi(2);
    begin + next * t * t * (3.0 - 2.0 * t) + h * slope(k + 1) * t * t * (t - 1.0)
}

/// Computes the fall from rest at a gap down to another one.
///
/// `(m + M) y'' + M'/2 y'^2 = -m g` keeps the energy `(m + M)/2 y'^2 + m g y`, so the speed is known at every gap; with
/// `gap = start - s^2` the time is the integral of a smooth function of `s`, taken with Simpson's rule.
pub(crate) fn fall(start: f64, end: f64) -> Vec<Falling> {
    let longest = (start - end).max(0.0).sqrt();
    let step = longest / INTERVALS as f64;
    let mass = |s: f64| 1.0 + added_mass(start - s * s);
    let rate = |s: f64| (2.0 * mass(s) / GRAVITY).sqrt();
    let mut time = 0.0;
    let moment = |s: f64, time: f64| Falling { time, gap: start - s * s, speed: s * (2.0 * GRAVITY / mass(s)).sqrt() };
    let mut moments = vec![moment(0.0, 0.0)];
    for k in 0..INTERVALS {
        let (a, b) = (k as f64 * step, (k + 1) as f64 * step);
        time += step / 6.0 * (rate(a) + 4.0 * rate(0.5 * (a + b)) + rate(b));
        moments.push(moment(b, time));
    }
    moments
}

/// Returns the end of a fall.
pub(crate) fn arrival(start: f64, end: f64) -> Falling {
    let moments = fall(start, end);
    moments[moments.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_read_from_scenarios() {
        let read =
            |name: &str| std::fs::read_to_string(crate::case::scenario_path(name)).ok().as_deref().and_then(gaps);
        assert_eq!(read("virtual-barrier"), Some((6.0, 3.0)));
        assert!(read("rigid-ground").is_some_and(|(start, offset)| start > offset && offset > 0.0));
        assert!(read("flexible-ground").is_some_and(|(start, offset)| start > offset && offset > 0.0));
        assert_eq!(gaps("name = \"no contact\""), None);
    }

    #[test]
    fn the_added_mass_meets_its_table_and_falls_with_the_gap() {
        for (gap, mass) in ADDED_MASS {
            assert!((added_mass(gap) - mass).abs() < 1e-12);
        }
        // Numbers of another computation between the points of the table.
        for (gap, mass) in [(0.6, 1.407), (0.3, 1.576)] {
            assert!((added_mass(gap) - mass).abs() < 3e-3, "{gap}: {}", added_mass(gap));
        }
        let values: Vec<f64> = (1..=600).map(|k| added_mass(0.01 * f64::from(k))).collect();
        assert!(values.windows(2).all(|pair| pair[1] <= pair[0]));
    }

    #[test]
    fn times_and_speeds_are_those_of_an_independent_integration() {
        let known =
            [(6.0, 3.0, 0.1032, 55.3), (6.0, 0.1, 0.1492, 65.0), (3.0, 0.1, 0.1106, 45.6), (1.0, 0.1, 0.0656, 25.4)];
        for (start, end, time, speed) in known.into_iter().chain([(1.0, 0.05, 0.0675, 25.6)]) {
            let Falling { time: t, speed: v, .. } = arrival(start, end);
            assert!((t - time).abs() < 1e-3 && (v - speed).abs() < 0.2, "{start} to {end}: {t} s, {v} cm/s");
        }
    }

    #[test]
    fn without_added_mass_it_would_fall_freely() {
        // Early, the acceleration is g/(1 + C).
        let early = fall(6.0, 5.99)[INTERVALS];
        let acceleration = early.speed / early.time;
        assert!((acceleration - GRAVITY / (1.0 + added_mass(6.0))).abs() < 1.0, "{acceleration}");
    }
}
