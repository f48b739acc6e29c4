//! A bar that hits the floor, once and again and again.
//!
//! Source: Doyen, Ern and Piperno 2011, Time-integration schemes for the finite element dynamic Signorini problem,
//! doi:10.1137/100791440. Any consistent units.

use std::path::Path;
use std::sync::Arc;

use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LameParameters, LinearElastic, TimeScheme};
use cutwater::solver::SupportKind;

use super::Failure;
use super::dry::{Run, V, elastic, floor, hold, second_order};
use super::record::{Figure, Record};

const LENGTH: f64 = 10.0;
const YOUNG: f64 = 900.0;
const DENSITY: f64 = 1.0;
const HEIGHT: f64 = 5.0;
const GRAVITY: f64 = 10.0;
/// Speed of both impacts.
const SPEED: f64 = 10.0;
/// Speed of waves, and the time in which they cross the bar.
const WAVE: f64 = 30.0;
const CROSSING: f64 = LENGTH / WAVE;
/// The contact without gravity, and the two of a period with it.
const IMPACT: Exact = Exact { times: [0.5, 7.0 / 6.0], pressure: [300.0, 300.0] };
const BOUNCES: [Exact; 2] = [
    Exact { times: [1.0, 5.0 / 3.0], pressure: [300.0, 500.0] },
    Exact { times: [11.0 / 3.0, 13.0 / 3.0], pressure: [500.0, 300.0] },
];
const PERIOD: f64 = 16.0 * CROSSING;
/// The number of steps in which a wave crosses a cell, inverted, for which the leading error in the speed of waves vanishes: that
/// of linear elements with their consistent mass, `+(k h)²/24`, and that of generalised-α, `-(ω Δt)² (1/12 + 3 r²/8)` with
/// `r = (1-ρ)/(1+ρ)`, cancel. (Both are expansions of the dispersion relations of the discrete wave equation.)
fn undispersed(rho_inf: f64) -> f64 {
    let r = (1.0 - rho_inf) / (1.0 + rho_inf);
    (2.0 + 9.0 * r * r).sqrt().recip()
}

/// Pressure over penetration beside Young's modulus over the size of a cell.
const PENALTY: f64 = 10.0;
/// Spectral radius of the generalised-α scheme.
const RHO_INF: f64 = 0.8;

/// An exact contact: its beginning and end, and the pressure that sets in and that ceases there; between them it is linear.
struct Exact {
    times: [f64; 2],
    pressure: [f64; 2],
}

impl Exact {
    fn mean(&self) -> f64 {
        0.5 * (self.pressure[0] + self.pressure[1])
    }
}

/// The bar at the ends of the steps.
struct History {
    /// Time and floor pressure of each step.
    pressure: Vec<(f64, f64)>,
    /// Time and height of the lower end.
    height: Vec<(f64, f64)>,
    /// Energy at the end over that at the start, measured from the bar at rest on the floor.
    energy: f64,
}

/// The bar of `n` cells, with a time step in which a wave crosses `courant` of a cell.
fn history(gravity: f64, n: usize, courant: f64, scheme: TimeScheme, end: f64) -> Result<History, Failure> {
    let size = LENGTH / n as f64;
    let mesh = structured_box::<2>([0.0, HEIGHT], [size, HEIGHT + LENGTH], [1, n])?;
    // Without lateral contraction a bar between smooth walls is a bar in one dimension.
    let material = LinearElastic::new(LameParameters::from_young_poisson(YOUNG, 0.0)?);
    let mut body = elastic(mesh, DENSITY, material, V::new(0.0, -gravity), scheme)?;
    for side in ["left", "right"] {
        hold(&mut body, side, SupportKind::Symmetry { axis: 0 })?;
    }
    if gravity == 0.0 {
        body.initial_velocity = Some(Arc::new(|_| V::new(0.0, -SPEED)));
    }
    let contact = floor(&body, "bottom", PENALTY * YOUNG / size)?;
    let dt = courant * size / WAVE;
    let mut run = Run::new(vec![body], vec![contact], dt, 1e-9);
    // Potential energy of the bar that rests on the floor.
    let rest = size * DENSITY * gravity * 0.5 * LENGTH * LENGTH;
    let start = run.energy_and_momentum()?.0 - rest;
    let (mut pressure, mut height) = (Vec::new(), Vec::new());
    while run.state.time < end - 0.5 * dt {
        let report = run.advance()?;
        pressure.push((run.state.time, report.contacts[0].force[1] / size));
        height.push((run.state.time, HEIGHT + run.state.bodies[0].displacement[0][1]));
    }
    let energy = (run.energy_and_momentum()?.0 - rest) / start;
    Ok(History { pressure, height, energy })
}

/// A contact of the bar with the floor.
struct Contact {
    /// Times at which the pressure passes half of what sets in and of what ceases: where it jumps, and the mesh smears the jump.
    times: [f64; 2],
    /// Last time at which there is any pressure.
    touching: f64,
    /// Impulse over the exact duration.
    pressure: f64,
}

impl History {
    /// A contact, from the steps within a crossing time of the exact one.
    fn contact(&self, exact: &Exact) -> Contact {
        let [begin, end] = exact.times;
        let around = |at: &&(f64, f64)| begin - CROSSING < at.0 && at.0 < end + CROSSING;
        let steps: Vec<(f64, f64)> = self.pressure.iter().filter(around).copied().collect();
        let [low, high] = exact.pressure.map(|jump| 0.5 * jump);
        // Between two steps the pressure counts as linear.
        let passage = |w: &[(f64, f64)], p: f64| w[0].0 + (w[1].0 - w[0].0) * (p - w[0].1) / (w[1].1 - w[0].1);
        let first = steps.windows(2).find(|w| w[0].1 <= low && low < w[1].1).map(|w| passage(w, low));
        let last = steps.windows(2).rfind(|w| w[0].1 > high && high >= w[1].1).map(|w| passage(w, high));
        let touching = steps.iter().rfind(|at| at.1 > 0.0).map_or(f64::NAN, |at| at.0);
        let dt = self.pressure[1].0 - self.pressure[0].0;
        let impulse: f64 = steps.iter().map(|at| at.1 * dt).sum();
        Contact { times: [first, last].map(|t| t.unwrap_or(f64::NAN)), touching, pressure: impulse / (end - begin) }
    }
}

