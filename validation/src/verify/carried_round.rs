//! A flexible strip that is carried round by the fluid in a rotating container.

use std::f64::consts::TAU;

use cutwater::solver::body::Balance;

use super::example::{Example, History};
use super::record::{Points, worse};
use super::signal::range;
use super::{Failure, P, Record, V, short};

const EXAMPLE: &str = "carried-round";
/// Revolutions of the example; one takes a second.
const REVOLUTIONS: usize = 10;
/// One revolution in longer steps.
const QUICK: [&str; 2] = ["time.end=1", "time.step=0.01"];
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
    let energy = history.of_body(0, |balance| balance.kinetic_energy + balance.elastic_energy);
    let distance = history.of_body(0, |balance| balance.centre_of_mass.norm());
    let shapes = shapes(history, after, revolutions);
    let first = if revolutions > 1 { 1 } else { 0 };
    let at_ends = |curve: &Points| -> Vec<f64> { (first..=revolutions).map(|k| curve[after(k)].1).collect() };
    let spread = |curve: &Points| {
        let [least, largest] = range(&at_ends(curve));
        largest / least - 1.0
    };
    let largest = (first..=revolutions).flat_map(|a| (a + 1..=revolutions).map(move |b| (a, b)));
    let largest = largest.map(|(a, b)| difference(&shapes[a], &shapes[b]) / LENGTH).fold(0.0, worse);
    record.show("revolutions", revolutions as f64, None);
    record.at_most("shape after each revolution: largest difference over the length", largest, CHANGE);
    record.at_most("energy of the strip after each revolution: largest over least, minus 1", spread(&energy), CHANGE);
    record.at_most(
        "distance from the axis after each revolution: largest over least, minus 1",
        spread(&distance),
        CHANGE,
    );
    let elastic = history.of_body(0, |balance: &Balance<2>| balance.elastic_energy);
    if record.full {
        // At the start there is none.
        record.at_most(
            "elastic energy of the strip after each revolution: largest over least, minus 1",
            spread(&elastic),
            CHANGE,
        );
    }
    let volume = history.of_body(0, |balance| balance.volume);
    record.show("area of the strip after each revolution: largest over least, minus 1", spread(&volume), Some(0.0));
    let turned = angle(history);
    record.show("revolutions of the strip; reference: of the container", turned / TAU, Some(revolutions as f64));
    record.show("smallest det F of the strip", history.smallest_volume_ratio(), None);
    record.show("cells of the background, which do not move", history.n_cells as f64, None);
    record.show("parts of divided steps", history.n_parts as f64, Some(0.0));
    record.figure("Elastic energy of the strip [erg/cm]", "time [s]", vec![("elastic energy", elastic)]);
    record.figure("Distance of the centre from the axis [cm]", "time [s]", vec![("distance", distance)]);
    record.note(format!(
        "The energy of the strip is nearly all kinetic. Its elastic energy, which is smaller by more than four orders, is that of the compression by the pressure; the fluid is closed in, so that the level of the pressure depends on \
         the area of the strip. `examples/{EXAMPLE}.toml`, in steps of {} s. Wall, fluid and strip turn rigidly from the start. The strip is as heavy as the fluid, so that the rigid rotation is exact but for its \
         elasticity. The difference of two shapes is the root mean square of the distances of the vertices after the best rigid motion. With ten revolutions those after the first to the tenth are \
         compared, in the short version the start and the end of one.",
        short(run.setup.dt),
    ));
    Ok(())
}

/// Returns the positions of the vertices after each revolution.
fn shapes(history: &History, after: impl Fn(usize) -> usize, revolutions: usize) -> Vec<Vec<P>> {
    (0..=revolutions).map(|k| history.positions[after(k)][0].clone()).collect()
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
fn angle(history: &History) -> f64 {
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
