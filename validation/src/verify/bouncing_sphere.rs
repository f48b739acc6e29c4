//! Spheres that bounce off the floor of a tank, compared with measured heights.

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;
use cutwater::solver::{Observer, ObserverError, State, StepView, TimeLoop};

use super::{Failure, Record};
use crate::case::example_path;

/// Radius of the sphere, m; speed of the approach, m/s.
const RADIUS: f64 = 1.5e-3;
const SPEED: f64 = 0.585;
/// Measured heights of the bounces, m, with the largest relative errors; the third is shown.
const HEIGHTS: [(f64, Option<f64>); 3] = [(7.466e-3, Some(0.05)), (2.234e-3, Some(0.08)), (0.520e-3, None)];
/// Largest relative error of the speed at a gap of one radius, and change of the heights with mesh and step.
const APPROACH: f64 = 0.02;
const CHANGE: f64 = 0.03;
/// Longest wall-clock time through the second bounce, s.
const COST: f64 = 2400.0;
/// Restitution at the Stokes number 152 over that in air, by the fit of Legendre, Zenit and Daniel 2006, doi:10.1063/1.2164462, and the scatter of measured values
/// on coarse meshes.
const RESTITUTION: (f64, f64) = (0.79, 0.15);
const MEASURED: &str = include_str!("../../reference/gondret/St152.csv");

/// Time, gap and velocity of all steps.
#[derive(Default)]
struct Fall(Vec<[f64; 3]>);

impl Observer<2> for Fall {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        if let Some(body) = view.report.map(|report| &report.bodies[0]) {
            self.0.push([view.state.time, body.lowest.1[1], body.lowest_velocity[1]]);
        }
        Ok(())
    }
}

/// A fall with its bounces.
struct Bounces {
    series: Vec<[f64; 3]>,
    /// Time of the first contact.
    contact: f64,
    /// Times and heights of the maxima after it.
    maxima: Vec<(f64, f64)>,
    seconds: f64,
}

/// Computes a fall until there are some bounces.
fn fall(changes: &[String], bounces: usize) -> Result<Bounces, Failure> {
    let begin = std::time::Instant::now();
    let case = case::<2>(&ScenarioFile::read(&example_path("bouncing-sphere"), changes)?)?;
    let (setup, mut fall) = (case.setup, Fall::default());
    let mut run = TimeLoop::new(&setup, State::initial(&setup)?, case.workspace);
    for _ in 0..case.n_steps {
        run.run(1, &mut [&mut fall])?;
        // A maximum counts once the sphere has fallen by a part of a radius.
        let (maxima, now) = (maxima(&fall.0), fall.0.last().map_or(0.0, |at| at[1]));
        if maxima.len() >= bounces && maxima.last().is_some_and(|(_, height)| now < height - 0.05 * RADIUS) {
            break;
        }
    }
    let contact = lowest(&fall.0).ok_or("the sphere does not reach the floor")?;
    let contact = fall.0[contact][0];
    Ok(Bounces { maxima: maxima(&fall.0), contact, series: fall.0, seconds: begin.elapsed().as_secs_f64() })
}

/// Returns the number of the step with the first upward velocity.
fn lowest(series: &[[f64; 3]]) -> Option<usize> {
    series.windows(2).position(|pair| pair[0][2] < 0.0 && pair[1][2] > 0.0)
}

/// Returns the times and heights at which the velocity changes from upward to downward.
fn maxima(series: &[[f64; 3]]) -> Vec<(f64, f64)> {
    let turns = series.windows(2).filter(|pair| pair[0][2] > 0.0 && pair[1][2] <= 0.0);
    turns.map(|pair| (pair[0][0], pair[0][1].max(pair[1][1]))).collect()
}

/// Returns the speed at which a gap is passed downwards for the first time.
fn speed_at(series: &[[f64; 3]], gap: f64) -> Option<f64> {
    let pair = series.windows(2).find(|pair| pair[0][1] >= gap && pair[1][1] < gap)?;
    let share = (pair[0][1] - gap) / (pair[0][1] - pair[1][1]);
    Some(-(pair[0][2] + share * (pair[1][2] - pair[0][2])))
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if record.full { compare(record) } else { coarse(record) }
}

