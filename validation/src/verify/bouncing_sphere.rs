//! A sphere that bounces off the floor of a tank, compared with measured heights.
//!
//! Source: Gondret, Lance, Petit 2002, Physics of Fluids 14, 643, doi:10.1063/1.1427920; steel in silicone oil, Stokes
//! number 152.

use super::bounces::{
    FORMER, Fall, HALF, IN_AIR, RADIUS, SPEED, TWICE, cells, coarse_cells, compute, from_contact, has_bounced, inputs,
    legendre, measured, rebounds, speed_at,
};
use super::{Failure, Record};

/// Measured heights of the first three bounces, m, with the largest relative errors. `None`: the error is not checked.
const HEIGHTS: [(f64, Option<f64>); 3] = [(7.466e-3, Some(0.05)), (2.234e-3, Some(0.08)), (0.520e-3, None)];
/// Largest relative error of the speed at a gap of one radius.
const APPROACH: f64 = 0.02;
/// Largest relative change of the heights with the mesh and with the steps.
const CHANGE: f64 = 0.03;
/// Longest wall-clock time of the fall with three bounces, s.
const COST: f64 = 2400.0;
/// Largest error of the ratio of restitutions on coarse cells: scatter of measurements, and error of the mesh.
const SCATTER: f64 = 0.15;
/// Time before contact at which the measured curve begins, s.
const SHOWN_BEFORE: f64 = 0.016;
/// Measured times from the first contact to the heights, s.
const TIMES: [f64; 3] = [0.038, 0.106, 0.140];
/// Radius, densities, viscosity and speed of the approach.
const INPUTS: [&str; 4] = ["1.5 mm", "7800 and 935 kg/m³", "0.010 Pa s", "0.585 m/s"];
const MEASURED: &str = include_str!("../../reference/gondret/St152.csv");

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if record.full { compare(record) } else { coarse(record) }
}

/// Compares the rebound of a sphere that is released near the floor, on coarse cells, with the fit of measurements.
fn coarse(record: &mut Record) -> Result<(), Failure> {
    let rebound = &rebounds(&[152.0], &coarse_cells(), 0.02, record)?[0];
    let name = "coarse cells, released at a radius from the floor: restitution over that in air";
    record.near(name, rebound.mean / IN_AIR, legendre(152.0), SCATTER);
    record.near(
        "the same by the largest speed after the collision, the former definition",
        rebound.largest / IN_AIR,
        legendre(152.0),
        SCATTER,
    );
    record.note(FORMER);
    Ok(())
}

/// Compares the bounces with the measured ones, and with those on another mesh, with other steps, and without vapour.
fn compare(record: &mut Record) -> Result<(), Failure> {
    let coarse_steps = ["time.step=1.0e-4", "time.approach.fraction=0.12", "time.approach.smallest=1.0e-6"];
    let fine_steps = ["time.step=2.5e-5", "time.approach.fraction=0.03", "time.approach.smallest=2.5e-7"];
    let variants = [
        ("cells of half the size", cells(HALF).collect::<Vec<_>>(), Some(CHANGE)),
        ("cells of twice the size", cells(TWICE).collect(), Some(CHANGE)),
        ("steps of twice the length", coarse_steps.map(str::to_owned).to_vec(), Some(CHANGE)),
        ("steps of half the length", fine_steps.map(str::to_owned).to_vec(), Some(CHANGE)),
        ("vapour only at -1000 bar", vec!["fluid.film.floor=-1e8".to_owned()], None),
    ];
    let long = vec!["time.end=0.2".to_owned()];
    let mut falls = vec![Fall {
        name: "standard".to_owned(),
        changes: long.clone(),
        is_over: |series| has_bounced(series, 3, RADIUS),
    }];
    falls.extend(variants.iter().map(|(name, changes, _)| Fall {
        name: (*name).to_owned(),
        changes: [&long[..], changes].concat(),
        is_over: |series| has_bounced(series, 2, RADIUS),
    }));
    let found = compute(&falls, record)?;
    let (standard, others) = found.split_first().ok_or("no fall")?;
    let contact = standard.contact.ok_or("the velocity of the sphere does not change its sign until the end")?;
    let speed = speed_at(&standard.series, RADIUS).ok_or("the gap of the sphere is always above one radius")?;
    record.near_relative("speed at a gap of one radius [m/s]", speed, SPEED, APPROACH);
    for (k, (height, bound)) in HEIGHTS.into_iter().enumerate() {
        let found = standard.maxima.get(k).map_or(f64::NAN, |at| at.1);
        let name = format!("height of bounce {} [m]", k + 1);
        match bound {
            Some(bound) => record.near_relative(name, found, height, bound),
            None => record.show(name, found, Some(height)),
        }
    }
    for (k, time) in TIMES.into_iter().enumerate() {
        let found = standard.maxima.get(k).map_or(f64::NAN, |at| at.0 - contact);
        record.show(format!("time from contact to height {} [s]", k + 1), found, Some(time));
    }
    record.at_most("wall-clock time of all bounces on one core [s]", standard.seconds, COST);
    let mut curves = vec![
        ("measured".to_owned(), measured(MEASURED)?),
        ("computed".to_owned(), from_contact(standard, contact - SHOWN_BEFORE)),
    ];
    for ((name, _, bound), other) in variants.iter().zip(others) {
        for (k, of) in standard.maxima.iter().take(2).enumerate() {
            let change = other.maxima.get(k).map_or(f64::NAN, |found| (found.1 / of.1 - 1.0).abs());
            let row = format!("{name}: relative change of the height of bounce {}", k + 1);
            match bound {
                Some(bound) => record.at_most(row, change, *bound),
                None => record.show(row, change, None),
            }
        }
        let shown = other.contact.map_or(0.0, |contact| contact - SHOWN_BEFORE);
        curves.push(((*name).to_owned(), from_contact(other, shown)));
    }
    record.figure("Gap over the time from the first contact [m]", "time [s]", curves);
    record.tables.push(inputs(INPUTS));
    record.note("Nothing is fitted; the coefficients are those of the standard set.");
    Ok(())
}
