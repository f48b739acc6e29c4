//! The Turek-Hron benchmarks FSI2 and FSI3: an elastic flag behind a cylinder, which swings in the vortices that it
//! sheds.

use std::f64::consts::TAU;
use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::solid_svk::{LameParameters, Order, SaintVenantKirchhoff, Support, SupportKind};
use cutwater::solver::body::PointField;

use super::channel::{CENTRE, Channel, ChannelResolution, RADIUS, step_with_force, velocity_at};
use super::csm::{SOFT, STIFF, displacement};
use super::dry::{elastic_of, second_order};
use super::flow::fluid_mut;
use super::fsi::{ROWS, obstacle};
use super::record::{Points, TextTable};
use super::signal::{is_steady, last_cycles, mean_and_amplitude, rises};
use super::{DirectRun, Failure, P, Record, V, short};

/// A benchmark, and what is known of it.
struct Benchmark {
    name: &'static str,
    /// Mean speed of the inflow, m/s; density, kg/m³, and shear modulus, Pa, of the flag.
    speed: f64,
    density: f64,
    shear_modulus: f64,
    /// In the order of [`NAMES`]: FEATFLOW, level 4.
    known: [f64; 9],
    /// Largest relative errors of amplitude and frequency of `u_y`.
    accuracy: [f64; 2],
    /// Cells in a diameter of the cylinder, and time step, s. Each run begins with the end of the one before.
    runs: &'static [(usize, f64)],
    /// Time until which each run has to be periodic, s.
    latest: f64,
}

const FSI2: Benchmark = Benchmark {
    name: "FSI2",
    speed: 1.0,
    density: 1e4,
    shear_modulus: SOFT,
    known: [1.30e-3, 81.6e-3, 1.93, -14.85e-3, 12.70e-3, 215.06, 77.65, 0.61, 237.8],
    accuracy: [0.05, 0.03],
    runs: &[(16, 1e-2), (32, 1e-2), (32, 5e-3)],
    latest: 20.0,
};
const FSI3: Benchmark = Benchmark {
    name: "FSI3",
    speed: 2.0,
    density: 1e3,
    shear_modulus: STIFF,
    known: [1.47e-3, 34.99e-3, 5.46, -2.88e-3, 2.72e-3, 460.5, 27.74, 2.50, 153.91],
    accuracy: [0.08, 0.04],
    runs: &[(16, 4e-3), (32, 4e-3), (32, 2e-3)],
    latest: 10.0,
};
const NAMES: [&str; 9] = [
    "mean of u_y [m]",
    "amplitude of u_y [m]",
    "frequency of u_y [Hz]",
    "mean of u_x [m]",
    "amplitude of u_x [m]",
    "mean of the drag [N/m]",
    "amplitude of the drag [N/m]",
    "mean of the lift [N/m]",
    "amplitude of the lift [N/m]",
];
// Indices in [`NAMES`] of the quantities that are compared.
const AMPLITUDE: usize = 1;
const FREQUENCY: usize = 2;

/// Cells in a diameter and time step, s, of the quick version, which computes the first two cycles of FSI2.
const QUICK: (usize, f64) = (16, 1e-2);
/// Largest relative error of its frequency: the swing is not yet that of the reference.
const QUICK_ACCURACY: f64 = 0.1;
/// Time until which there have to be two cycles, s: that of five cycles of the reference.
const QUICK_LATEST: f64 = 2.6;
/// Spectral radius of generalised-α for infinitely fast changes, that of all checks where bodies uncover fluid
/// (`orders`).
const RHO_INF: f64 = 0.0;
/// Tolerance of Newton's method, that of `dfg-unsteady`.
const TOLERANCE: f64 = 1e-8;
// Cycles in a row in which amplitude and frequency of `u_y` differ by at most a fraction when the motion is periodic.
const N_CYCLES: usize = 3;
const UNCHANGED: f64 = 5e-3;

/// Displacement of the tip and force on cylinder and flag over time.
#[derive(Default)]
struct FsiSignals {
    u: [Points; 2],
    force: [Points; 2],
}

impl FsiSignals {
    /// Takes a step and adds its values. Forces are those at the stage of the step, displacements those at its end.
    fn advance(&mut self, run: &mut DirectRun) -> Result<(), Failure> {
        let (at_stage, force) = step_with_force(run)?;
        let u = displacement(run)?;
        for k in 0..2 {
            self.u[k].push((run.state.time, u[k]));
            self.force[k].push((at_stage, force[k]));
        }
        Ok(())
    }

    /// Returns the numbers of each cycle, in the order of [`NAMES`]: from one upward passage of `u_y = 0` to the next.
    fn cycles(&self) -> Vec<[f64; 9]> {
        let cycle = |w: &[(usize, f64)]| {
            let of = |curve: &Points| mean_and_amplitude(&curve[w[0].0 - 1..w[1].0 + 1]);
            let [[x, across], [y, along]] = [of(&self.u[0]), of(&self.u[1])];
            let [[drag, of_drag], [lift, of_lift]] = [of(&self.force[0]), of(&self.force[1])];
            [y, along, (w[1].1 - w[0].1).recip(), x, across, drag, of_drag, lift, of_lift]
        };
        rises(&self.u[1], 0.0).windows(2).map(cycle).collect()
    }

