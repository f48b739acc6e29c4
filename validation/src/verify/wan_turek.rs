//! An oscillating cylinder in a closed channel: drag and lift, and their noise while the cylinder cuts the mesh.

use std::f64::consts::TAU;
use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{Size, graded_box, mirrored};
use cutwater::solver::{FluidBoundary, Setup};

use super::dry::second_order;
use super::flow::{differences, disk, fluid_mut, interface, polygon};
use super::linear_flow::still;
use super::signal::{range, rms, rough, slope};
use super::{DirectRun, Failure, P, Record, V, short};

// Length and height of the channel; where the centre of the cylinder begins; its diameter, m.
const CHANNEL: [f64; 2] = [2.2, 0.41];
const CENTRE: [f64; 2] = [1.1, 0.2];
const DIAMETER: f64 = 0.1;
// Amplitude, m, and frequency, Hz, of its motion; viscosity, Pa s, of a fluid of density one.
const AMPLITUDE: f64 = 0.25;
const FREQUENCY: f64 = 0.25;
const VISCOSITY: f64 = 1e-3;
/// Sizes of cells in the range of the cylinder, m; the last is left out of the quick version.
const SIZES: [f64; 4] = [0.02, 0.014, 0.01, 0.007];
/// Time step over size, s/m: 0.39 cells in a step at the largest speed, whatever the mesh.
const STEP_OVER_SIZE: f64 = 1.0;
/// Time from which signals are evaluated, s: the start, at full speed, is impulsive.
const BEGIN: f64 = 0.25;
/// End of the quick version, the first time at which the cylinder rests, and of the full one, s.
const ENDS: [f64; 2] = [1.0, 7.5];
// RMS of the drag coefficient until the end of the full version, from one source (the benchmark itself has curves
// only), and the largest relative error of the finest mesh: P1, and first order in time.
const KNOWN_RMS: f64 = 2.05;
const ACCURACY: f64 = 0.05;
/// Least order in h at which the noise has to fall, over all meshes: half of the expected one. Spurious forces of a
/// boundary that moves through cells go like h²/dt (Seo and Mittal 2011, doi:10.1016/j.jcp.2011.06.003), so first order
/// at fixed dt/h.
const NOISE_ORDER: f64 = 0.5;
/// Half-width, in steps, of the smoothing window; inversely proportional to the step, so that it always spans four
/// cells at full speed.
const WING: usize = 5;

// Steps in half a period, whose effect on the flow is compared on the coarsest mesh, and the least order there.
const ORDER_STEPS: [u32; 5] = [25, 50, 100, 200, 400];
const TIME_ORDER: f64 = 1.8;

/// Measures forces and their noise on several meshes, and in the full check the effect of the time step.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let (n_meshes, end) = if record.full { (4, ENDS[1]) } else { (3, ENDS[0]) };
    let mut signals = Vec::new();
    for &h in SIZES.iter().take(n_meshes) {
        let signal = run(h, 1, end)?;
        show(record, &format!("h = {h}"), &signal);
        signals.push((h, signal));
    }
    let [.., (_, coarse), (_, finest)] = &signals[..] else { return Err("two meshes at least".into()) };
    let differences = signals.windows(2).map(|w| w[0].1.difference(&w[1].1)).collect::<Vec<_>>();
    for (pair, difference) in signals.windows(2).zip(&differences) {
        record.show(format!("RMS of the drag's change from h = {} to {}", pair[0].0, pair[1].0), *difference, None);
    }
    let falls = differences.windows(2).all(|w| w[1] < w[0]);
    record.at_least("every refinement changes the drag less than the one before", f64::from(falls), 1.0);
    if record.full {
        record.near_relative("RMS of C_D, finest mesh", rms(&finest.coefficients[0]), KNOWN_RMS, ACCURACY);
        record.near_relative("RMS of C_D by traction, finest mesh", rms(&finest.coefficients[1]), KNOWN_RMS, ACCURACY);
        record.show("C_D(t) + C_D(t + T/2) from t = 3.5 s on, RMS relative to C_D", finest.asymmetry(3.5), None);
        record.show("the same on the mesh before", coarse.asymmetry(3.5), None);
        for part in [2, 4] {
            let h = SIZES[0];
            show(record, &format!("h = {h}, dt/{part}"), &run(h, part, end)?);
        }
    }
    order_in_time(record)?;
    let mut curves = Vec::new();
    for (k, kind) in KINDS.into_iter().enumerate() {
        let curve: Vec<(f64, f64)> = signals.iter().map(|(h, signal)| (*h, signal.noise()[k])).collect();
        record.at_least(format!("noise of the {kind}: order in h over all meshes"), slope(&curve), NOISE_ORDER);
        curves.push((kind, curve));
    }
    record.figure(
        "Drag coefficient of the oscillating cylinder",
        "t [s]",
        signals.iter().map(|(h, s)| (format!("h = {h}"), s.drag_over_time())).collect(),
    );
    record.log_figure("High-frequency noise over the amplitude of the drag", "h [m]", curves);
    record.note(format!(
        "Coefficients 2 F/(ρ U² D) with the largest speed U, from t = {} s on; force of the mortar (traction of the fluid and \
         penalty) unless said otherwise. Noise is the RMS of the difference to a smooth signal, of which each value is \
         that of the parabola fitted to {} neighbouring steps, over half the range of the drag. Time steps are {} s/m times \
         the size of cells: on every mesh the cylinder passes cells at the same rate, and a fit spans the same number of \
         cells; where steps are shorter on the same mesh, it spans the same time.",
        short(BEGIN),
        2 * WING + 1,
        short(STEP_OVER_SIZE),
    ));
    Ok(())
}

