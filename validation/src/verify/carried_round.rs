//! A flexible strip that is carried round by the fluid in a rotating container.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use cutwater::solver::body::Balance;

use super::example::{Example, ExampleHistory};
use super::record::worse;
use super::signal::range;
use super::{Failure, P, Record, V, short};
use crate::units::cgs;

const EXAMPLE: &str = "carried-round";
const ELASTIC: &str = "elastic energy of the strip after each revolution: largest over least, minus 1";
/// Revolutions of the example; one takes a second.
const REVOLUTIONS: usize = 10;
/// One revolution in longer steps.
const QUICK: [&str; 2] = ["time.end=1", "time.step=0.01"];
/// Steps of twice the length, the example's until 2026-11-26.
const TWICE: [&str; 1] = ["time.step=2.5e-3"];
/// Least order of the lost area in the step: that of the scheme is 3, and the step is halved once.
const ORDER: f64 = 2.5;
/// Largest change of shape, energy and distance from the axis between revolutions.
const CHANGE: f64 = 0.02;
/// Length of the strip, cm, by which changes of its shape are divided.
const LENGTH: f64 = 4.0;

/// Measures shape, energy and path after each revolution; the start counts as the first one.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let (revolutions, changes): (usize, &[&str]) = if record.full { (REVOLUTIONS, &[]) } else { (1, &QUICK) };
    let run = Example::run(EXAMPLE, changes)?;
    let history = &run.history;
    let after = |revolution: usize| revolution * (history.times.len() - 1) / revolutions;
    let first = if revolutions > 1 { 1 } else { 0 };
    let change = |number: BalanceNumber| change(history, first..=revolutions, number);
    let shapes: Vec<&[P]> = (0..=revolutions).map(|k| &*history.positions[after(k)][0]).collect();
    let largest = (first..=revolutions).flat_map(|a| (a + 1..=revolutions).map(move |b| (a, b)));
    let largest = largest.map(|(a, b)| difference(shapes[a], shapes[b]) / LENGTH).fold(0.0, worse);
    record.show("revolutions", revolutions as f64, None);
    record.at_most("shape after each revolution: largest difference over the length", largest, CHANGE);
    let energy = change(|balance| balance.kinetic_energy + balance.elastic_energy);
    record.at_most("energy of the strip after each revolution: largest over least, minus 1", energy, CHANGE);
    let distance: BalanceNumber = |balance| balance.centre_of_mass.norm();
    record.at_most(
        "distance from the axis after each revolution: largest over least, minus 1",
        change(distance),
        CHANGE,
    );
    let (elastic, area): (BalanceNumber, BalanceNumber) = (|balance| balance.elastic_energy, |balance| balance.volume);
    let lost = change(area);
    record.show("area of the strip after each revolution: largest over least, minus 1", lost, None);
    if record.full {
        // At the start there is no elastic energy.
        record.at_most(ELASTIC, change(elastic), CHANGE);
        let coarse = Example::run(EXAMPLE, &TWICE)?.history;
        let of_coarse = |number: BalanceNumber| self::change(&coarse, first..=revolutions, number);
        record.at_most(format!("steps of twice the length: {ELASTIC}"), of_coarse(elastic), CHANGE);
        record.at_least("order of the lost area in dt", (of_coarse(area) / lost).log2(), ORDER);
        let predicted = TAU * (revolutions - first) as f64 * (TAU * run.setup.dt).powi(3) / 2.0;
        record.show("lost area over that of a rigid rotation by the scheme", lost / predicted, Some(1.0));
    }
    let turned = angle(history);
    record.show("revolutions of the strip; reference: of the container", turned / TAU, Some(revolutions as f64));
    record.show("smallest det F of the strip", history.smallest_volume_ratio(), None);
    record.show("cells of the background, which do not move", history.n_cells as f64, None);
    record.show("parts of divided steps", history.n_parts as f64, Some(0.0));
    record.figure(
        cgs("Elastic energy of the strip [<energy>]"),
        "time [s]",
        vec![("elastic energy", history.of_body(0, elastic))],
    );
    record.figure(
        cgs("Distance of the centre from the axis [<length>]"),
        "time [s]",
        vec![("distance", history.of_body(0, distance))],
    );
    record.note(format!(
        "The energy of the strip is nearly all kinetic. Its elastic energy, which is smaller by more than four orders, is that of the compression by the pressure; the fluid is closed in, so that the level of the pressure depends on \
         the area of the strip. `examples/{EXAMPLE}.toml`, in steps of {} s. Wall, fluid and strip turn rigidly from the start. The strip is as heavy as the fluid, so that the rigid rotation is exact but for its \
         elasticity. The difference of two shapes is the root mean square of the distances of the vertices after the best rigid motion. With ten revolutions those after the first to the tenth are \
         compared, in the short version the start and the end of one. The fluid takes no flux through the strip's surface, so that the area would be constant without errors in time. \
         Newmark's rules with rho_inf = 0 multiply the distance from the axis by 1 - φ⁴/4 in a step in which the strip turns by φ, if its velocity has no flux through the extrapolated surface: \
         the area falls by φ³/2 per radian, and the strip is compressed.",
        short(run.setup.dt),
    ));
    Ok(())
}

