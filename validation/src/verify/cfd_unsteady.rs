//! The Turek-Hron benchmark CFD3: vortices behind a cylinder with a rigid flag, at a Reynolds number of 200.

use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::solver::body::PointField;

use super::channel::{Channel, ChannelResolution, RADIUS, step_with_force, velocity_at};
use super::dry::second_order;
use super::flow::fluid_mut;
use super::record::Points;
use super::signal::{is_steady, last_cycles, mean_and_amplitude, rises};
use super::{DirectRun, Failure, Record, short};

/// The channel of CFD1 and CFD2, with a mean speed of 2 m/s.
const CHANNEL: Channel = Channel { length: 2.5, density: 1e3, viscosity: 1.0, speed: 2.0, has_flag: true };
/// FEATFLOW, level 6 (Turek and Hron 2006, doi:10.1007/3-540-34596-5_15).
const KNOWN: [f64; 5] = [439.45, 5.6183, -11.893, 437.81, 4.3956];
const NAMES: [&str; 5] = [
    "mean of the drag [N/m]",
    "amplitude of the drag [N/m]",
    "mean of the lift [N/m]",
    "amplitude of the lift [N/m]",
    "frequency of the lift [Hz]",
];
// Indices of the quantities that are compared, and their largest relative errors, as for drag, lift and frequency in
// the check `dfg-unsteady`. The other two are small differences of large numbers.
const JUDGED: [usize; 3] = [0, 3, 4];
const ACCURACY: [f64; 3] = [0.01, 0.03, 0.01];
/// Cells in a diameter of the cylinder, and time step, s. Each run begins with the end of the one before.
const FULL: [(usize, f64); 3] = [(16, 4e-3), (32, 4e-3), (32, 2e-3)];
/// The same of the quick version, which computes the first two cycles.
const QUICK: (usize, f64) = (16, 8e-3);
/// Largest relative error of its frequency: there is one cell in a boundary layer, `D/√Re`, and the vortices are not
/// yet strong.
const QUICK_ACCURACY: f64 = 0.1;
/// Spectral radius of generalised-α for infinitely fast changes, that of the check `dfg-unsteady`.
const RHO_INF: f64 = 0.5;
/// Tolerance of Newton's method, that of `dfg-unsteady`.
const TOLERANCE: f64 = 1e-8;
// Cycles in a row in which the judged numbers differ by at most a fraction when the flow is periodic.
const N_CYCLES: usize = 3;
const UNCHANGED: f64 = 1e-3;
/// Time until which each run has to be periodic, s.
const LATEST: f64 = 15.0;

/// Force on cylinder and flag over time.
#[derive(Default)]
struct CfdSignals {
    drag: Points,
    lift: Points,
}

impl CfdSignals {
    /// Takes a step and adds the force at its stage.
    fn advance(&mut self, run: &mut DirectRun) -> Result<(), Failure> {
        let (time, force) = step_with_force(run)?;
        self.drag.push((time, force[0]));
        self.lift.push((time, force[1]));
        Ok(())
    }

    /// Returns the numbers of each cycle, in the order of [`NAMES`]: from one upward passage of the mean lift of the
    /// reference to the next.
    fn cycles(&self) -> Vec<[f64; 5]> {
        let cycle = |w: &[(usize, f64)]| {
            let [drag, lift] = [&self.drag, &self.lift].map(|curve| mean_and_amplitude(&curve[w[0].0 - 1..w[1].0 + 1]));
            [drag[0], drag[1], lift[0], lift[1], (w[1].1 - w[0].1).recip()]
        };
        rises(&self.lift, KNOWN[2]).windows(2).map(cycle).collect()
    }

    /// Returns the last cycle if the flow is periodic.
    fn periodic(&self) -> Option<[f64; 5]> {
        let cycles = self.cycles();
        let last = cycles.len().checked_sub(N_CYCLES).map(|first| &cycles[first..])?;
        let is_periodic = JUDGED.iter().all(|&k| is_steady(last.iter().map(|cycle| cycle[k]), UNCHANGED));
        is_periodic.then(|| last[N_CYCLES - 1])
    }

    /// Returns a curve in the last cycles, from the first passage.
    fn last_cycles(&self, curve: &Points) -> Points {
        last_cycles(curve, &rises(&self.lift, KNOWN[2]), N_CYCLES)
    }
}

/// Computes the periodic flow at several resolutions, or the first cycles of one.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if record.full {
        periodic(record)?
    } else {
        begin(record)?
    }
    record.note(format!(
        "Channel, cylinder and flag of the check `cfd`. Cells within a radius of the cylinder from the flag, where vortices pass, are as fine as those at the cylinder. \
         Generalised-α with rho_inf = {}. The force is that on cylinder and flag, at the stage of a step. A cycle lasts from one upward passage of the lift through its mean \
         in the reference to the next. Mean and amplitude are half of the sum and of the difference of largest and least value in it. The first flow begins with the parabola \
         of the inflow everywhere, with half the mean speed across it behind the flag.",
        short(RHO_INF),
    ));
    Ok(())
}