/// Measures the order in the time step of the flow around a cylinder that begins at rest and comes to rest after half a
/// period, with the time of the step in the penalty of the pressure, and with the longest step.
fn order_in_time(record: &mut Record) -> Result<(), Failure> {
    let longest = step_of(ORDER_STEPS[0]);
    order_with(record, None, "")?;
    order_with(record, Some(longest), ", fixed time in the penalty of the pressure")
}

/// Returns the time step of a number of steps in half a period.
fn step_of(n_steps: u32) -> f64 {
    0.5 / FREQUENCY / f64::from(n_steps)
}

fn order_with(record: &mut Record, time: Option<f64>, of_time: &str) -> Result<(), Failure> {
    let n_steps = if record.full { &ORDER_STEPS[..] } else { &ORDER_STEPS[..3] };
    let (mut changes, mut coarser) = (Vec::new(), None);
    for &n in n_steps {
        let dt = step_of(n);
        let mut setup = setup(SIZES[0], dt, |t| {
            let angle = TAU * FREQUENCY * t;
            [0.5 * AMPLITUDE * (1.0 - angle.cos()), 0.5 * speed() * angle.sin()]
        })?;
        // With a spectral radius of zero the stage is the end, and the last geometry is the same for all steps.
        setup.scheme = second_order(0.0)?;
        fluid_mut(&mut setup)?.stabilisation.time = time;
        let mut run = DirectRun::lagged(setup)?;
        for _ in 0..n {
            run.advance()?;
        }
        if let Some(coarser) = coarser {
            changes.push((2.0 * dt, differences(&run.setup, &run.state, &coarser)?.velocity));
        }
        coarser = Some(run.state);
    }
    let quantity = &format!("velocity in L2 after half a period{of_time}, change when dt is halved");
    // Steps of the short version are too long for an asymptotic order.
    if record.full {
        record.order(quantity, "dt [s]", &changes, TIME_ORDER);
    } else {
        record.show_order(quantity, "dt [s]", &changes);
    }
    Ok(())
}

/// Shows the numbers of one run.
fn show(record: &mut Record, name: &str, signal: &Signal) {
    let [drag, by_traction, lift] = &signal.coefficients;
    let [least, largest] = range(drag);
    let known = record.full.then_some(KNOWN_RMS);
    record.show(format!("{name}: RMS of C_D"), rms(drag), known);
    record.show(format!("{name}: RMS of C_D by traction"), rms(by_traction), known);
    record.show(format!("{name}: least C_D"), least, None);
    record.show(format!("{name}: largest C_D"), largest, None);
    record.show(format!("{name}: largest |C_L|"), lift.iter().map(|c| c.abs()).fold(0.0, f64::max), None);
    for (kind, noise) in KINDS.into_iter().zip(signal.noise()) {
        record.show(format!("{name}: noise of the {kind}"), noise, None);
    }
}

/// Coefficients of the force.
const KINDS: [&str; 3] = ["drag", "drag by traction", "lift"];

/// Coefficients after every step that is evaluated.
#[derive(Default)]
struct Signal {
    dt: f64,
    /// Time of the first value.
    begin: f64,
    /// Steps to either side that smooth values are fitted to.
    wing: usize,
    /// In the order of [`KINDS`].
    coefficients: [Vec<f64>; 3],
}

impl Signal {
    fn drag_over_time(&self) -> Vec<(f64, f64)> {
        self.coefficients[0].iter().enumerate().map(|(k, drag)| (self.begin + k as f64 * self.dt, *drag)).collect()
    }

    /// Returns the RMS of the noise in each coefficient, relative to half the range of the drag.
    fn noise(&self) -> [f64; 3] {
        let [least, largest] = range(&self.coefficients[0]);
        self.coefficients.each_ref().map(|values| rms(&rough(values, self.wing)) / (0.5 * (largest - least)))
    }