    /// Returns the last cycle if the motion is periodic.
    fn periodic(&self) -> Option<[f64; 9]> {
        let cycles = self.cycles();
        let last = cycles.len().checked_sub(N_CYCLES).map(|first| &cycles[first..])?;
        let is_same = |k: usize| is_steady(last.iter().map(|cycle| cycle[k]), UNCHANGED);
        (is_same(AMPLITUDE) && is_same(FREQUENCY)).then(|| last[N_CYCLES - 1])
    }

    /// Returns a curve in the last cycles, from the first passage.
    fn last_cycles(&self, curve: &Points) -> Points {
        last_cycles(curve, &rises(&self.u[1], 0.0), N_CYCLES)
    }
}

/// Velocity of the fluid, displacement and velocity of the flag at the begin of a run.
struct Start {
    fluid: PointField<2>,
    displacement: PointField<2>,
    velocity: PointField<2>,
}

impl Benchmark {
    fn channel(&self) -> Channel {
        Channel { length: 2.5, density: 1e3, viscosity: 1.0, speed: self.speed, has_flag: true }
    }

    /// Returns the parabola of the inflow everywhere, and a straight flag with the greatest speed of a swing of half
    /// the amplitude of the reference: its amplitude has to grow to the one that is compared.
    fn start(&self) -> Start {
        let (channel, fastest) = (self.channel(), 0.5 * TAU * self.known[FREQUENCY] * self.known[AMPLITUDE]);
        Start {
            fluid: Arc::new(move |x| V::new(channel.inflow(x[1]), 0.0)),
            displacement: Arc::new(|_| V::zeros()),
            velocity: Arc::new(move |x| {
                let along = ((x[0] - CENTRE[0] - RADIUS) / (0.4 - RADIUS)).max(0.0);
                V::new(0.0, fastest * along * along)
            }),
        }
    }

    fn run(&self, (cells, dt): (usize, f64), start: Start) -> Result<DirectRun, Failure> {
        let resolution = ChannelResolution { swing: self.known[AMPLITUDE], ..ChannelResolution::new(cells) };
        let mut setup = self.channel().setup(&resolution, |_| 1.0)?;
        (setup.scheme, setup.dt, setup.newton) = (second_order(RHO_INF)?, dt, NewtonSettings::new(TOLERANCE));
        fluid_mut(&mut setup)?.initial_velocity = Some(start.fluid);
        let (solid, held) = obstacle(ROWS, Order::Quadratic)?;
        let material = SaintVenantKirchhoff::new(LameParameters::new(self.shear_modulus, 4.0 * self.shear_modulus)?);
        let mut flag = elastic_of(solid, self.density, material, V::zeros(), Arc::clone(&setup.scheme))?;
        flag.options.supports.push(Support { vertices: held, kind: SupportKind::Clamped });
        flag.options.initial_displacement = Some(start.displacement);
        flag.options.initial_velocity = Some(start.velocity);
        setup.bodies = vec![flag.body("flag")?];
        DirectRun::lagged(setup)
    }

    fn measure(&self, record: &mut Record) -> Result<(), Failure> {
        let mut start = self.start();
        let (mut rows, mut of_tip, mut of_lift) = (Vec::new(), Vec::new(), Vec::new());
        for (n, &(cells, dt)) in self.runs.iter().enumerate() {
            let name = format!("h = D/{cells}, dt = {} s", short(dt));
            let mut run = self.run((cells, dt), start)?;
            let mut signals = FsiSignals::default();
            let found = run.until(self.latest, |run| {
                signals.advance(run)?;
                Ok(signals.periodic())
            })?;
            let found = found.ok_or_else(|| format!("{}, {name}: the motion is not periodic", self.name))?;
            for (k, quantity) in NAMES.into_iter().enumerate() {
                let quantity = format!("{}, {name}: {quantity}", self.name);
                match [AMPLITUDE, FREQUENCY].into_iter().position(|judged| judged == k) {
                    Some(judged) if n + 1 == self.runs.len() => {
                        record.near_relative(quantity, found[k], self.known[k], self.accuracy[judged]);
                    }
                    _ => record.show(quantity, found[k], Some(self.known[k])),
                }
            }
            of_tip.push((name.clone(), signals.last_cycles(&signals.u[1])));
            of_lift.push((name, signals.last_cycles(&signals.force[1])));
            rows.push(vec![format!("{}, D/{cells}", self.name), short(dt), short(run.state.time)]);
            start = Start::of(run)?;
        }
        record.tables.push(TextTable {
            head: ["benchmark, fluid", "dt [s]", "periodic after [s]"].map(str::to_owned).into(),
            rows,
        });
        record.figure(format!("{}: u_y of the tip [m]", self.name), "t [s]", of_tip);
        record.figure(format!("{}: lift [N/m]", self.name), "t [s]", of_lift);
        Ok(())
    }
}

