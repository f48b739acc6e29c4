//! Bodies that pass vertices, edges and faces of the mesh: condition numbers, and effects on results.

use cutwater::fluid_ns::terms::CipProfile;
use cutwater::mesh::SimplexMesh;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use super::flow::{self, fluid_mut, fluid_of};
use super::orders::{Couette, couette_setup};
use super::record::worse;
use super::signal::{mean, rms};
use super::sweep::{FlowValues, PLANE, SHORT, SPACE, STEADY, Sweep, SweepResult, solve};
use super::{Failure, P, Record};

/// Largest ratio of condition numbers of the equilibrated matrix over a sweep with ghost penalty.
const LARGEST_RATIO: f64 = 10.0;
/// Distances in cells are `±10^-k` with these `k`.
const DECADES: std::ops::RangeInclusive<i32> = 1..=14;
/// The same `k` for a short run.
const FEW_DECADES: [i32; 6] = [1, 3, 6, 9, 12, 14];
/// Range of distances, in cells, in which the solution must not change on either side. At smaller distances round-off
/// may put a surface onto the mesh.
const NEAR: [f64; 2] = [1e-12, 1e-6];
/// Largest change in this range, divided by the error on the mesh.
const LARGEST_CHANGE: f64 = 1e-5;
/// Largest jump where the surface touches the part of the mesh, divided by the error on the mesh.
const LARGEST_JUMP: f64 = 1.0;

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    for sweep in &PLANE {
        measure_sweep(record, sweep)?;
    }
    for sweep in &SPACE {
        measure_sweep(record, sweep)?;
    }
    scatter(record)?;
    record.note(
        "One step of 1e9 s, a Stokes flow, or of 1e-6 s, in which the penalty of the mortar and the matrix are those of inertia; 12 × 12 squares or 5 × 5 × 5 cubes of tetrahedra, bodies of which a vertex, edge or face of the mesh is \
         left behind and passed: cells keep corners, wedges, slices. Without ghost penalty its weight is zero. In both cases \
         there is no interior penalty of the velocity; that of the pressure stays, as the pair of spaces needs it. Condition \
         numbers are in the Euclidean norm, of the matrix as it is and of the equilibrated one, which is factorised.",
    );
    record.note(
        "Where cells keep corners with unknowns of their own, the condition number of the matrix as it is grows without bound \
         without ghost penalty, and does not with it. Along slices and wedges it does not grow, as the mortar couples their \
         unknowns over the whole length of the interface. The condition number of the equilibrated matrix does not grow in any case: for linear \
         functions, the scaling of rows and columns removes the effect of small parts. Unknowns beyond a corner by itself take values of any size without \
         ghost penalty, but they do not count in the fluid of this step.",
    );
    record.note(
        "Jumps at the touch are those of the ghost penalty, which loses or gains the faces of a cell as this loses or gains a \
         part. The exact force on the bodies is zero. In the annulus, all penalties of gradient jumps are taken away together.",
    );
    Ok(())
}

/// Distances, from the most negative to the largest, and results.
type Findings<const D: usize> = Vec<(f64, SweepResult<D>)>;

