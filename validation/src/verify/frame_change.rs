//! A cylinder at rest in a stream, and one that moves as fast through fluid at rest: the same flow, seen from two
//! frames.

use std::sync::Arc;

use cutwater::mesh::generate::structured_box;
use cutwater::solver::body::TimeField;
use cutwater::solver::{FluidBoundary, Setup};

use super::flow::{disk, fluid_mut, interface, polygon, set_side};
use super::linear_flow::still;
use super::signal::{falls, mean, rms, rough, slope};
use super::{DirectRun, Failure, P, Record, V, short};

/// Length and half of the height of the channel, in diameters of the cylinder; its walls move with the fluid.
const CHANNEL: [f64; 2] = [12.0, 2.0];
/// Distance that the cylinder moves, around the middle: on average the channel is as long ahead as behind.
const TRAVEL: f64 = 3.0;
/// Part of this distance that is left out, since the start is impulsive.
const BEGIN: f64 = 1.0;
/// Density, diameter and speed are one.
const REYNOLDS: f64 = 20.0;
// Cells in a diameter, in short and in full.
const QUICK: [usize; 3] = [6, 8, 12];
const FULL: [usize; 4] = [8, 12, 16, 24];
// Cells that the cylinder passes in a step, the same on all meshes; others in full on the second of them.
const COURANT: f64 = 0.39;
const OTHER_COURANTS: [f64; 2] = [0.78, 0.195];
/// Largest difference of the drags on the finest mesh. It is smaller than the difference to another flow.
const LARGEST_DIFFERENCE: f64 = 0.02;
/// Least order in h at which the noise has to fall, over all meshes, as in the check of the oscillating cylinder.
const NOISE_ORDER: f64 = 0.5;
/// Cells that the fit of a smooth signal spans to either side.
const WING: f64 = 1.95;

/// Measures the difference of the drags, and the noise in the drag of the moving cylinder.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let meshes = if record.full { &FULL[..] } else { &QUICK[..] };
    let (mut differences, mut noises, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for &cells in meshes {
        let pair = Pair::run(cells, COURANT)?;
        pair.show(record, &format!("h = D/{cells}"));
        let h = 1.0 / cells as f64;
        differences.push((h, pair.difference()));
        noises.push((h, pair.noise()));
        curves.push((format!("moving, D/{cells}"), pair.over_time(&pair.moving)));
        curves.push((format!("fixed, D/{cells}"), pair.over_time(&pair.fixed)));
    }
    record.at_least("every refinement makes the difference smaller", falls(&differences), 1.0);
    record.show("difference: order in h over all meshes", slope(&differences), None);
    let finest = differences.last().map_or(f64::NAN, |last| last.1);
    record.at_most("difference on the finest mesh, over the drag", finest, LARGEST_DIFFERENCE);
    record.at_least("every refinement makes the noise smaller", falls(&noises), 1.0);
    record.at_least("noise: order in h over all meshes", slope(&noises), NOISE_ORDER);
    if record.full {
        for courant in OTHER_COURANTS {
            let cells = FULL[1];
            Pair::run(cells, courant)?.show(record, &format!("h = D/{cells}, {} cells a step", short(courant)));
        }
    }
    record.log_figure(
        "Difference of the drags, and noise of the moving one, over the drag",
        "h/D",
        vec![("difference".to_owned(), differences), ("noise".to_owned(), noises)],
    );
    record.figure("Drag of the cylinder at rest and of the moving one", "t U/D", curves);
    if record.full {
        record.note(
            "The difference is mostly one in time: at fixed size of the cells it falls with the step, from 1.6 % at 0.78 \
             cells a step to 0.9 % and 0.5 % at 0.39 and 0.195 (D/12). To the cylinder at rest the flow is almost \
             steady, to fixed points it is not while the other one passes. The noise falls with h; smaller steps make it \
             larger (0.17, 0.33 and 0.37 % there).",
        );
    }
    record.note(format!(
        "Re = {}, started at full speed; channel of {} by {} diameters whose walls move with the fluid, half of it. \
         Coefficients 2 F/(ρ U² D), means while the cylinder moves from {} to {} diameters, around the middle; the \
         one at rest stands there. {} cells in a step unless said otherwise. Noise is the RMS of the difference to \
         parabolas fitted to as many steps as pass {} cells, as in the check of the oscillating cylinder.",
        short(REYNOLDS),
        short(CHANNEL[0]),
        short(2.0 * CHANNEL[1]),
        short(BEGIN),
        short(TRAVEL),
        short(COURANT),
        short(2.0 * WING),
    ));
    Ok(())
}

