//! A bar that hits the floor, once and repeatedly.
//!
//! Source: Doyen, Ern and Piperno 2011, Time-integration schemes for the finite element dynamic Signorini problem,
//! doi:10.1137/100791440. Any consistent units; displacements and pressures are a tenth of those there.

mod history;

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;

use self::history::{
    Advance, BOUNCES, BarContact, BarHistory, GRAVITY, HEIGHT, HEIGHTS, IMPACT, LENGTH, MIDDLE, PENALTY, PERIOD, WAVE,
    exact_pressure, history,
};
use super::dry::{Scheme, second_order};
use super::record::worse;
use super::{Failure, Record, short};

/// Spectral radius of the generalised-α scheme.
const RHO_INF: f64 = 0.8;
/// Largest root of the mean squared deviation of the pressure in the middle of a contact, without mass on the floor: a
/// sixtieth of the pressure.
const LARGEST_DEVIATION: f64 = 0.5;
/// Smallest number of cells for which these bounds hold.
const RESOLVED: usize = 100;
/// Largest change of the height after all periods.
const HEIGHT_CHANGE: f64 = 0.01;
// Periods after which energy is compared, and cells of the bars for that.
const PERIODS: u32 = 10;
const LONG: [usize; 3] = [50, 100, 200];

/// Returns the Courant number for which the leading error in the speed of waves vanishes: that of linear elements with
/// their consistent mass, `+(k h)²/24`, and that of generalised-α, `-(ω Δt)² (1/12 + 3 r²/8)` with `r = (1-ρ)/(1+ρ)`,
/// cancel. (Both are expansions of the dispersion relations of the discrete wave equation.)
fn undispersed(rho_inf: f64) -> f64 {
    let r = (1.0 - rho_inf) / (1.0 + rho_inf);
    (2.0 + 9.0 * r * r).sqrt().recip()
}

/// A way to advance the bar.
struct Method {
    name: &'static str,
    scheme: Scheme,
    /// Fraction of a cell that a wave crosses in a step.
    courant: f64,
    /// Whether the nodes on the floor have no mass.
    is_massless: bool,
    /// Whether the bounds apply to this method.
    is_gated: bool,
    is_second_order: bool,
}

impl Method {
    fn advance(&self) -> Advance<'_> {
        Advance { scheme: &self.scheme, is_massless: self.is_massless, courant: self.courant }
    }
}

/// Largest errors of the times at which contacts begin and end, and of the last touch, in steps.
#[derive(Clone, Copy, Default)]
struct Late {
    /// Errors of the impact and the first bounce.
    first: f64,
    second: f64,
    last_touch: f64,
}

/// Records the contacts of a bar of `n` cells with the exact ones as reference; returns the history with gravity, and
/// the error of the last event. Updates `most`.
fn contacts(record: &mut Record, n: usize, method: &Method, most: &mut Late) -> Result<(BarHistory, f64), Failure> {
    let Method { name, courant, is_massless, is_gated, .. } = *method;
    let step = courant * LENGTH / n as f64 / WAVE;
    let impact = history(0.0, n, &method.advance(), 2.0)?;
    let bounce = history(GRAVITY, n, &method.advance(), PERIOD)?;
    let mut late = f64::NAN;
    for (what, history, exact, is_first) in [
        ("impact", &impact, &IMPACT, true),
        ("first bounce", &bounce, &BOUNCES[0], true),
        ("second bounce", &bounce, &BOUNCES[1], false),
    ] {
        let what = format!("{n} cells, {name}, {what}");
        let BarContact { times, touching, pressure, deviation, oscillation } = history.contact(exact);
        for (k, event) in ["begins", "ends"].into_iter().enumerate() {
            late = times[k] - exact.times[k];
            let most_of_event = if is_first { &mut most.first } else { &mut most.second };
            *most_of_event = worse(*most_of_event, (late / step).abs());
            let quantity = format!("{what} {event}: steps late");
            if is_gated && is_first {
                record.near(quantity, late / step, 0.0, 1.0)
            } else {
                record.show(quantity, late / step, Some(0.0))
            }
        }
        let late_touch = (touching - exact.times[1]) / step;
        most.last_touch = worse(most.last_touch, late_touch.abs());
        record.show(format!("{what}: last touch, steps late"), late_touch, Some(0.0));
        let quantity = format!("{what}: mean pressure");
        if is_gated {
            record.near_relative(quantity, pressure, exact.mean(), 0.02)
        } else {
            record.show(quantity, pressure, Some(exact.mean()))
        }
        let quantity = format!("{what}: pressure off the exact one in its middle (RMS)");
        if is_massless && n >= RESOLVED {
            record.at_most(quantity, deviation, LARGEST_DEVIATION);
        } else {
            record.show(quantity, deviation, Some(0.0));
        }
        record.show(format!("{what}: half the range of that"), oscillation, Some(0.0));
    }
    let height = bounce.height.last().map_or(f64::NAN, |at| at.1);
    record.show(format!("{n} cells, {name}: height after a period"), height, Some(HEIGHT));
    let error = bounce.height_error();
    record.show(format!("{n} cells, {name}: error of the height at the listed times (RMS)"), error, Some(0.0));
    Ok((bounce, late.abs()))
}

