//! The speed of rebound of a sphere from a floor over the Stokes number.

use super::bounces::{FRAME, IN_AIR, SPEED, TWICE, cells, coarse_cells, legendre, rebounds};
use super::{Failure, Record};

/// Stokes numbers `2 rho_s R U / (9 mu)`: without rebound, between, and with rebound in all experiments.
const NUMBERS: [f64; 9] = [6.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0, 200.0, 500.0];
// Spheres with a smaller number do not rebound, and those with a larger one do: Joseph, Zenit, Hunt, Rosenwinkel 2001,
// doi:10.1017/S0022112001003470, find the limit near 10.
const NONE: f64 = 6.0;
const ALL: f64 = 20.0;
/// Smallest visible speed over the speed of the approach: the position of a sphere in a picture is uncertain by 0.03
/// mm.
const VISIBLE: f64 = 0.03e-3 / FRAME / SPEED;
/// Scans the Stokes number; the quick version has two numbers on coarse cells.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    if !record.full {
        let rebounds = rebounds(&[NONE, 200.0], &coarse_cells(), 0.02, record)?;
        record.at_most(
            "St 6, coarse cells: mean speed in the first 2 ms of the rebound over that before",
            rebounds[0].mean,
            VISIBLE,
        );
        record.near(
            "St 200, coarse cells: the same, over the restitution in air",
            rebounds[1].mean / IN_AIR,
            legendre(200.0),
            0.15,
        );
        return Ok(());
    }
    let mut found = Vec::new();
    let rebounds = rebounds(&NUMBERS, &cells(TWICE).collect::<Vec<_>>(), 0.06, record)?;
    for (number, rebound) in NUMBERS.into_iter().zip(rebounds) {
        let value = rebound.mean / IN_AIR;
        record.show(format!("St {number}: restitution over that in air; Legendre"), value, Some(legendre(number)));
        found.push((number, value));
    }
    let rise = found.windows(2).map(|pair| pair[1].1 - pair[0].1).fold(f64::INFINITY, f64::min);
    record.at_least("smallest change from one Stokes number to the next", rise, 0.0);
    for (number, value) in &found {
        if *number <= NONE {
            record.at_most(format!("St {number}: restitution, none visible"), *value, VISIBLE);
        } else if *number >= ALL {
            record.at_least(format!("St {number}: restitution, a visible one"), *value, VISIBLE);
        }
    }
    let curve =
        |of: fn(f64) -> f64| found.iter().map(|(number, _)| (*number, of(*number).max(0.0))).collect::<Vec<_>>();
    record.log_figure(
        "Restitution over that in air",
        "Stokes number",
        vec![
            ("computed", found.clone()),
            ("exp(-35/St), Legendre, Zenit, Daniel 2006", curve(legendre)),
            ("1 - 8.65 St^-0.75, Yang, Hunt 2006", curve(yang)),
        ],
    );
    record.note(
        "The example bouncing-sphere with other viscosities on cells of twice its size. Restitution: the mean speed in the first 2 ms after contact, which is the time between two pictures, over the speed \
         at a gap of one radius. Curves: fits of measured values, doi:10.1063/1.2164462 and doi:10.1063/1.2396925, which scatter by about 0.1 below a Stokes number of 50.",
    );
    Ok(())
}

/// Returns the fit `1 - 8.65 St^-0.75`.
fn yang(number: f64) -> f64 {
    1.0 - 8.65 * number.powf(-0.75)
}