/// Drag coefficients of the same flow in two frames, after every step that is evaluated.
struct Pair {
    dt: f64,
    courant: f64,
    fixed: Vec<f64>,
    moving: Vec<f64>,
}

impl Pair {
    fn run(cells: usize, courant: f64) -> Result<Self, Failure> {
        let n_steps = (TRAVEL * cells as f64 / courant).round() as usize;
        let dt = TRAVEL / n_steps as f64;
        let fixed = drag(setup(cells, dt, false)?)?;
        let moving = drag(setup(cells, dt, true)?)?;
        Ok(Self { dt, courant, fixed, moving })
    }

    fn over_time(&self, drag: &[f64]) -> Vec<(f64, f64)> {
        let n = drag.len();
        drag.iter().enumerate().map(|(k, c)| (TRAVEL - (n - 1 - k) as f64 * self.dt, *c)).collect()
    }

    /// Returns the difference of the mean drags, relative to that of the cylinder at rest.
    fn difference(&self) -> f64 {
        (mean(&self.moving) / mean(&self.fixed) - 1.0).abs()
    }

    /// Returns the RMS of the noise in the drag of the moving cylinder, relative to its mean drag.
    fn noise(&self) -> f64 {
        let wing = (WING / self.courant).round().max(2.0) as usize;
        rms(&rough(&self.moving, wing)) / mean(&self.moving)
    }

    fn show(&self, record: &mut Record, name: &str) {
        record.show(format!("{name}: mean C_D, at rest"), mean(&self.fixed), None);
        record.show(format!("{name}: mean C_D, moving"), mean(&self.moving), None);
        record.show(format!("{name}: difference over C_D at rest"), self.difference(), None);
        record.show(format!("{name}: noise of the moving one over its C_D"), self.noise(), None);
    }
}

/// Returns the setup of half of the channel, with the cylinder at rest in its middle or before it passes the middle.
fn setup(cells: usize, dt: f64, moves: bool) -> Result<Setup<2>, Failure> {
    let n = CHANNEL.map(|length| (length * cells as f64).round() as usize);
    let [start, speed, stream] = if moves { [0.5 * TRAVEL, -1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let stream: TimeField<2> = Arc::new(move |_, _| V::new(stream, 0.0));
    let on_side = || FluidBoundary::Velocity(Arc::clone(&stream));
    let mut setup = still(structured_box::<2>([0.0; 2], CHANNEL, n)?, 1.0 / REYNOLDS, dt, 1e-8, on_side)?;
    set_side(&mut setup, "bottom", FluidBoundary::symmetry(1))?;
    fluid_mut(&mut setup)?.initial_velocity = Some(Arc::new(move |x| stream(x, 0.0)));
    let centre = P::new(0.5 * CHANNEL[0] + start, 0.0);
    setup.bodies.push(polygon(
        // Edges of a quarter of a cell.
        &[disk(centre, 0.5, (4.0 * std::f64::consts::PI * cells as f64).ceil() as usize)],
        move |x, t| x + V::new(speed * t, 0.0),
        Arc::new(move |_, _| V::new(speed, 0.0)),
    ));
    Ok(setup)
}

/// Computes the drag coefficient after every step that is evaluated.
fn drag(setup: Setup<2>) -> Result<Vec<f64>, Failure> {
    let mut run = DirectRun::lagged(setup)?;
    let mut drag = Vec::new();
    // Half a step of room for round-off.
    while run.state.time < TRAVEL - 0.5 * run.setup.dt {
        let report = run.advance()?;
        if run.state.time > BEGIN {
            // Twice for the other half, twice for the coefficient.
            let on_pieces = interface(&run.state, &report)?;
            drag.push(on_pieces.map(|(piece, on_piece)| 4.0 * on_piece.total()[0] * piece.measure).sum());
        }
    }
    Ok(drag)
}
