//! A sphere that sinks to the floor of a tank, compared with measured speeds.

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;

use super::signal::passage;
use super::{DirectRun, Failure, Record, short};
use crate::case::example_path;

/// A case of the experiment: name, density and viscosity of the oil, speed in an infinite fluid, largest measured
/// speed, bound on the relative difference from it, measured speeds.
struct Experiment {
    name: &'static str,
    density: f64,
    viscosity: f64,
    infinite: f64,
    largest: f64,
    bound: f64,
    speeds: &'static str,
}

const CASES: [Experiment; 4] = [
    experiment("E1", [970.0, 0.373, 0.03829, 0.0363, 0.025], include_str!("../../reference/ten-cate/E1.csv")),
    experiment("E2", [965.0, 0.212, 0.05992, 0.0571, 0.03], include_str!("../../reference/ten-cate/E2.csv")),
    experiment("E3", [962.0, 0.113, 0.09062, 0.0869, 0.025], include_str!("../../reference/ten-cate/E3.csv")),
    experiment("E4", [960.0, 0.058, 0.12839, 0.1226, 0.025], include_str!("../../reference/ten-cate/E4.csv")),
];

/// Returns a case from its numbers in the order of the fields.
const fn experiment(
    name: &'static str,
    [density, viscosity, infinite, largest, bound]: [f64; 5],
    speeds: &'static str,
) -> Experiment {
    Experiment { name, density, viscosity, infinite, largest, bound, speeds }
}

// Radius of the sphere, m, and acceleration of gravity, m/s².
const RADIUS: f64 = 7.5e-3;
const GRAVITY: f64 = 9.81;
/// Time step times the speed in an infinite fluid, over the radius.
const STEP: f64 = 0.05;
/// Gap, relative to the radius, at which the run ends: three of the finer cells.
const LAST_GAP: f64 = 0.125;
/// A fall is an error if it takes longer than this multiple of the height divided by the largest speed.
const LONGEST: f64 = 2.0;
/// Time from which speeds are compared, s: before it the sphere is being released.
const RELEASED: f64 = 0.05;
// Largest root of the mean squared difference of speeds during the fall over the speed in an infinite fluid, and
// largest difference in the approach to the floor.
const FALL: f64 = 0.03;
const APPROACH: f64 = 0.05;
/// The approach is aligned where the speed has fallen to this share of the largest one.
const ALIGNED: f64 = 0.75;
/// Radius of the tank whose walls slow the sphere in Stokes flow as much as the square ones do, m.
const SAME_WALL_FACTOR: f64 = 0.0553;

/// Measures the cases; the quick version is the first second of the fastest one with coarser cells.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if !record.full {
        let of = &CASES[3];
        let coarse = ["background.refine.0.size=1.25e-3".to_owned(), "background.refine.1.size=1.25e-3".to_owned()];
        let fall = fall(of, 2.0 * STEP, &coarse, 0.6)?;
        let speed = fall.iter().map(|at| at[1]).fold(0.0, f64::max);
        let last = points(of.speeds)?.into_iter().find(|at| at.0 > 0.6).ok_or("a measured speed")?;
        record.near_relative("E4, coarse cells: speed at 0.6 s [m/s]", speed, last.1, 0.05);
        return Ok(());
    }
    for of in &CASES {
        compare(record, of)?;
    }
    let narrow = [format!("background.max=[{SAME_WALL_FACTOR}, 0.16]")];
    let fall = fall(&CASES[3], STEP, &narrow, f64::INFINITY)?;
    let largest = fall.iter().map(|at| at[1]).fold(0.0, f64::max);
    record.show(
        "E4, tank of the same wall factor as the square one: largest speed [m/s]",
        largest,
        Some(CASES[3].largest),
    );
    record.note(
        "Experiment: ten Cate, Nieuwstad, Derksen, Van den Akker 2002, doi:10.1063/1.1512918, with speeds digitised from its figures. Inputs are the densities, viscosities and \
         sizes of the paper, and the standard stabilisation; nothing is fitted. The square tank is a round one of the same area. The surface of the oil is flat and free of shear. Speeds in the \
         approach are compared at equal times since the speed was three quarters of the largest one, because a difference of 1 % in the time of the fall is larger than all of the approach.",
    );
    Ok(())
}

