//! Elastic disks in contact: two that pass each other in a shear flow, and one that passes a constriction.

use super::example::Example;
use super::record::Points;
use super::signal::{range, rises};
use super::{Failure, P, Record, short};
use crate::units::cgs;

/// Largest overlap over the contact size, as in `settling-disks`.
const OVERLAP: f64 = 0.02;

/// Time at which the disks are compared, s: before they meet, and long after the start compared with the time in which
/// a disk relaxes, viscosity over modulus, 0.01 s.
const APART: f64 = 0.5;
/// Ratio of the moduli of the disks.
const MODULI: f64 = 4.0;
/// Largest relative difference of the ratio of their strain energies from `MODULI`: strains are up to some percent, and
/// energies are quadratic.
const ENERGIES: f64 = 0.2;
/// Least distance of the centres along the flow at the end, cm: two diameters.
const SEPARATED: f64 = 1.0;
/// The short version: disks that are nearer at the start, until they touch, in a coarser fluid.
const PAIR_QUICK: [&str; 5] = [
    "body.0.shape.centre=[-0.3, 0.1]",
    "body.1.shape.centre=[0.3, -0.1]",
    "background.size=0.3",
    "background.refine.0.size=0.07",
    "time.end=0.6",
];

/// Measures two disks of different stiffness in a shear flow.
pub(super) fn pair(record: &mut Record) -> Result<(), Failure> {
    let run = Example::run("shear-pair", if record.full { &[] } else { &PAIR_QUICK })?;
    let history = &run.history;
    let [soft, stiff] = [history.probe("soft_energy")?, history.probe("stiff_energy")?];
    contacts(record, &run)?;
    let x = |body: usize| history.of_body(body, |balance| balance.centre_of_mass[0]);
    let y = |body: usize| history.of_body(body, |balance| balance.centre_of_mass[1]);
    let between = |a: Points, b: Points| -> Points { a.iter().zip(&b).map(|((t, a), (_, b))| (*t, a - b)).collect() };
    let (along, across) = (between(x(0), x(1)), between(y(0), y(1)));
    if record.full {
        let at = history.times.iter().position(|t| *t >= APART).ok_or("the run is too short")?;
        let ratio = soft[at].1 / stiff[at].1;
        record.near_relative("strain energies of soft and stiff disk before they meet, ratio", ratio, MODULI, ENERGIES);
        let last = |curve: &Points| curve.last().map_or(f64::NAN, |(_, value)| *value);
        record.at_least(cgs("distance of the centres along the flow at the end [<length>]"), last(&along), SEPARATED);
        record.at_most("points in contact at the end", last(&history.touching), 0.0);
        record.show(
            cgs("distance of the centres across the flow at the end; reference: at the start [<length>]"),
            last(&across),
            Some(across[0].1),
        );
    }
    record.figure(
        cgs("Distance of the centres [<length>]"),
        "time [s]",
        vec![("along the flow", along), ("across it", across)],
    );
    record.figure(cgs("Strain energy [<energy>]"), "time [s]", vec![("soft disk", soft), ("stiff disk", stiff)]);
    record.note("`examples/shear-pair.toml`. In the same flow two disks have the same stress, and strain energies in the inverse ratio of their moduli.");
    Ok(())
}

/// Height of the throat, cm.
const THROAT: f64 = 0.6;
// Places of the centre before and behind the throat where the shapes of the ball are compared, cm, and largest
// relative difference of height over width. The pressure is higher before the throat, so that sizes differ.
const PLACES: [f64; 2] = [1.5, 4.5];
const SHAPES: f64 = 0.02;
/// Longer steps and coarser meshes, until the ball has passed.
const BALL_QUICK: [&str; 3] = ["background.size=0.1", "time.step=0.02", "body.0.shape.size=0.12"];

/// Measures a ball that passes a constriction.
pub(super) fn ball(record: &mut Record) -> Result<(), Failure> {
    let run = Example::run("constriction", if record.full { &[] } else { &BALL_QUICK })?;
    let history = &run.history;
    let extent = |positions: &[P], axis: usize| {
        let [low, high] = range(&positions.iter().map(|x| x[axis]).collect::<Vec<f64>>());
        high - low
    };
    let all = || history.times.iter().zip(&history.positions);
    let heights: Points = all().map(|(t, all)| (*t, extent(&all[0], 1))).collect();
    let centre = history.of_body(0, |balance| balance.centre_of_mass[0]);
    let shape_at = |place: f64| {
        let &(k, _) = rises(&centre, place).first().ok_or("the ball does not pass the constriction")?;
        Ok::<f64, Failure>(heights[k].1 / extent(&history.positions[k][0], 0))
    };
    let [before, behind] = PLACES.map(shape_at);
    let least = heights.iter().map(|(_, height)| *height).fold(f64::INFINITY, f64::min);
    record.at_most(cgs("least height of the ball [<length>]: that of the throat"), least, THROAT);
    record.near_relative(
        "height over width of the ball behind the throat; reference: before it",
        behind?,
        before?,
        SHAPES,
    );
    contacts(record, &run)?;
    record.show("smallest det F of the ball", history.smallest_volume_ratio(), None);
    let pressure = history.probe("inlet_pressure")?;
    let largest = range(&pressure.iter().map(|(_, p)| *p).collect::<Vec<f64>>())[1];
    record.show(cgs("largest mean pressure at the inlet [<pressure>]"), largest, None);
    record.figure(
        cgs("Centre and height of the ball [<length>]"),
        "time [s]",
        vec![("place of the centre", centre), ("height", heights)],
    );
    record.figure(cgs("Mean pressure at the inlet [<pressure>]"), "time [s]", vec![("pressure", pressure)]);
    record.note(format!(
        "`examples/constriction.toml`. Shapes are compared where the centre is at {} and {} cm; the throat is between 2 and 3.4 cm.",
        short(PLACES[0]),
        short(PLACES[1]),
    ));
    Ok(())
}

/// Compares the contacts of a run with their bounds.
fn contacts(record: &mut Record, run: &Example) -> Result<(), Failure> {
    let size = run.setup.contacts.first().ok_or("there is a contact")?.form().size();
    let most = range(&run.history.touching.iter().map(|(_, n)| *n).collect::<Vec<f64>>())[1];
    record.at_least("largest number of points in contact", most, 1.0);
    record.at_most("largest overlap over the contact size", -run.history.smallest_gap / size, OVERLAP);
    record.show("parts of divided steps", run.history.n_parts as f64, Some(0.0));
    Ok(())
}
