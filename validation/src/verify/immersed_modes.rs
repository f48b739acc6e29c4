//! An elastic disk that vibrates in a fluid at rest: the added mass of the fluid lowers its frequencies.

use std::f64::consts::SQRT_2;
use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{Setup, Stabilisation};

use super::dry::{RADIUS, second_order};
use super::flow::{PAPERS_PENALTY, fluid_mut, open};
use super::linear_flow::still;
use super::mode::{Mode, frequency_of};
use super::{DirectRun, Failure, P, Record, V, short};
use crate::units::cgs;

/// Viscosity of the falling balls' fluid, P; its density is that of the disk, one.
const VISCOSITY: f64 = 1e-2;
/// `n` and `ω R/c_s` of the first mode with `n` waves around the disk: roots of the frequency determinant of a disk in
/// plane strain, `ν = 0.4`, on which an unbounded ideal fluid of its density acts with the pressure `-ρ (R/n) ω² u_r`.
const MODES: [(u32, f64); 2] = [(2, 1.67555), (3, 2.65868)];
/// Largest relative error of the frequency of the finest mesh.
const ACCURACY: f64 = 0.03;
/// Half the width of the box, in radii. The sides are open: for a circle of that radius the added mass of mode `n` is
/// smaller by `2 BOX^{-2n}`, and the frequency of `n = 2` higher by 0.04 %.
const BOX: f64 = 6.0;
/// Stabilisations: the standard set, with which a fluid of such low viscosity slips like an ideal one, and that with
/// the penalty of the paper's cases, with which it sticks.
const SETS: [(Stabilisation, &str); 2] = [(Stabilisation::STANDARD, "slips"), (PAPERS_PENALTY, "sticks")];
// Time steps in a period, and periods that are counted.
const STEPS: f64 = 40.0;
const PERIODS: f64 = 2.5;

/// Required order in the time step of the amplitude after three quarters of a period.
const TIME_ORDER: f64 = 1.8;

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.8, 0.4, 0.2] } else { &[0.8, 0.4] };
    let mut curves = Vec::new();
    for (n, exact) in MODES.into_iter().take(if record.full { 2 } else { 1 }) {
        let mode = Mode::new(n, exact);
        let hertz = mode.hertz();
        for (set, name) in SETS {
            let mut curve = Vec::new();
            for &h in sizes {
                let found = frequency(&mode, h, STEPS, set)?;
                record.show(
                    cgs(&format!("n = {n}, fluid {name}, h = {h} <length>: frequency [Hz]")),
                    found,
                    Some(hertz),
                );
                curve.push((h, found / hertz));
            }
            let finest = curve.last().map_or(f64::NAN, |(_, ratio)| ratio * hertz);
            record.near_relative(format!("n = {n}, fluid {name}: frequency [Hz]"), finest, hertz, ACCURACY);
            curves.push((format!("n = {n}, fluid {name}"), curve));
        }
    }
    if record.full {
        let (n, exact) = MODES[0];
        let mode = Mode::new(n, exact);
        for steps in [0.5 * STEPS, 2.0 * STEPS, 4.0 * STEPS] {
            let found = frequency(&mode, 0.4, steps, Stabilisation::STANDARD)?;
            let quantity =
                cgs(&format!("n = {n}, fluid slips, h = 0.4 <length>, {steps} steps in a period: frequency [Hz]"));
            record.show(quantity, found, Some(mode.hertz()));
        }
    }
    order_in_time(record)?;
    record.figure("Frequency over that of a disk in ideal fluid", &cgs("h [<length>]"), curves);
    record.note(format!(
        "{STEPS} steps in a period, {PERIODS} periods from the shape of the mode at rest; generalised-α (rho_inf = 0.8). Open \
         box of {} by {} cm; h at the surface of the disk, in both meshes. The \
         finest mesh counts, without extrapolation. The viscous layer is far thinner than the cells, and the penalty of the \
         mortar decides whether the fluid slips along the disk (standard set), as ideal fluid does, or sticks to it (γ_Σ = 1e5): then a \
         layer of the thickness of cells goes along with it.",
        short(2.0 * BOX * RADIUS),
        short(2.0 * BOX * RADIUS),
    ));
    Ok(())
}

/// Measures the order in the time step of the coupled vibration.
fn order_in_time(record: &mut Record) -> Result<(), Failure> {
    let (n, exact) = MODES[0];
    let mode = Mode::new(n, exact);
    let (mut changes, mut coarser) = (Vec::new(), None);
    for k in 0..5 {
        let steps = 12 << k;
        let (setup, amplitude) = vibration(&mode, 0.8, f64::from(steps), Stabilisation::STANDARD)?;
        let mut run = DirectRun::lagged(setup)?;
        let at_start = amplitude(run.state.bodies[0].displacement());
        run.advance_by(3 * steps / 4)?;
        let found = amplitude(run.state.bodies[0].displacement()) / at_start;
        if let Some(coarser) = coarser {
            let difference: f64 = found - coarser;
            changes.push((2.0 / f64::from(steps), difference.abs()));
        }
        coarser = Some(found);
    }
    let quantity = cgs(&format!(
        "n = {n}, fluid slips, h = 0.8 <length>: amplitude after 3/4 of a period, change when dt is halved"
    ));
    record.order(&quantity, "dt in periods", &changes, TIME_ORDER);
    Ok(())
}

/// Returns the frequency of a mode, Hz.
fn frequency(mode: &Mode, h: f64, steps: f64, set: Stabilisation) -> Result<f64, Failure> {
    let (setup, amplitude) = vibration(mode, h, steps, set)?;
    frequency_of(DirectRun::lagged(setup)?, (PERIODS + 0.5) / mode.hertz(), amplitude)
}

/// Returns the setup of a disk in the shape of a mode, and the map of its displacements to the amplitude of the mode.
fn vibration(
    mode: &Mode,
    h: f64,
    steps: f64,
    set: Stabilisation,
) -> Result<(Setup<2>, impl Fn(&[V]) -> f64 + use<>), Failure> {
    let period = 1.0 / mode.hertz();
    let mut setup = still(background(h)?, VISCOSITY, period / steps, 1e-9, open)?;
    fluid_mut(&mut setup)?.stabilisation = set;
    setup.scheme = second_order(0.8)?;
    let body = mode.disk(h, Arc::clone(&setup.scheme))?;
    let amplitude = mode.projection(&body.solid);
    setup.bodies.push(body.body("disk")?);
    Ok((setup, amplitude))
}

/// Returns a box whose cells have size `h` at the disk and grow with the distance.
fn background(h: f64) -> Result<SimplexMesh<2>, Failure> {
    // x = R sinh(b s): cells of size b sqrt(R² + x²)/n.
    let b = BOX.asinh();
    let n = (SQRT_2 * b * RADIUS / h).ceil() as usize;
    let even = structured_box::<2>([-1.0; 2], [1.0; 2], [2 * n; 2])?;
    Ok(even.mapped(|s| P::new(RADIUS * (b * s[0]).sinh(), RADIUS * (b * s[1]).sinh()))?)
}