/// A number of a body.
type BalanceNumber = fn(&Balance<2>) -> f64;

/// Returns the largest value of a number after some revolutions over the least one, minus 1. The last revolution ends
/// the run.
fn change(history: &ExampleHistory, revolutions: RangeInclusive<usize>, number: BalanceNumber) -> f64 {
    let curve = history.of_body(0, number);
    let n_steps = curve.len() - 1;
    let values = revolutions.clone().map(|k| curve[k * n_steps / revolutions.end()].1);
    let [least, largest] = range(&values.collect::<Vec<_>>());
    largest / least - 1.0
}

/// Returns the root mean square of the distances of points after the best rigid motion.
fn difference(a: &[P], b: &[P]) -> f64 {
    let centred = |points: &[P]| -> Vec<V> {
        let centre = points.iter().sum::<V>() / points.len() as f64;
        points.iter().map(|x| x - centre).collect()
    };
    let (a, b) = (centred(a), centred(b));
    let (mut cos, mut sin) = (0.0, 0.0);
    for (x, y) in a.iter().zip(&b) {
        cos += x.dot(y);
        sin += x[0] * y[1] - x[1] * y[0];
    }
    let length = cos.hypot(sin);
    let turned = |x: &V| V::new(x[0] * cos - x[1] * sin, x[0] * sin + x[1] * cos) / length;
    let squares: f64 = a.iter().zip(&b).map(|(x, y)| (turned(x) - y).norm_squared()).sum();
    (squares / a.len() as f64).sqrt()
}

/// Returns the angle by which the centre of the strip has turned about the axis, in steps below half a revolution.
fn angle(history: &ExampleHistory) -> f64 {
    let centres = history.balances.iter().map(|balances| balances[0].centre_of_mass);
    let centres: Vec<P> = centres.collect();
    let turn = |w: &[P]| (w[0][0] * w[1][1] - w[0][1] * w[1][0]).atan2(w[0].dot(&w[1]));
    centres.windows(2).map(turn).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigid_motions_keep_the_shape() {
        let shape: Vec<P> = (0..9).map(|k| P::new(f64::from(k % 3), f64::from(k / 3) * 0.7)).collect();
        let (sin, cos) = 2.2_f64.sin_cos();
        let moved: Vec<P> =
            shape.iter().map(|x| P::new(cos * x[0] - sin * x[1] + 3.0, sin * x[0] + cos * x[1] - 1.0)).collect();
        assert!(difference(&shape, &moved) < 1e-14);
        // Stretched by a tenth along x: the coordinates 0, 1, 2 change by 0.1 about their mean.
        let stretched: Vec<P> = shape.iter().map(|x| P::new(1.1 * x[0], x[1])).collect();
        assert!((difference(&shape, &stretched) - 0.1 * (2.0_f64 / 3.0).sqrt()).abs() < 1e-14);
    }
}