impl Start {
    /// Returns the end of a run.
    fn of(run: DirectRun) -> Result<Self, Failure> {
        let (nodes, flag) = (run.setup.bodies[0].reference(), &run.state.bodies[0]);
        let displacement = at_nodes(nodes, flag.displacement());
        let velocity = at_nodes(nodes, flag.velocity());
        let DirectRun { setup, state, .. } = run;
        let fluid: PointField<2> = Arc::new(move |x| velocity_at(&setup, &state, x));
        Ok(Self { fluid, displacement, velocity })
    }
}

/// Returns the field that has the value of the nearest node everywhere.
fn at_nodes(nodes: &[P], values: &[V]) -> PointField<2> {
    let known: Vec<(P, V)> = nodes.iter().copied().zip(values.iter().copied()).collect();
    Arc::new(move |x| {
        let nearest = known.iter().min_by(|a, b| (a.0 - x).norm_squared().total_cmp(&(b.0 - x).norm_squared()));
        nearest.map_or_else(V::zeros, |(_, value)| *value)
    })
}

/// Computes the periodic swings, or the first cycles of one.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if record.full {
        FSI3.measure(record)?;
        FSI2.measure(record)?;
    } else {
        begin(record)?;
    }
    record.note(format!(
        "Channel, cylinder and flag of the check `fsi`, in {ROWS} rows of quadratic elements. Cells within the amplitude of the swing are as fine as those at the obstacle. \
         Generalised-α with rho_inf = {}.",
        short(RHO_INF),
    ));
    record.note(format!(
        "A cycle lasts from one upward passage of u_y = 0 to the next. Mean and amplitude are half of the sum and of the difference of largest and least \
         value in it; frequencies are those of u_y. A run ends when amplitude and frequency of u_y differ by at most {} among {N_CYCLES} cycles in a row, \
         of which the last one is shown.",
        short(UNCHANGED),
    ));
    record.note(
        "The first run begins with the inflow everywhere in place of its slow increase, and with a straight flag that has the greatest speed of a swing of half the amplitude of the \
         reference. The others begin with flow and flag of the one before. The force is that on cylinder and flag, at the stage of a step.",
    );
    Ok(())
}

/// Measures the first cycles of FSI2: the flag sheds vortices that enlarge its swing.
fn begin(record: &mut Record) -> Result<(), Failure> {
    let mut run = FSI2.run(QUICK, FSI2.start())?;
    let mut signals = FsiSignals::default();
    let cycles = run.until(QUICK_LATEST, |run| {
        signals.advance(run)?;
        Ok(<[_; 2]>::try_from(signals.cycles()).ok())
    })?;
    let [first, second] = cycles.ok_or("FSI2: the flag does not swing")?;
    let (cells, dt) = QUICK;
    let name = format!("FSI2, h = D/{cells}, dt = {} s", short(dt));
    let known = FSI2.known[FREQUENCY];
    record.near_relative(
        format!("{name}: {}, second cycle", NAMES[FREQUENCY]),
        second[FREQUENCY],
        known,
        QUICK_ACCURACY,
    );
    let growth = second[AMPLITUDE] / first[AMPLITUDE];
    record.at_least(format!("{name}: {}, second cycle over first", NAMES[AMPLITUDE]), growth, 1.0);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::P;
    use super::*;

    /// Returns the signals of a swing of the reference's FSI3 whose amplitude approaches its end with a rate.
    fn signals(rate: f64) -> FsiSignals {
        let known = FSI3.known;
        let of = |mean: f64, amplitude: f64, frequency: f64| -> Points {
            let times = (0..1000).map(|k| 2e-3 * f64::from(k));
            let value = |t: f64| mean + amplitude * (1.0 - (-rate * t).exp()) * (TAU * frequency * t).sin();
            times.map(|t| (t, value(t))).collect()
        };
        let f = known[FREQUENCY];
        FsiSignals {
            u: [of(known[3], known[4], 2.0 * f), of(known[0], known[1], f)],
            force: [of(known[5], known[6], 2.0 * f), of(known[7], known[8], f)],
        }
    }

    #[test]
    fn numbers_are_those_of_a_periodic_swing() {
        let found = signals(5.0).periodic().expect("a periodic swing");
        for (k, (found, known)) in found.iter().zip(FSI3.known).enumerate() {
            assert!((found / known - 1.0).abs() < 0.02, "{}: {found} {known}", NAMES[k]);
        }
        assert!(signals(0.5).periodic().is_none());
    }

    #[test]
    fn a_field_at_nodes_has_their_values() {
        let (solid, _) = obstacle(ROWS, Order::Quadratic).expect("elements");
        let linear = |x: &P| V::new(2.0 * x[0] - x[1], 0.3 + x[1]);
        let values: Vec<V> = solid.nodes().iter().map(linear).collect();
        let field = at_nodes(solid.nodes(), &values);
        for (x, value) in solid.nodes().iter().zip(&values).step_by(7) {
            assert_eq!(field(x), *value, "{x}");
        }
    }
}
