//! A free elastic disk that vibrates in its own modes.

use super::dry::{run, second_order};
use super::mode::{Mode, frequency_of};
use super::{Failure, Record, short};
use crate::units::cgs;

/// `n` and `ω R/c_s` of the first mode with `n` waves around the disk: roots of the frequency determinant of a free
/// disk in plane strain with `ν = 0.4`.
const MODES: [(u32, f64); 2] = [(2, 2.35106), (3, 3.63191)];
/// Time steps in a period, times the size of a cell: errors of mesh and time scheme fall together.
const STEPS: f64 = 24.0;
/// Number of periods from which the frequency is computed.
const PERIODS: f64 = 10.0;

/// Returns the frequency of a disk that starts in the shape of a mode, Hz.
fn found(mode: &Mode, size: f64) -> Result<f64, Failure> {
    let period = 1.0 / mode.hertz();
    let body = mode.disk(size, second_order(0.8)?)?;
    let amplitude = mode.projection(&body.solid);
    let run = run(vec![body], None, period * size / STEPS, 1e-9)?;
    frequency_of(run, PERIODS * period, amplitude)
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.8, 0.4, 0.2] } else { &[0.8, 0.4] };
    let mut curves = Vec::new();
    for (n, exact) in MODES {
        let mode = Mode::new(n, exact);
        let hertz = mode.hertz();
        let mut errors = Vec::new();
        let mut finest = f64::NAN;
        for &size in sizes {
            finest = found(&mode, size)?;
            record.show(format!("n = {n}, size {size}: frequency [Hz]"), finest, Some(hertz));
            errors.push((size, (finest / hertz - 1.0).abs()));
        }
        record.near_relative(format!("n = {n}: frequency [Hz]"), finest, hertz, 0.01);
        record.show_order(&format!("error of the frequency, n = {n}"), "size", &errors);
        curves.push((format!("n = {n}"), errors));
    }
    record.log_figure("error of the frequency, relative", &cgs("size of cells [<length>]"), curves);
    record.note(format!(
        "The disk starts at rest in the shape of the mode; its amplitude is the projection upon the mode, and the frequency follows from \
         all passages of zero in {PERIODS} periods. Generalised-α (rho_inf = 0.8) with {} steps in a period at size 0.4, and \
         twice as many at half the size; the finest mesh counts, without extrapolation.",
        short(STEPS / 0.4),
    ));
    Ok(())
}