/// Returns the run of a resolution.
fn run((cells, dt): (usize, f64), start: PointField<2>) -> Result<DirectRun, Failure> {
    let mut setup = CHANNEL.setup(&ChannelResolution { swing: RADIUS, ..ChannelResolution::new(cells) }, |_| 1.0)?;
    (setup.scheme, setup.dt, setup.newton) = (second_order(RHO_INF)?, dt, NewtonSettings::new(TOLERANCE));
    fluid_mut(&mut setup)?.initial_velocity = Some(start);
    DirectRun::lagged(setup)
}

/// Returns the name of a resolution.
fn name((cells, dt): (usize, f64)) -> String {
    format!("CFD3, h = D/{cells}, dt = {} s", short(dt))
}

fn periodic(record: &mut Record) -> Result<(), Failure> {
    let mut start: PointField<2> = Arc::new(|x| CHANNEL.disturbed(x));
    let [mut drags, mut lifts] = [Vec::new(), Vec::new()];
    for (n, resolution) in FULL.into_iter().enumerate() {
        let (name, mut run) = (name(resolution), run(resolution, start)?);
        let mut signals = CfdSignals::default();
        let found = run.until(LATEST, |run| {
            signals.advance(run)?;
            Ok(signals.periodic())
        })?;
        let found = found.ok_or_else(|| format!("{name}: the flow is not periodic"))?;
        record.show(format!("{name}: periodic after [s]"), run.state.time, None);
        for (k, quantity) in NAMES.into_iter().enumerate() {
            let quantity = format!("{name}: {quantity}");
            match JUDGED.into_iter().position(|judged| judged == k) {
                Some(judged) if n + 1 == FULL.len() => {
                    record.near_relative(quantity, found[k], KNOWN[k], ACCURACY[judged]);
                }
                _ => record.show(quantity, found[k], Some(KNOWN[k])),
            }
        }
        drags.push((name.clone(), signals.last_cycles(&signals.drag)));
        lifts.push((name, signals.last_cycles(&signals.lift)));
        let DirectRun { setup, state, .. } = run;
        start = Arc::new(move |x| velocity_at(&setup, &state, x));
    }
    record.note(format!(
        "A run ends when mean drag, amplitude of the lift and frequency differ by at most {} among {N_CYCLES} cycles in a row, of which the last one is shown. The next \
         one begins with its last velocity.",
        short(UNCHANGED),
    ));
    record.figure("CFD3: drag [N/m]", "t [s]", drags);
    record.figure("CFD3: lift [N/m]", "t [s]", lifts);
    Ok(())
}

/// Measures the first cycles after the disturbance of the start has left the channel: vortices become stronger.
fn begin(record: &mut Record) -> Result<(), Failure> {
    let (name, mut run) = (name(QUICK), run(QUICK, Arc::new(|x| CHANNEL.disturbed(x)))?);
    while run.state.time < CHANNEL.length / CHANNEL.speed {
        run.advance()?;
    }
    let mut signals = CfdSignals::default();
    let cycles = run.until(LATEST, |run| {
        signals.advance(run)?;
        Ok(<[_; 2]>::try_from(signals.cycles()).ok())
    })?;
    let [first, second] = cycles.ok_or_else(|| format!("{name}: no vortices"))?;
    record.near_relative(format!("{name}: {}, second cycle", NAMES[4]), second[4], KNOWN[4], QUICK_ACCURACY);
    record.at_least(format!("{name}: {}, second cycle over first", NAMES[3]), second[3] / first[3], 1.0);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Returns signals of the reference whose amplitudes approach their end with a rate.
    fn signals(rate: f64) -> CfdSignals {
        let of = |mean: f64, amplitude: f64, frequency: f64| -> Points {
            let times = (0..1500).map(|k| 2e-3 * f64::from(k));
            let value = |t: f64| mean + amplitude * (1.0 - (-rate * t).exp()) * (TAU * frequency * t).sin();
            times.map(|t| (t, value(t))).collect()
        };
        CfdSignals { drag: of(KNOWN[0], KNOWN[1], 2.0 * KNOWN[4]), lift: of(KNOWN[2], KNOWN[3], KNOWN[4]) }
    }

    #[test]
    fn numbers_are_those_of_a_periodic_signal() {
        let found = signals(5.0).periodic().expect("a periodic signal");
        for (k, (found, known)) in found.iter().zip(KNOWN).enumerate() {
            assert!((found / known - 1.0).abs() < 0.02, "{}: {found} {known}", NAMES[k]);
        }
        assert!(signals(0.3).periodic().is_none());
    }
}
