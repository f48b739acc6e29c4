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
/// Floor pressure of the impact without gravity, and the mean of both contacts with it.
const IMPACT: f64 = DENSITY * WAVE * SPEED;
const BOUNCE: f64 = 400.0;
/// Beginning and end of the contacts: without gravity, and the two of a period with it.
const IMPACT_TIMES: [f64; 2] = [0.5, 7.0 / 6.0];
const BOUNCE_TIMES: [[f64; 2]; 2] = [[1.0, 5.0 / 3.0], [11.0 / 3.0, 13.0 / 3.0]];
const PERIOD: f64 = 16.0 * CROSSING;
/// Pressure over penetration beside Young's modulus over the size of a cell.
const PENALTY: f64 = 10.0;

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
    /// First and last time at which the pressure is above half of its exact mean: where it jumps, and the mesh smears the jump.
    first: f64,
    last: f64,
    /// Last time at which there is any pressure.
    touching: f64,
    /// Impulse over the exact duration.
    pressure: f64,
}

impl History {
    /// A contact, from the steps within a crossing time of the exact one.
    fn contact(&self, [begin, end]: [f64; 2], mean: f64) -> Contact {
        let around = |at: &&(f64, f64)| begin - CROSSING < at.0 && at.0 < end + CROSSING;
        let mut loaded = self.pressure.iter().filter(around).filter(|at| at.1 > 0.5 * mean).map(|at| at.0);
        let first = loaded.next().unwrap_or(f64::NAN);
        let last = loaded.next_back().unwrap_or(f64::NAN);
        let touching = self.pressure.iter().filter(around).rfind(|at| at.1 > 0.0).map_or(f64::NAN, |at| at.0);
        let dt = self.pressure[1].0 - self.pressure[0].0;
        let impulse: f64 = self.pressure.iter().filter(around).map(|at| at.1 * dt).sum();
        Contact { first, last, touching, pressure: impulse / (end - begin) }
    }
}

/// Measures.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let n = if record.full { 200 } else { 50 };
    let step = LENGTH / n as f64 / WAVE;
    let schemes = [("implicit Euler", TimeScheme::ImplicitEuler), ("generalised-α", second_order(RHO_INF)?)];
    let mut curves = [Vec::new(), Vec::new()];
    for (name, scheme) in schemes {
        let is_gated = scheme != TimeScheme::ImplicitEuler;
        let impact = history(0.0, n, 1.0, scheme, 2.0)?;
        let bounce = history(GRAVITY, n, 1.0, scheme, PERIOD)?;
        let contacts = [
            ("impact", &impact, IMPACT_TIMES, IMPACT),
            ("first bounce", &bounce, BOUNCE_TIMES[0], BOUNCE),
            ("second bounce", &bounce, BOUNCE_TIMES[1], BOUNCE),
        ];
        for (what, history, times, mean) in contacts {
            let Contact { first, last, touching, pressure } = history.contact(times, mean);
            for (event, at, exact) in [("begins", first, times[0]), ("ends", last, times[1])] {
                let quantity = format!("{name}, {what} {event}, in steps");
                let [at, exact] = [at / step, exact / step];
                if is_gated {
                    record.near(quantity, at, exact, 1.0 + ROUND_OFF)
                } else {
                    record.show(quantity, at, Some(exact))
                }
            }
            let quantity = format!("{name}, {what}: last touch, in steps");
            record.show(quantity, touching / step, Some(times[1] / step));
            let quantity = format!("{name}, {what}: mean pressure");
            if is_gated {
                record.near_relative(quantity, pressure, mean, 0.02)
            } else {
                record.show(quantity, pressure, Some(mean))
            }
        }
        record.show(
            format!("{name}: height after a period"),
            bounce.height.last().map_or(f64::NAN, |at| at.1),
            Some(HEIGHT),
        );
        curves[0].push((name.to_owned(), bounce.height));
        curves[1].push((name.to_owned(), bounce.pressure));
        for courant in [2.0, 1.0, 0.5] {
            let history = history(0.0, n, courant, scheme, 2.0)?;
            record.show(
                format!("{name}, step {courant} h/c: energy lost in the impact"),
                1.0 - history.energy,
                Some(0.0),
            );
        }
        let mut loss = Vec::new();
        for courant in [2.0, 1.0, 0.5] {
            loss.push(1.0 - history(GRAVITY, n, courant, scheme, PERIOD)?.energy);
            record.show(
                format!("{name}, step {courant} h/c: energy lost in a period"),
                loss[loss.len() - 1],
                Some(0.0),
            );
        }
        record.at_most(format!("{name}: energy lost in a period, finest over coarsest step"), loss[2] / loss[0], 1.0);
    }
    for (title, curves) in ["height of the lower end", "floor pressure"].into_iter().zip(curves) {
        let x_title = "t".to_owned();
        record.figures.push(Figure { title: title.to_owned(), x_title, curves, is_log: false });
    }
    record.note(format!(
        "{n} cells, penalty {PENALTY} E/h, generalised-α with rho_inf = {RHO_INF}; times in steps of h/c. Linear elasticity: strains are up to a \
         third, and the exact solution is that of the linear bar. A contact begins and ends where the pressure passes half of its mean: \
         dispersion smears the jumps over a few cells, and the last touch is later by that. In \
         steps of h/c this width grows with the third root of the number of cells: 200 cells miss the end of the first bounce by two steps, \
         50 by one."
    ));
    Ok(())
}

/// Of a time, in steps.
const ROUND_OFF: f64 = 1e-6;
/// Spectral radius of the generalised-α scheme.
const RHO_INF: f64 = 0.8;
