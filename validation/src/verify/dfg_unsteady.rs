//! The unsteady DFG benchmarks: drag, lift and pressure of a cylinder that sheds vortices, at Reynolds numbers up to
//! 100.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::solver::body::PointField;

use super::channel::{Channel, ChannelResolution, RADIUS, pressure_difference, step_with_force, velocity_at};
use super::dry::second_order;
use super::flow::fluid_mut;
use super::record::Points;
use super::signal::{is_steady, last_cycles, mean, passage, peak, rises};
use super::{DirectRun, Failure, Record, short};

/// Benchmarks 2D-2 and 2D-3 of Schäfer and Turek 1996. The largest mean speed of 2D-3 is the speed of 2D-2.
const CHANNEL: Channel = Channel { length: 2.2, density: 1.0, viscosity: 1e-3, speed: 1.0, has_flag: false };
/// Spectral radius of generalised-α for infinitely fast changes: the usual compromise for flows between damping and
/// accuracy (Jansen, Whiting and Hulbert 2000). The interface does not move, so that fast changes need no more damping.
const RHO_INF: f64 = 0.5;
/// Tolerance of Newton's method. Forces are compared to three digits.
const TOLERANCE: f64 = 1e-8;

/// Largest drag and lift coefficient and Strouhal number of 2D-2, level 6 of FEATFLOW.
const SHEDDING: [f64; 3] = [3.2274, 0.9866, 0.301_84];
const OF_SHEDDING: [&str; 3] = ["largest C_D", "largest C_L", "Strouhal number"];
// Cycles that are averaged. The flow is periodic when their numbers differ by less than a fraction.
const N_CYCLES: usize = 3;
const UNCHANGED: f64 = 1e-3;
/// Time until which the flow has to be periodic, s.
const LATEST: f64 = 30.0;

/// Largest coefficients of 2D-3 and pressure difference at the end, Pa (John 2004, doi:10.1002/fld.679).
const PULSE: [f64; 3] = [2.950_921_575, 0.477_95, -0.1116];
const OF_PULSE: [&str; 3] = ["largest C_D", "largest C_L", "pressure difference at the end"];
/// Times of the largest coefficients, s.
const TIMES: [f64; 2] = [3.936_25, 5.693_125];
/// Middle and half of the interval of the pressure difference of 1996.
const INTERVAL: [f64; 2] = [-0.11, 0.005];
// End of 2D-3, s, and of its quick version, which has passed the largest drag.
const END: f64 = 8.0;
const QUICK_END: f64 = 4.2;

/// Cells in a diameter and time steps, s, of the full version. Each flow of 2D-2 begins with the one before.
const FULL: [(usize, f64); 3] = [(32, 1e-2), (32, 5e-3), (64, 5e-3)];
/// The same of the quick version, for 2D-2 and 2D-3. There is one cell and a half in a boundary layer, `D/√Re`.
const QUICK: [(usize, f64); 2] = [(16, 2e-2), (16, 4e-2)];
// Largest relative errors of the finest resolution.
const ACCURACY: [f64; 3] = [0.01, 0.03, 0.01];
const ACCURACY_OF_PULSE: [f64; 2] = [0.01, 0.1];
/// Largest relative errors of the quick version. Forces are proportional to the square of the inflow: an inflow that is
/// wrong by 10 % changes the drag by 20 %.
const QUICK_ACCURACY: [f64; 3] = [0.1, 0.3, 0.1];

/// Coefficients and pressure difference over time.
#[derive(Default)]
struct DfgSignals {
    drag: Points,
    lift: Points,
    pressure: Points,
}

impl DfgSignals {
    /// Takes a step and adds its values. Forces and pressures are those at the stage of the step.
    fn advance(&mut self, run: &mut DirectRun) -> Result<(), Failure> {
        let (time, force) = step_with_force(run)?;
        self.drag.push((time, CHANNEL.coefficient(force[0])));
        self.lift.push((time, CHANNEL.coefficient(force[1])));
        self.pressure.push((time, pressure_difference(&run.setup, &run.state)?));
        Ok(())
    }