fn measure_sweep<const D: usize>(record: &mut Record, sweep: &Sweep<D>) -> Result<(), Failure> {
    let decades: Vec<i32> = if record.full { DECADES.collect() } else { FEW_DECADES.to_vec() };
    let before = decades.iter().map(|k| -(10.0_f64.powi(-k)));
    let distances: Vec<f64> = before.chain([0.0]).chain(decades.iter().rev().map(|k| 10.0_f64.powi(-k))).collect();
    let name = sweep.name;
    let mut curves = Vec::new();
    for (ghost, label) in [(true, "with ghost penalty"), (false, "without")] {
        let mut findings: Findings<D> = Vec::new();
        for &distance in &distances {
            findings.push((distance, solve(&sweep.setup(distance, STEADY, ghost)?)?));
        }
        for (k, matrix) in ["equilibrated", "as it is"].into_iter().enumerate() {
            let conditions = || findings.iter().map(|(_, found)| found.conditions[k]);
            let (largest, least) = (conditions().fold(0.0, worse), conditions().fold(f64::INFINITY, f64::min));
            let quantity = format!("{name}, {label}: condition number of the matrix {matrix}, largest over least");
            if ghost {
                record.at_most(quantity, largest / least, LARGEST_RATIO);
            } else {
                record.show(quantity, largest / least, None);
            }
            if k == 0 {
                record.show(format!("{name}, {label}: the largest"), largest, None);
            }
            curves.push((format!("{label}, {matrix}"), worse_side(&findings, k)));
        }
        let setup = sweep.setup(0.0, STEADY, ghost)?;
        let background = &fluid_of(&setup)?.background;
        let errors = findings.iter().map(|(_, found)| {
            let flow = found.flow.as_ref();
            flow.map_or(f64::INFINITY, |flow| flow.differences(&flow.exact(background))[0])
        });
        let [least, largest] = errors.fold([f64::INFINITY, 0.0], |[a, b], e| [f64::min(a, e), worse(b, e)]);
        record.show(format!("{name}, {label}: largest error of velocities, largest over least"), largest / least, None);
        if ghost {
            continuity(record, name, background, &findings)?;
        }
    }
    for (ghost, label) in [(true, "with ghost penalty"), (false, "without")] {
        let mut conditions = [0.0, f64::INFINITY];
        for &distance in &distances {
            let [found, _] = solve(&sweep.setup(distance, SHORT, ghost)?)?.conditions;
            conditions = [worse(conditions[0], found), conditions[1].min(found)];
        }
        let quantity = format!(
            "{name}, step of {SHORT:e} s, {label}: condition number of the matrix equilibrated, largest over least"
        );
        let ratio = conditions[0] / conditions[1];
        if ghost { record.at_most(quantity, ratio, LARGEST_RATIO) } else { record.show(quantity, ratio, None) }
    }
    record.log_figure(format!("{name}: condition number, the larger of both sides"), "distance over h", curves);
    Ok(())
}

/// Returns the larger condition number of the two sides at each distance.
fn worse_side<const D: usize>(findings: &Findings<D>, matrix: usize) -> Vec<(f64, f64)> {
    let half = findings.len() / 2;
    let pairs = findings[..half].iter().zip(findings.iter().rev());
    pairs.map(|((d, a), (_, b))| (d.abs(), a.conditions[matrix].max(b.conditions[matrix]))).collect()
}

/// Adds the changes of velocity, pressure, force and kinetic energy at small distances, and their jumps at zero.
fn continuity<const D: usize>(
    record: &mut Record,
    name: &str,
    background: &SimplexMesh<D>,
    findings: &Findings<D>,
) -> Result<(), Failure> {
    let flows = findings.iter().map(|(d, found)| found.flow.as_ref().map(|flow| (*d, flow)));
    let flows: Vec<(f64, &FlowValues<D>)> = flows.collect::<Option<_>>().ok_or("a step fails with ghost penalty")?;
    let touch = flows[flows.len() / 2].1;
    let errors = touch.differences(&touch.exact(background));
    let [closest, near] = NEAR.map(|d| d * (1.0 + f64::EPSILON));
    let is_near = |d: f64| d.abs() <= near && d.abs() > 0.5 * closest;
    let largest = |pairs: &mut dyn Iterator<Item = (&FlowValues<D>, &FlowValues<D>)>| {
        pairs.fold([0.0; 2], |largest, (a, b)| {
            let [u, p, f] = a.differences(b);
            let of_errors = [u / errors[0], p / errors[1], f / errors[2]].into_iter().fold(0.0, worse);
            let relative = [of_errors, (a.energy / b.energy - 1.0).abs()];
            std::array::from_fn(|k| worse(largest[k], relative[k]))
        })
    };
    let neighbours = || flows.windows(2).map(|pair| (pair[0], pair[1]));
    let on_one_side = neighbours().filter(|((a, _), (b, _))| is_near(*a) && is_near(*b) && a * b > 0.0);
    let at_touch = neighbours().filter(|((a, _), (b, _))| a.abs() <= closest && b.abs() <= closest);
    let changes = largest(&mut on_one_side.map(|((_, a), (_, b))| (a, b)));
    let jumps = largest(&mut at_touch.map(|((_, a), (_, b))| (a, b)));
    let what = format!("{name}: velocities, pressures and force, over their errors on this mesh");
    record.at_most(format!("{what}: largest change from 1e-6 h to 1e-12 h"), changes[0], LARGEST_CHANGE);
    record.at_most(format!("{what}: largest jump at the touch"), jumps[0], LARGEST_JUMP);
    record.at_most(format!("{name}: relative change of the kinetic energy from 1e-6 h to 1e-12 h"), changes[1], 1e-6);
    Ok(())
}