/// Lets the sphere go near the floor on a coarse mesh.
fn coarse(record: &mut Record) -> Result<(), Failure> {
    let mut changes: Vec<String> = [
        "body.0.shape.centre=[0.0, 4.5e-3]",
        "body.0.shape.size=4.0e-5",
        "body.0.motion.guided.until=3.0e-3",
        "body.0.motion.guided.velocity=[\"0\", \"-0.585*min(t/1e-3, 1)\"]",
        "time.step=1.0e-4",
        "time.end=0.02",
        "time.approach.fraction=0.2",
        "time.approach.smallest=5.0e-6",
    ]
    .map(str::to_owned)
    .to_vec();
    let sizes = [6e-4, 3e-4, 1.5e-4, 6e-5];
    changes.extend(sizes.iter().enumerate().map(|(k, size)| format!("background.refine.{k}.size={size}")));
    let fall = fall(&changes, 1)?;
    let after = lowest(&fall.series).ok_or("the sphere does not reach the floor")? + 1;
    let fastest = fall.series[after..].iter().map(|at| at[2]).fold(0.0, f64::max);
    let name =
        "coarse cells, released at a radius from the floor: largest speed after the collision over the one before";
    record.near(name, fastest / SPEED / 0.97, RESTITUTION.0, RESTITUTION.1);
    Ok(())
}

/// Compares the bounces with the measured ones, and with those on another mesh, with other steps, and without vapour.
fn compare(record: &mut Record) -> Result<(), Failure> {
    let long = ["time.end=0.2".to_owned()];
    let standard = fall(&long, 3)?;
    let speed = speed_at(&standard.series, RADIUS).ok_or("the sphere does not reach the floor")?;
    record.near_relative("speed at a gap of one radius [m/s]", speed, SPEED, APPROACH);
    for (k, (height, bound)) in HEIGHTS.into_iter().enumerate() {
        let found = standard.maxima.get(k).map_or(f64::NAN, |at| at.1);
        let name = format!("height of bounce {} [m]", k + 1);
        match bound {
            Some(bound) => record.near_relative(name, found, height, bound),
            None => record.show(name, found, Some(height)),
        }
    }
    let first = standard.maxima.first().map_or(f64::NAN, |at| at.0 - standard.contact);
    record.show("time from contact to the first height [s]", first, Some(0.038));
    record.at_most("wall-clock time of all bounces on one core [s]", standard.seconds, COST);
    let coarse_mesh = (0..4).map(|k| format!("background.refine.{k}.size={}", [3e-4, 1.5e-4, 7.5e-5, 1.875e-5][k]));
    let coarse_steps = ["time.step=1.0e-4", "time.approach.fraction=0.12", "time.approach.smallest=1.0e-6"];
    let variants = [
        ("cells of twice the size", coarse_mesh.collect::<Vec<_>>(), Some(CHANGE)),
        ("steps of twice the length", coarse_steps.map(str::to_owned).to_vec(), Some(CHANGE)),
        ("vapour only at -1000 bar", vec!["fluid.film.floor=-1e8".to_owned()], None),
    ];
    let mut curves = vec![("computed".to_owned(), from_contact(&standard))];
    for (name, changes, bound) in variants {
        let changes: Vec<String> = long.iter().cloned().chain(changes).collect();
        let other = fall(&changes, 2)?;
        for (k, (found, of)) in other.maxima.iter().zip(&standard.maxima).take(2).enumerate() {
            let change = (found.1 / of.1 - 1.0).abs();
            let row = format!("{name}: relative change of the height of bounce {}", k + 1);
            match bound {
                Some(bound) => record.at_most(row, change, bound),
                None => record.show(row, change, None),
            }
        }
        curves.push((name.to_owned(), from_contact(&other)));
    }
    let measured = MEASURED.lines().skip(1).map(|line| {
        let (time, gap) = line.split_once(',').ok_or("two columns")?;
        Ok((time.parse()?, gap.parse()?))
    });
    curves.insert(0, ("measured".to_owned(), measured.collect::<Result<_, Failure>>()?));
    record.figure("Gap over the time from the first contact [m]", "time [s]", curves);
    record.note(
        "Measured: Gondret, Lance, Petit 2002, doi:10.1063/1.1427920; steel in silicone oil, Stokes number 152. Inputs: densities and viscosity, the speed of the approach, a roughness of \
         1e-4 radii, a restitution of 0.97 in air, vapour at one atmosphere below the surroundings; the standard set. Nothing is fitted. The size of the tank and the roughness of these spheres are not \
         known.",
    );
    Ok(())
}

/// Returns the gap over the time from the first contact.
fn from_contact(bounces: &Bounces) -> Vec<(f64, f64)> {
    let steps = bounces.series.iter().filter(|at| at[0] > bounces.contact - 0.016);
    steps.map(|at| (at[0] - bounces.contact, at[1])).collect()
}