    /// Returns the largest coefficients and the Strouhal number of each cycle: from one upward passage of zero lift to
    /// the next.
    fn cycles(&self) -> Vec<[f64; 3]> {
        let diameter_over_speed = 2.0 * RADIUS / CHANNEL.speed;
        let cycle = |w: &[(usize, f64)]| {
            let samples = w[0].0 - 1..w[1].0 + 1;
            let [drag, lift] = [&self.drag, &self.lift].map(|curve| peak(&curve[samples.clone()]).1);
            [drag, lift, diameter_over_speed / (w[1].1 - w[0].1)]
        };
        rises(&self.lift, 0.0).windows(2).map(cycle).collect()
    }

    /// Returns the means of the last cycles if the flow is periodic.
    fn periodic(&self) -> Option<[f64; 3]> {
        let cycles = self.cycles();
        let last = cycles.len().checked_sub(N_CYCLES).map(|first| &cycles[first..])?;
        let of = |k: usize| last.iter().map(|cycle| cycle[k]).collect::<Vec<_>>();
        let all = [of(0), of(1), of(2)];
        let is_periodic = all.iter().all(|values| is_steady(values.iter().copied(), UNCHANGED));
        is_periodic.then(|| all.map(|values| mean(&values)))
    }

    /// Returns drag and lift of the last cycles, from the first passage of zero lift.
    fn last_cycles(&self) -> [Points; 2] {
        let passages = rises(&self.lift, 0.0);
        [&self.drag, &self.lift].map(|curve| last_cycles(curve, &passages, N_CYCLES))
    }
}

/// Measures both flows at several resolutions.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    shedding(record, if record.full { &FULL } else { &QUICK[..1] })?;
    pulse(record, if record.full { &FULL } else { &QUICK[1..] })?;
    record.note(format!(
        "Channel and settings of the check `dfg`; generalised-α with rho_inf = {}. Forces and pressures are those at the stage of a step, and have its \
         time. A largest value is that of the parabola through three steps.",
        short(RHO_INF),
    ));
    record.note(format!(
        "2D-2: a cycle lasts from one upward passage of zero lift to the next. The run ends when each of the three numbers differs by at most {} \
         among {N_CYCLES} cycles in a row, whose means are shown. The first flow begins with the parabola of the inflow everywhere, with half the mean \
         speed across it in the wake; the others begin with the last velocity of the one before.",
        short(UNCHANGED),
    ));
    record.note("2D-3: the inflow is that of 2D-2 times sin(π t/8 s), from rest. The pressure difference at 8 s is interpolated between stages.");
    Ok(())
}

/// Returns the name of a resolution.
fn name((cells, dt): (usize, f64)) -> String {
    format!("h = D/{cells}, dt = {} s", short(dt))
}

/// Returns the run of the flow with a factor on its inflow.
fn run((cells, dt): (usize, f64), factor: fn(f64) -> f64, start: Option<PointField<2>>) -> Result<DirectRun, Failure> {
    let mut setup = CHANNEL.setup(&ChannelResolution::new(cells), factor)?;
    (setup.scheme, setup.dt, setup.newton) = (second_order(RHO_INF)?, dt, NewtonSettings::new(TOLERANCE));
    fluid_mut(&mut setup)?.initial_velocity = start;
    DirectRun::lagged(setup)
}