/// Largest scatter of the error over places of the mesh, relative to the mean error: the first digit of the error does
/// not depend on the place.
const LARGEST_SCATTER: f64 = 0.1;

/// Measures torques of the flow between cylinders at random places of the mesh.
fn scatter(record: &mut Record) -> Result<(), Failure> {
    let (n, places) = if record.full { (32, 100) } else { (20, 25) };
    let h = 1.0 / n as f64;
    let mut curves = Vec::new();
    for (ghost, label) in [(true, "with ghost penalty"), (false, "without any penalty of jumps of gradients")] {
        let mut random = SplitMix64::seed_from_u64(11);
        let (mut torques, mut unsolved) = (Vec::new(), 0.0);
        for _ in 0..places {
            let centre = P::new(random.random_range(0.0..h), random.random_range(0.0..h));
            let (_, mut setup) = couette_setup(n, centre)?;
            if !ghost {
                let set = &mut fluid_mut(&mut setup)?.stabilisation;
                (set.gamma_ghost, set.cip) = (0.0, CipProfile::Consistent { gamma_u: 0.0 });
            }
            let (state, report) = match flow::run(&setup, 1) {
                Ok(solved) => solved,
                // The mortar needs the ghost penalty where a cut leaves a sliver.
                Err(_) if !ghost => {
                    unsolved += 1.0;
                    continue;
                }
                Err(failure) => return Err(failure),
            };
            torques.push(flow::force(&state, &report, 0, &centre)?.1 / Couette::TORQUE - 1.0);
        }
        torques.sort_unstable_by(f64::total_cmp);
        let mean = mean(&torques);
        let deviations: Vec<f64> = torques.iter().map(|torque| torque - mean).collect();
        let largest = deviations.iter().map(|d| d.abs()).fold(0.0, worse);
        let name = format!("Couette torque, {places} random places, h = 1/{n}, {label}");
        record.show(format!("{name}: mean relative error"), mean, Some(0.0));
        record.show(format!("{name}: places without a solution"), unsolved, Some(0.0));
        for (what, value) in [("standard deviation", rms(&deviations)), ("largest deviation", largest)] {
            let quantity = format!("{name}: {what}, relative to the mean error");
            if ghost {
                record.at_most(quantity, value, LARGEST_SCATTER * mean.abs());
            } else {
                record.show(quantity, value, Some(mean.abs()));
            }
        }
        let rank = |k: usize| (k as f64 + 0.5) / places as f64;
        curves.push((label.to_owned(), deviations.iter().enumerate().map(|(k, d)| (rank(k), *d)).collect()));
        curves.push((format!("{label}: error of the mean"), vec![(0.0, mean), (1.0, mean)]));
    }
    record.figure("Couette torque: relative deviations from the mean, sorted", "share of the places", curves);
    Ok(())
}
