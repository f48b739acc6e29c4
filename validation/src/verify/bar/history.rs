//! A computed motion of the bar, and the exact one.

use std::sync::Arc;

use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LameParameters, LinearElastic, SupportKind};

use super::super::dry::{Scheme, elastic, floor, run};
use super::super::signal::{passage, range, rms};
use super::super::{DirectRun, Failure, V};

pub(super) const LENGTH: f64 = 10.0;
const YOUNG: f64 = 900.0;
const DENSITY: f64 = 1.0;
// Height, gravity and speed are a tenth of those of the source, whose strains are 0.56 in a bounce and more in a bar
// that vibrates: its cells can turn inside out. The problem is linear, so that displacements and pressures are a tenth
// of those of the source at the same times.
pub(super) const HEIGHT: f64 = 0.5;
pub(super) const GRAVITY: f64 = 1.0;
/// Speed of both impacts.
const SPEED: f64 = 1.0;
// Speed of waves, and the time in which they cross the bar.
pub(super) const WAVE: f64 = 30.0;
const CROSSING: f64 = LENGTH / WAVE;
// The contact without gravity, and the two of a period with it.
pub(super) const IMPACT: ExactContact = ExactContact { times: [0.5, 7.0 / 6.0], pressure: [30.0, 30.0] };
pub(super) const BOUNCES: [ExactContact; 2] = [
    ExactContact { times: [1.0, 5.0 / 3.0], pressure: [30.0, 50.0] },
    ExactContact { times: [11.0 / 3.0, 13.0 / 3.0], pressure: [50.0, 30.0] },
];
pub(super) const PERIOD: f64 = 16.0 * CROSSING;
/// Times and heights of the lower end of the bar with gravity.
pub(super) const HEIGHTS: [(f64, f64); 11] = [
    (0.5, 0.375),
    (1.0, 0.0),
    (4.0 / 3.0, 0.0),
    (2.0, 1.0 / 6.0),
    (7.0 / 3.0, 4.0 / 9.0),
    (8.0 / 3.0, 7.0 / 18.0),
    (3.0, 4.0 / 9.0),
    (10.0 / 3.0, 1.0 / 6.0),
    (4.0, 0.0),
    (5.0, 4.0 / 9.0),
    (PERIOD, HEIGHT),
];
/// The part of a contact, around its middle, in which the pressure is compared: away from the jumps.
pub(super) const MIDDLE: f64 = 0.5;

/// Pressure over penetration, relative to Young's modulus over the size of a cell.
pub(super) const PENALTY: f64 = 10.0;
/// An exact contact: its beginning and end, and the pressures there; between them the pressure is linear.
pub(super) struct ExactContact {
    pub(super) times: [f64; 2],
    pressure: [f64; 2],
}

impl ExactContact {
    /// Returns the pressure at a time of contact.
    fn at(&self, time: f64) -> f64 {
        let ([begin, end], [first, last]) = (self.times, self.pressure);
        first + (last - first) * (time - begin) / (end - begin)
    }

    pub(super) fn mean(&self) -> f64 {
        0.5 * (self.pressure[0] + self.pressure[1])
    }
}

/// Returns the exact pressure over a period with gravity.
pub(super) fn exact_pressure() -> Vec<(f64, f64)> {
    let contact = |exact: &ExactContact| {
        let ([begin, end], [first, last]) = (exact.times, exact.pressure);
        [(begin, 0.0), (begin, first), (end, last), (end, 0.0)]
    };
    BOUNCES.iter().flat_map(contact).chain([(PERIOD, 0.0)]).collect()
}

/// The bar at the ends of the steps.
pub(super) struct BarHistory {
    /// Time and floor pressure of each step.
    pub(super) pressure: Vec<(f64, f64)>,
    /// Time and height of the lower end.
    pub(super) height: Vec<(f64, f64)>,
    /// Time, and energy over that at the start, measured from the undeformed bar on the floor: whenever a wave would
    /// have crossed the bar again, and at the end.
    pub(super) energy: Vec<(f64, f64)>,
}

/// A discretisation of the bar in time, and of its mass.
pub(super) struct Advance<'a> {
    pub(super) scheme: &'a Scheme,
    /// Whether the nodes on the floor have no mass.
    pub(super) is_massless: bool,
    /// Fraction of a cell that a wave crosses in a step.
    pub(super) courant: f64,
}