/// Measures the periodic flow, 2D-2.
fn shedding(record: &mut Record, resolutions: &[(usize, f64)]) -> Result<(), Failure> {
    let mut start: PointField<2> = Arc::new(|x| CHANNEL.disturbed(x));
    let mut curves = [Vec::new(), Vec::new()];
    for (n, &resolution) in resolutions.iter().enumerate() {
        let name = name(resolution);
        let mut run = run(resolution, |_| 1.0, Some(start))?;
        let mut signals = DfgSignals::default();
        let found = run.until(LATEST, |run| {
            signals.advance(run)?;
            Ok(signals.periodic())
        })?;
        let found = found.ok_or("the flow is not periodic")?;
        record.show(format!("2D-2, {name}: periodic after [s]"), run.state.time, None);
        for k in 0..3 {
            let quantity = format!("2D-2, {name}: {}", OF_SHEDDING[k]);
            if n + 1 < resolutions.len() {
                record.show(quantity, found[k], Some(SHEDDING[k]));
            } else {
                let accuracy = if record.full { ACCURACY } else { QUICK_ACCURACY };
                record.near_relative(quantity, found[k], SHEDDING[k], accuracy[k]);
            }
        }
        for (curves, curve) in curves.iter_mut().zip(signals.last_cycles()) {
            curves.push((name.clone(), curve));
        }
        let DirectRun { setup, state, .. } = run;
        start = Arc::new(move |x| velocity_at(&setup, &state, x));
    }
    let [drag, lift] = curves;
    record.figure("2D-2: drag coefficient", "t [s]", drag);
    record.figure("2D-2: lift coefficient", "t [s]", lift);
    Ok(())
}

/// Measures the flow whose inflow rises and falls once, 2D-3.
fn pulse(record: &mut Record, resolutions: &[(usize, f64)]) -> Result<(), Failure> {
    let end = if record.full { END } else { QUICK_END };
    let [mut drags, mut lifts] = [Vec::new(), Vec::new()];
    for (n, &resolution) in resolutions.iter().enumerate() {
        let is_judged = n + 1 == resolutions.len();
        let name = name(resolution);
        let mut run = run(resolution, |t| (PI * t / END).sin(), None)?;
        let mut signals = DfgSignals::default();
        while signals.drag.last().is_none_or(|(time, _)| *time < end) {
            signals.advance(&mut run)?;
        }
        let DfgSignals { drag, lift, pressure } = signals;
        for (k, curve) in [&drag, &lift].into_iter().enumerate().take(if record.full { 2 } else { 1 }) {
            let (time, largest) = peak(curve);
            let quantity = format!("2D-3, {name}: {}", OF_PULSE[k]);
            if is_judged {
                let accuracy = if record.full { ACCURACY_OF_PULSE[k] } else { QUICK_ACCURACY[k] };
                record.near_relative(quantity.clone(), largest, PULSE[k], accuracy);
            } else {
                record.show(quantity.clone(), largest, Some(PULSE[k]));
            }
            record.show(format!("{quantity}, time [s]"), time, Some(TIMES[k]));
        }
        if record.full {
            let [.., before, after] = pressure[..] else { return Err("two steps are needed".into()) };
            let at_end = passage([before, after].map(|(time, value)| (value, time)), END);
            let quantity = format!("2D-3, {name}: {}", OF_PULSE[2]);
            record.show(quantity.clone(), at_end, Some(PULSE[2]));
            if is_judged {
                record.near(format!("{quantity}, interval of 1996"), at_end, INTERVAL[0], INTERVAL[1]);
            }
        }
        drags.push((name.clone(), drag));
        lifts.push((name, lift));
    }
    record.figure("2D-3: drag coefficient", "t [s]", drags);
    record.figure("2D-3: lift coefficient", "t [s]", lifts);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the signals of a lift whose amplitude approaches one with a rate.
    fn signals(rate: f64) -> DfgSignals {
        let time = |k: i32| 0.01 * f64::from(k);
        let of = |value: &dyn Fn(f64) -> f64| (0..800).map(time).map(|t| (t, value(t))).collect();
        let amplitude = |t: f64| 1.0 - (-rate * t).exp();
        DfgSignals {
            drag: of(&|t| 3.0 + 0.1 * (12.0 * PI * t).cos()),
            lift: of(&|t| amplitude(t) * (6.0 * PI * t).sin()),
            pressure: Vec::new(),
        }
    }

    #[test]
    fn numbers_are_those_of_a_periodic_signal() {
        let [drag, lift, strouhal] = signals(2.0).periodic().expect("a periodic signal");
        assert!((drag - 3.1).abs() < 1e-3 && (lift - 1.0).abs() < 1e-3 && (strouhal - 0.3).abs() < 1e-4);
        assert!(signals(0.2).periodic().is_none());
    }
}
