//! Valves that close against a pressure and open again: two leaflets, and a ball in a conical seat.

use super::example::Example;
use super::record::{Points, TextTable};
use super::{Failure, Record, short};
use crate::units::cgs;

// Period of the pressure, s, and number of periods of the examples.
const PERIOD: f64 = 4.0;
const CYCLES: usize = 3;
// Parts of the period over which fluxes are averaged while the valve is open and closed: the second half of the times
// in which the pressure is constant.
const OPEN: [f64; 2] = [3.0 / 12.0, 5.0 / 12.0];
const CLOSED: [f64; 2] = [9.0 / 12.0, 11.0 / 12.0];
/// Largest flux while closed over that while open.
const LEAK: f64 = 0.02;
/// Least flux while open over that of the first cycle.
const REOPENS: f64 = 0.9;
/// Largest overlap over the contact size, as in `settling-disks`.
const OVERLAP: f64 = 0.02;
/// Changes of the short version: longer steps, and the first cycle until the end of the time in which the valve is
/// closed.
const QUICK: [&str; 2] = ["time.end=3.68", "time.step=0.04"];

/// Measures two leaflets that close against each other.
pub(super) fn leaflets(record: &mut Record) -> Result<(), Failure> {
    let coarse = ["background.size=0.3", "background.refine.0.size=0.15", "background.refine.1.size=0.1"];
    let run = measure(record, "idealised-valve", &coarse)?;
    let tips = ["lower_tip_y", "upper_tip_y"].map(|name| run.history.probe(name));
    let [lower, upper] = [tips[0].as_ref(), tips[1].as_ref()].map(|tip| tip.map_err(ToString::to_string));
    let (lower, upper) = (lower?, upper?);
    let apart = lower.iter().zip(upper).map(|((t, low), (_, high))| (*t, high - low)).collect();
    record.figure(cgs("Distance of the tips across the channel [<length>]"), "time [s]", vec![("distance", apart)]);
    Ok(())
}

/// Measures a ball in a conical seat.
pub(super) fn ball(record: &mut Record) -> Result<(), Failure> {
    let run = measure(record, "check-valve", &[])?;
    let height = run.history.of_body(0, |balance| balance.centre_of_mass[1]);
    let drift = run.history.of_body(0, |balance| balance.centre_of_mass[0].abs());
    record.show(
        cgs("largest distance of the ball from the axis [<length>]"),
        drift.iter().map(|(_, x)| *x).fold(0.0, f64::max),
        None,
    );
    record.figure(cgs("Height of the centre [<length>]"), "time [s]", vec![("height", height)]);
    Ok(())
}

/// Measures the flux through a valve, while it is open and while it is closed.
fn measure(record: &mut Record, example: &str, coarse: &[&str]) -> Result<Example, Failure> {
    let changes: Vec<&str> = if record.full { Vec::new() } else { QUICK.iter().chain(coarse).copied().collect() };
    let cycles = if record.full { CYCLES } else { 1 };
    let run = Example::run(example, &changes)?;
    let flux = run.history.probe("through_flux")?;
    let during = |cycle: usize, part: [f64; 2]| {
        let [begin, end] = part.map(|part| (cycle as f64 + part) * PERIOD);
        flux.iter().filter(|(t, _)| begin <= *t && *t <= end).map(|(_, flux)| *flux).collect::<Vec<f64>>()
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let first = mean(&during(0, OPEN));
    let mut rows = Vec::new();
    for cycle in 0..cycles {
        let (open, while_closed) = (mean(&during(cycle, OPEN)), during(cycle, CLOSED));
        let (leak, most) = (mean(&while_closed), while_closed.iter().map(|flux| flux.abs()).fold(0.0, f64::max));
        let name = format!("cycle {}", cycle + 1);
        if cycle > 0 {
            record.at_least(format!("{name}: flux while open over that of the first cycle"), open / first, REOPENS);
        }
        record.at_most(format!("{name}: flux while closed over that while open"), (leak / open).abs(), LEAK);
        let in_contact = run.history.touching.iter().zip(&flux).filter(|((t, n), _)| {
            let part = t / PERIOD - cycle as f64;
            *n > 0.0 && (0.5..1.0).contains(&part)
        });
        let in_contact: Vec<f64> = in_contact.map(|(_, (_, flux))| *flux).collect();
        record.show(
            format!("{name}: flux of all times in contact while the pressure closes over that while open"),
            (mean(&in_contact) / open).abs(),
            None,
        );
        rows.push(vec![name, short(open), short(leak), short(most)]);
    }
    let head = [
        "",
        "flux while open [<flux>]",
        "leak: mean flux while closed [<flux>]",
        "largest value at an instant of this time [<flux>]",
    ];
    record.tables.push(TextTable { head: head.map(cgs).into(), rows });
    let size = run.setup.contacts.first().ok_or("there is a contact")?.form().size();
    let while_closed = |touching: &Points| {
        let [begin, end] = CLOSED.map(|part| part * PERIOD);
        touching.iter().filter(|(t, _)| begin <= *t && *t <= end).map(|(_, n)| *n).fold(0.0, f64::max)
    };
    record.at_least("largest number of points in contact while closed", while_closed(&run.history.touching), 1.0);
    record.at_most("largest overlap over the contact size", -run.history.smallest_gap / size, OVERLAP);
    record.show("smallest det F", run.history.smallest_volume_ratio(), None);
    record.show("parts of divided steps", run.history.n_parts as f64, Some(0.0));
    record.figure(cgs("Flux through the valve [<flux>]"), "time [s]", vec![("flux", flux)]);
    record.note(format!(
        "`examples/{example}.toml`. The pressure changes its sign every {} s and is constant for two thirds of this time, in the second half of which fluxes are averaged: from {} to {} s and from {} to {} s of each cycle of {} s. The leak is the volume \
         that passes the closed valve, over the time. The flux at an instant is also that of the fluid that swings with a closed valve; its largest value is in the table. All times in contact begin with the first touch, after which \
         elastic parts still bulge: the volume that they sweep passes the section as well.",
        short(0.5 * PERIOD),
        short(OPEN[0] * PERIOD),
        short(OPEN[1] * PERIOD),
        short(CLOSED[0] * PERIOD),
        short(CLOSED[1] * PERIOD),
        short(PERIOD),
    ));
    Ok(run)
}