    /// Returns the RMS of the difference of the drags, at the times of this signal within the range of the other one.
    fn difference(&self, other: &Self) -> f64 {
        let at = |t: f64| {
            let place = (t - other.begin) / other.dt;
            let k = place.floor();
            let drag = &other.coefficients[0];
            let pair = (k >= 0.0).then(|| drag.get(k as usize).zip(drag.get(k as usize + 1)))??;
            Some(pair.0 + (place - k) * (pair.1 - pair.0))
        };
        let differences = self.drag_over_time().into_iter().filter_map(|(t, drag)| Some(drag - at(t)?));
        rms(&differences.collect::<Vec<_>>())
    }

    /// Returns the RMS of `C_D(t) + C_D(t + T/2)` from a time on, over that of the drag.
    fn asymmetry(&self, from: f64) -> f64 {
        let half = (0.5 / FREQUENCY / self.dt).round() as usize;
        let first = ((from - self.begin) / self.dt).ceil() as usize;
        let drag = self.coefficients[0].get(first..).unwrap_or_default();
        let sums: Vec<f64> = drag.iter().zip(drag.iter().skip(half)).map(|(a, b)| a + b).collect();
        rms(&sums) / rms(drag)
    }
}

/// Returns the largest speed of the cylinder.
fn speed() -> f64 {
    TAU * FREQUENCY * AMPLITUDE
}

/// Returns the setup of the channel with cells of size `h` where the cylinder moves, for its displacement and velocity
/// at a time.
fn setup(h: f64, dt: f64, motion: fn(f64) -> [f64; 2]) -> Result<Setup<2>, Failure> {
    let mut setup = still(background(h)?, VISCOSITY, dt, 1e-8, || FluidBoundary::NoSlip)?;
    // Edges shorter than those of the mesh.
    let n = (2.0 * TAU * DIAMETER / h).max(64.0).round() as usize;
    setup.bodies.push(polygon(
        &[disk(P::new(CENTRE[0], CENTRE[1]), 0.5 * DIAMETER, n)],
        move |x, t| x + V::new(motion(t)[0], 0.0),
        Arc::new(move |_, t| V::new(motion(t)[1], 0.0)),
    ));
    Ok(setup)
}

/// Returns the mesh of the channel, symmetric, with cells that grow outside the range of the cylinder.
fn background(h: f64) -> Result<SimplexMesh<2>, Failure> {
    let fine_until = CENTRE[0] + AMPLITUDE + 2.0 * DIAMETER;
    let size = Size::Graded { fine: h, fine_until, coarse: 3.0 * h, coarse_from: fine_until + 20.0 * h, axis: 0 };
    Ok(mirrored(&graded_box::<2>([CENTRE[0], 0.0], CHANNEL, &size)?, 0, CENTRE[0])?)
}

/// Computes the forces on a mesh of size `h`. The time step is divided by `part`.
fn run(h: f64, part: usize, end: f64) -> Result<Signal, Failure> {
    // Half a period is a whole number of steps.
    let half_period = 0.5 / FREQUENCY;
    let dt = half_period / (part as f64 * (half_period / (STEP_OVER_SIZE * h)).round());
    let mut run = DirectRun::lagged(setup(h, dt, |t| {
        let angle = TAU * FREQUENCY * t;
        [AMPLITUDE * angle.sin(), speed() * angle.cos()]
    })?)?;
    let scale = 2.0 / (speed() * speed() * DIAMETER);
    let mut signal = Signal { dt: run.setup.dt, wing: WING * part, ..Signal::default() };
    // Half a step of room for round-off.
    while run.state.time < end - 0.5 * run.setup.dt {
        let report = run.advance()?;
        if run.state.time < BEGIN {
            continue;
        }
        let (mut total, mut traction) = (V::zeros(), V::zeros());
        for (piece, on_piece) in interface(&run.state, &report)? {
            total += on_piece.total() * (scale * piece.measure);
            traction += on_piece.fluid * (scale * piece.measure);
        }
        if signal.coefficients[0].is_empty() {
            signal.begin = run.state.time;
        }
        let now = [total[0], traction[0], total[1]];
        signal.coefficients.iter_mut().zip(now).for_each(|(values, value)| values.push(value));
    }
    Ok(signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_that_turns_around_every_half_period_is_antisymmetric() {
        let dt = 0.02;
        let drag = (0..375).map(|k| (TAU * FREQUENCY * (BEGIN + f64::from(k) * dt)).sin()).collect();
        let of_drag = |dt: f64, begin: f64, drag| Signal { dt, begin, wing: 5, coefficients: [drag, vec![], vec![]] };
        let signal = of_drag(dt, BEGIN, drag);
        assert!(signal.asymmetry(3.5) < 1e-12);
        // A finer signal of the same, up to linear interpolation.
        let drag = (0..750).map(|k| (TAU * FREQUENCY * (BEGIN + 0.003 + 0.5 * f64::from(k) * dt)).sin()).collect();
        let other = of_drag(0.5 * dt, BEGIN + 0.003, drag);
        assert!(signal.difference(&other) < 1e-4);
    }
}