/// A way to advance the bar.
struct Method {
    name: &'static str,
    scheme: TimeScheme,
    /// Of a cell, what a wave crosses in a step.
    courant: f64,
    /// Whether it is asked to meet the exact solution.
    is_gated: bool,
}

/// Shows the contacts of a bar of `n` cells beside the exact ones; returns the history with gravity, and the error of the last
/// event.
fn contacts(record: &mut Record, n: usize, method: &Method) -> Result<(History, f64), Failure> {
    let Method { name, scheme, courant, is_gated } = *method;
    let step = courant * LENGTH / n as f64 / WAVE;
    let impact = history(0.0, n, courant, scheme, 2.0)?;
    let bounce = history(GRAVITY, n, courant, scheme, PERIOD)?;
    let mut late = f64::NAN;
    for (what, history, exact, is_first) in [
        ("impact", &impact, &IMPACT, true),
        ("first bounce", &bounce, &BOUNCES[0], true),
        ("second bounce", &bounce, &BOUNCES[1], false),
    ] {
        let what = format!("{n} cells, {name}, {what}");
        let Contact { times, touching, pressure } = history.contact(exact);
        for (k, event) in ["begins", "ends"].into_iter().enumerate() {
            late = times[k] - exact.times[k];
            let quantity = format!("{what} {event}: steps late");
            if is_gated && is_first {
                record.near(quantity, late / step, 0.0, 1.0)
            } else {
                record.show(quantity, late / step, Some(0.0))
            }
        }
        record.show(format!("{what}: last touch, steps late"), (touching - exact.times[1]) / step, Some(0.0));
        let quantity = format!("{what}: mean pressure");
        if is_gated {
            record.near_relative(quantity, pressure, exact.mean(), 0.02)
        } else {
            record.show(quantity, pressure, Some(exact.mean()))
        }
    }
    let height = bounce.height.last().map_or(f64::NAN, |at| at.1);
    record.show(format!("{n} cells, {name}: height after a period"), height, Some(HEIGHT));
    Ok((bounce, late.abs()))
}

/// Measures.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let (cells, n) = if record.full { (&[25, 50, 100, 200][..], 200) } else { (&[25, 50][..], 50) };
    let euler = TimeScheme::ImplicitEuler;
    let second = second_order(RHO_INF)?;
    let methods = [
        Method { name: "implicit Euler", scheme: euler, courant: 1.0, is_gated: false },
        Method { name: "generalised-α, step h/c", scheme: second, courant: 1.0, is_gated: false },
        Method { name: "generalised-α", scheme: second, courant: undispersed(RHO_INF), is_gated: true },
    ];
    let mut curves = [Vec::new(), Vec::new()];
    for method in &methods {
        let mut errors = Vec::new();
        for &n in cells {
            let (History { height, pressure, .. }, error) = contacts(record, n, method)?;
            errors.push((LENGTH / n as f64, error));
            if Some(&n) == cells.last() {
                curves[0].push((method.name.to_owned(), height));
                curves[1].push((method.name.to_owned(), pressure));
            }
        }
        record.show_order(&format!("error of the time when the second bounce ends, {}", method.name), "h", &errors);
    }
    for (name, scheme) in [("implicit Euler", euler), ("generalised-α", second)] {
        for courant in [2.0, 1.0, 0.5] {
            let loss = 1.0 - history(0.0, n, courant, scheme, 2.0)?.energy;
            record.show(format!("{name}, step {courant} h/c: energy lost in the impact"), loss, Some(0.0));
        }
        let mut loss = Vec::new();
        for courant in [2.0, 1.0, 0.5] {
            loss.push(1.0 - history(GRAVITY, n, courant, scheme, PERIOD)?.energy);
            let quantity = format!("{name}, step {courant} h/c: energy lost in a period");
            record.show(quantity, loss[loss.len() - 1], Some(0.0));
        }
        record.at_most(format!("{name}: energy lost in a period, finest over coarsest step"), loss[2] / loss[0], 1.0);
    }
    for (title, curves) in ["height of the lower end", "floor pressure"].into_iter().zip(curves) {
        let x_title = "t".to_owned();
        record.figures.push(Figure { title: title.to_owned(), x_title, curves, is_log: false });
    }
    record.note(format!(
        "Penalty {PENALTY} E/h, generalised-α with rho_inf = {RHO_INF}. Linear elasticity: strains are up to a third, and the exact solution is \
         that of the linear bar. Its pressure jumps when a contact begins and ends. The mesh smears the jump over a few cells, and an event is \
         where the pressure passes half of the jump; the last touch is later. \
         With the step h/c waves are too slow by (k h)²/21.6, and the width of a smeared front, in steps, grows with the third root of the \
         number of cells: the first bounce of a fine bar ends more than a step late. \
         The gated rows use the step {:.3} h/c, with which the leading errors of elements and time scheme in the speed of waves \
         cancel; what is left grows with the fifth root. Late events also suffer from the energy that every contact costs.",
        undispersed(RHO_INF)
    ));
    Ok(())
}