/// Records the energy of a bar of `n` cells after many periods and the number of its contacts; returns the energy.
fn long(record: &mut Record, n: usize, method: &Method) -> Result<Vec<(f64, f64)>, Failure> {
    let Method { name, is_massless, .. } = *method;
    let long = history(GRAVITY, n, &method.advance(), f64::from(PERIODS) * PERIOD)?;
    let what = format!("{n} cells, {name}, {PERIODS} periods");
    record.show(format!("{what}: energy at the end over that at the start"), long.kept(), Some(1.0));
    record.show(format!("{what}: contacts that begin"), long.contacts() as f64, Some(f64::from(2 * PERIODS)));
    let (quantity, height) = (format!("{what}: height at the end"), long.height.last().map_or(f64::NAN, |at| at.1));
    if is_massless && n >= RESOLVED {
        record.near_relative(quantity, height, HEIGHT, HEIGHT_CHANGE);
    } else {
        record.show(quantity, height, Some(HEIGHT));
    }
    Ok(long.energy)
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let (cells, n) = if record.full { (&[25, 50, 100, 200][..], 200) } else { (&[25, 50][..], 50) };
    let euler: Scheme = Arc::new(ImplicitEuler);
    let second = second_order(RHO_INF)?;
    let midpoint = second_order(1.0)?;
    let methods = [
        ("implicit Euler", &euler, 1.0, [false, false, false]),
        ("generalised-α, step h/c", &second, 1.0, [false, false, true]),
        ("generalised-α", &second, undispersed(RHO_INF), [false, true, true]),
        ("midpoint rule, no mass on the floor, step h/c", &midpoint, 1.0, [true, false, true]),
        ("midpoint rule, no mass on the floor", &midpoint, undispersed(1.0), [true, false, true]),
    ]
    .map(|(name, scheme, courant, [is_massless, is_gated, is_second_order])| {
        let scheme = Arc::clone(scheme);
        Method { name, scheme, courant, is_massless, is_gated, is_second_order }
    });
    let exact = |points: Vec<(f64, f64)>| vec![("exact".to_owned(), points)];
    let mut curves = [exact(HEIGHTS.to_vec()), exact(exact_pressure()), Vec::new()];
    for method in &methods {
        let (mut errors, mut most) = (Vec::new(), Late::default());
        for &n in cells {
            let (BarHistory { height, pressure, .. }, error) = contacts(record, n, method, &mut most)?;
            errors.push((LENGTH / n as f64, error));
            if Some(&n) == cells.last() {
                curves[0].push((method.name.to_owned(), height));
                curves[1].push((method.name.to_owned(), pressure));
            }
        }
        if method.is_second_order {
            let Late { first, second, last_touch } = most;
            for (what, late) in
                [("impact and first bounce", first), ("second bounce", second), ("last touches", last_touch)]
            {
                record.at_most(format!("{}, all meshes, {what}: most steps late or early", method.name), late, 1.0);
            }
        }
        record.show_order(&format!("error of the time when the second bounce ends, {}", method.name), "h", &errors);
    }
    for (name, scheme) in [("implicit Euler", &euler), ("generalised-α", &second)] {
        for courant in [2.0, 1.0, 0.5] {
            let advance = Advance { scheme, is_massless: false, courant };
            let loss = 1.0 - history(0.0, n, &advance, 2.0)?.kept();
            record.show(format!("{name}, step {courant} h/c: energy lost in the impact"), loss, Some(0.0));
        }
        let mut loss = Vec::new();
        for courant in [2.0, 1.0, 0.5] {
            let advance = Advance { scheme, is_massless: false, courant };
            loss.push(1.0 - history(GRAVITY, n, &advance, PERIOD)?.kept());
            let quantity = format!("{name}, step {courant} h/c: energy lost in a period");
            record.at_least(quantity, loss[loss.len() - 1], 0.0);
        }
        record.at_most(format!("{name}: energy lost in a period, finest over coarsest step"), loss[2] / loss[0], 1.0);
    }
    if record.full {
        for method in &methods {
            for n in LONG {
                let energy = long(record, n, method)?;
                if n == LONG[LONG.len() - 1] {
                    curves[2].push((method.name.to_owned(), energy));
                }
            }
        }
    }
    let titles = ["height of the lower end", "floor pressure", "energy over that at the start"];
    for (title, curves) in titles.into_iter().zip(curves).filter(|(_, curves)| !curves.is_empty()) {
        record.figure(title, "t", curves);
    }
    record.note(format!(
        "Penalty {PENALTY} E/h, generalised-α with rho_inf = {RHO_INF}. Linear elasticity: the exact solution is that of the linear bar. Height, gravity and speed are a tenth of those of the source, \
         in which strains are 0.56 in a bounce, and later vibrations turn cells inside out; being linear, the problem has the same times. Its pressure jumps when a contact begins and ends. The mesh smears the jump over a few cells, and an event is \
         where the pressure passes half of the jump; the last touch is later. \
         With the step h/c waves are too slow by (k h)²/21.6, and the width of a smeared front, in steps, grows with the third root of the \
         number of cells: the first bounce of a fine bar ends more than a step late. \
         The gated rows use the step {:.3} h/c, with which the leading errors of elements and time scheme in the speed of waves \
         cancel; what is left grows with the fifth root. Late events also suffer from the energy that every contact costs. \
         The pressure is compared with the exact one, constant in the impact and linear in the bounces, in the middle {} % of the contacts; \
         times of listed heights are those of waves, and both contacts. A contact that does not end when the exact one does leaves \
         vibrations in the bar, and after some periods it comes upon the floor several times in a bounce; every time costs energy.",
        undispersed(RHO_INF),
        short(100.0 * MIDDLE),
    ));
    Ok(())
}
