//! A disk that hits a rigid plane without a fluid around it.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;

use super::dry::{Scheme, second_order};
use super::{Failure, Record, short};
use crate::bounds::impact::{SPEED, impact};
use crate::units::cgs;

// Explicit central differences on meshes of 0.2 and 0.1 cm, with energy kept to 2e-4: restitution, duration of contact
// in ms, smallest height in cm.
const RESTITUTION: f64 = 0.98;
const DURATION: f64 = 11.1;
const HEIGHT: f64 = 7.771;

/// Spectral radius of the scheme that is compared with these values.
const GATED: f64 = 0.8;

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let (size, steps): (f64, &[f64]) = if record.full { (0.2, &[2e-4, 1e-4, 5e-5]) } else { (0.4, &[2e-4, 1e-4]) };
    let mut schemes: Vec<(String, Scheme, bool)> = vec![("implicit Euler".to_owned(), Arc::new(ImplicitEuler), false)];
    for rho_inf in [0.5, GATED, 1.0] {
        schemes.push((format!("rho_inf = {rho_inf}"), second_order(rho_inf)?, rho_inf == GATED));
    }
    let mut curves = Vec::new();
    let mut gated = None;
    for (name, scheme, is_gated) in schemes {
        let mut losses = Vec::new();
        for &dt in steps {
            let found = impact(size, SPEED, dt, Arc::clone(&scheme))?;
            let at = format!("{name}, dt = {}", short(dt));
            record.show(format!("{at}: restitution"), found.restitution, Some(RESTITUTION));
            record.show(format!("{at}: contact lasts [ms]"), 1e3 * found.duration, Some(DURATION));
            record.show(format!("{at}: energy lost"), found.loss, None);
            losses.push((dt, found.loss));
            if is_gated {
                gated = Some(found);
            }
        }
        curves.push((name, losses));
    }
    // Result with the smallest step.
    let found = gated.ok_or("nothing was measured")?;
    record.near("restitution", found.restitution, RESTITUTION, 0.02);
    record.near("contact lasts [ms]", 1e3 * found.duration, DURATION, 0.4);
    record.near_relative(cgs("smallest height [<length>]"), found.smallest_height, HEIGHT, 0.005);
    record.figure("energy lost in an impact, over that before", "time step [s]", curves);
    record.note(format!(
        "Cells of {size} cm; generalised-α with three spectral radii. The last rows are those of rho_inf = {GATED} at dt = {} s.",
        short(found.dt)
    ));
    Ok(())
}