/// Returns measured times and speeds, downwards.
fn points(text: &str) -> Result<Vec<(f64, f64)>, Failure> {
    let line = |line: &str| -> Result<(f64, f64), Failure> {
        let (time, speed) = line.split_once(',').ok_or("two columns")?;
        Ok((time.parse()?, -speed.parse::<f64>()?))
    };
    text.lines().skip(1).map(line).collect()
}

/// Computes time, speed and gap of all steps until the sphere is near the floor, or until a time.
fn fall(of: &Experiment, step: f64, changes: &[String], end: f64) -> Result<Vec<[f64; 3]>, Failure> {
    let dt = step * RADIUS / of.infinite;
    let mut changes = changes.to_vec();
    changes.extend([
        format!("fluid.density={}", of.density),
        format!("fluid.viscosity={}", of.viscosity),
        format!("fluid.body_force=[0.0, {}]", -of.density * GRAVITY),
        format!("time.step={dt}"),
        format!("time.end={}", 100.0 * dt),
    ]);
    let case = case::<2>(&ScenarioFile::read(&example_path("settling-sphere"), &changes)?)?;
    let mut run = DirectRun::lagged(case.setup)?;
    let mut found = Vec::new();
    let last = end.min(LONGEST * 0.12 / of.largest);
    while run.state.time < last {
        let report = run.advance()?;
        let body = &report.bodies[0];
        let balance = body.balance.ok_or("a free body has a mass")?;
        let gap = body.lowest.1[1];
        found.push([run.state.time, -balance.momentum[1] / balance.mass, gap]);
        if gap < LAST_GAP * RADIUS {
            break;
        }
    }
    Ok(found)
}

/// Returns the speed at a time; `None` outside of the series.
fn at(series: &[(f64, f64)], time: f64) -> Option<f64> {
    let after = series.iter().position(|(t, _)| *t >= time)?;
    let ((t0, v0), (t1, v1)) = (series[after.checked_sub(1)?], series[after]);
    Some(v0 + (v1 - v0) * (time - t0) / (t1 - t0))
}

/// Returns the time at which the speed has fallen to a value, the last one.
fn falls_to(series: &[(f64, f64)], speed: f64) -> Option<f64> {
    let pair = series.windows(2).rev().find(|pair| pair[0].1 >= speed && pair[1].1 < speed)?;
    Some(passage([pair[0], pair[1]], speed))
}

fn compare(record: &mut Record, of: &Experiment) -> Result<(), Failure> {
    let fall = fall(of, STEP, &[], f64::INFINITY)?;
    let speeds: Vec<(f64, f64)> = fall.iter().map(|at| (at[0], at[1])).collect();
    let measured = points(of.speeds)?;
    let name = of.name;
    let largest = speeds.iter().map(|at| at.1).fold(0.0, f64::max);
    record.near_relative(format!("{name}: largest speed [m/s]"), largest, of.largest, of.bound);
    let arrives = fall.iter().find(|at| at[2] < 0.5 * RADIUS).ok_or("the sphere does not arrive")?[0];
    let in_fall = measured.iter().filter(|at| RELEASED < at.0 && at.0 < arrives);
    let squares: Vec<f64> = in_fall.filter_map(|p| Some((at(&speeds, p.0)? - p.1).powi(2))).collect();
    let mean = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    record.at_most(
        format!("{name}: difference of speeds until a gap of half a radius, over u_inf, mean"),
        mean / of.infinite,
        FALL,
    );
    let aligned = falls_to(&speeds, ALIGNED * largest).zip(falls_to(&measured, ALIGNED * largest));
    if let Some((ours, theirs)) = aligned {
        let peak = measured.iter().fold((0.0, 0.0), |best: (f64, f64), p| if p.1 > best.1 { *p } else { best });
        let late = measured.iter().filter(|p| p.0 > peak.0);
        let difference = |p: &(f64, f64)| Some((at(&speeds, p.0 - theirs + ours)? - p.1).abs() / of.infinite);
        let largest = late.filter_map(difference).fold(0.0, f64::max);
        record.at_most(format!("{name}: largest difference of speeds in the approach, over u_inf"), largest, APPROACH);
        record.show(format!("{name}: time of the approach [s]"), ours, Some(theirs));
    } else {
        record.show(format!("{name}: the measured approach ends before it can be aligned"), f64::NAN, None);
    }
    record.figure(
        format!("{name}: speed [m/s]"),
        "time [s]",
        vec![("measured".to_owned(), measured), (format!("computed, {} steps", short(fall.len() as f64)), speeds)],
    );
    Ok(())
}