/// Computes the history of the bar of `n` cells.
pub(super) fn history(gravity: f64, n: usize, advance: &Advance<'_>, end: f64) -> Result<BarHistory, Failure> {
    let &Advance { scheme, is_massless, courant } = advance;
    let size = LENGTH / n as f64;
    let mesh = structured_box::<2>([0.0, HEIGHT], [size, HEIGHT + LENGTH], [1, n])?;
    // Without lateral contraction a bar between smooth walls is a bar in one dimension.
    let material = LinearElastic::new(LameParameters::from_young_poisson(YOUNG, 0.0)?);
    let mut body = elastic(mesh, DENSITY, material, V::new(0.0, -gravity), Arc::clone(scheme))?;
    if is_massless {
        let foot = body.solid.boundary().vertices_of(&body.part("bottom")?);
        body.solid = body.solid.without_mass_at(&foot)?.0;
    }
    for side in ["left", "right"] {
        body.hold(side, SupportKind::symmetry(0))?;
    }
    if gravity == 0.0 {
        body.options.initial_velocity = Some(Arc::new(|_| V::new(0.0, -SPEED)));
    }
    let contact = floor(body.part("bottom")?, PENALTY * YOUNG / size, 1.0)?;
    let dt = courant * size / WAVE;
    let mut run = run(vec![body], Some(contact), dt, 1e-9)?;
    // Potential energy of the bar that rests on the floor.
    let rest = size * DENSITY * gravity * 0.5 * LENGTH * LENGTH;
    let energy_of = |run: &DirectRun| {
        let balance = run.setup.bodies[0].balance(&run.state.bodies[0]).ok_or("the bar is elastic")?;
        Ok::<f64, Failure>(balance.energy() - rest)
    };
    let start = energy_of(&run)?;
    let (mut pressure, mut height, mut energy) = (Vec::new(), Vec::new(), Vec::new());
    while run.state.time < end - 0.5 * dt {
        let before = run.state.time;
        let report = run.advance()?;
        let time = run.state.time;
        pressure.push((time, report.contacts[0].force[1] / size));
        height.push((time, HEIGHT + run.state.bodies[0].displacement()[0][1]));
        if (before / CROSSING).floor() < (time / CROSSING).floor() || time >= end - 0.5 * dt {
            energy.push((time, energy_of(&run)? / start));
        }
    }
    Ok(BarHistory { pressure, height, energy })
}

/// A contact of the bar with the floor.
pub(super) struct BarContact {
    /// Times at which the pressure passes half of its jumps at the beginning and at the end, which the mesh smears.
    pub(super) times: [f64; 2],
    /// Last time at which there is any pressure.
    pub(super) touching: f64,
    /// Impulse over the exact duration.
    pub(super) pressure: f64,
    /// Root mean square of the deviation of the pressure from the exact one in the middle of the contact.
    pub(super) deviation: f64,
    /// Half the range of that deviation.
    pub(super) oscillation: f64,
}

impl BarHistory {
    /// Returns the energy at the end over that at the start.
    pub(super) fn kept(&self) -> f64 {
        self.energy.last().map_or(f64::NAN, |at| at.1)
    }

    /// Returns the number of contacts of the bar with the floor.
    pub(super) fn contacts(&self) -> usize {
        self.pressure.windows(2).filter(|w| w[0].1 <= 0.0 && w[1].1 > 0.0).count()
    }

    /// Evaluates a contact from the steps within a crossing time of the exact one.
    pub(super) fn contact(&self, exact: &ExactContact) -> BarContact {
        let [begin, end] = exact.times;
        let around = |at: &&(f64, f64)| begin - CROSSING < at.0 && at.0 < end + CROSSING;
        let steps: Vec<(f64, f64)> = self.pressure.iter().filter(around).copied().collect();
        let [low, high] = exact.pressure.map(|jump| 0.5 * jump);
        // The pressure is taken as linear between two steps.
        let mut pairs = steps.windows(2).map(|w| [w[0], w[1]]);
        let last = pairs.clone().rfind(|[a, b]| a.1 > high && high >= b.1).map(|pair| passage(pair, high));
        let first = pairs.find(|[a, b]| a.1 <= low && low < b.1).map(|pair| passage(pair, low));
        let touching = steps.iter().rfind(|at| at.1 > 0.0).map_or(f64::NAN, |at| at.0);
        let dt = self.pressure[1].0 - self.pressure[0].0;
        let impulse: f64 = steps.iter().map(|at| at.1 * dt).sum();
        let is_middle = |time: f64| (time - 0.5 * (begin + end)).abs() < 0.5 * MIDDLE * (end - begin);
        let deviations: Vec<f64> = steps.iter().filter(|at| is_middle(at.0)).map(|at| at.1 - exact.at(at.0)).collect();
        let [least, largest] = range(&deviations);
        BarContact {
            times: [first, last].map(|t| t.unwrap_or(f64::NAN)),
            touching,
            pressure: impulse / (end - begin),
            deviation: rms(&deviations),
            oscillation: 0.5 * (largest - least),
        }
    }

    /// Returns the root mean square of the errors of the height, with gravity, at the times at which the exact one is
    /// listed.
    pub(super) fn height_error(&self) -> f64 {
        let errors = HEIGHTS.map(|(time, exact)| {
            // The last step may end slightly before the period does.
            let k = self.height.partition_point(|at| at.0 < time).clamp(1, self.height.len() - 1);
            let [before, after] = [self.height[k - 1], self.height[k]].map(|(t, height)| (height, t));
            passage([before, after], time) - exact
        });
        rms(&errors)
    }
}
