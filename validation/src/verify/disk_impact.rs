//! A disk that hits a rigid plane without a fluid around it.

use std::path::Path;

use cutwater::solid_svk::TimeScheme;

use super::Failure;
use super::dry::second_order;
use super::record::{Record, short};
use crate::bounds::impact::impact;

/// Speed of the ball at the virtual barrier, cm/s.
const SPEED: f64 = 52.45;
/// Explicit central differences on meshes of 0.2 and 0.1 cm, with energy kept to 2e-4: restitution, duration of contact in ms,
/// smallest height in cm.
const RESTITUTION: f64 = 0.98;
const DURATION: f64 = 11.1;
const HEIGHT: f64 = 7.771;

/// Measures.
///
/// # Errors
/// A step fails, or the disk does not leave the plane.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let (size, steps): (f64, &[f64]) = if record.full { (0.2, &[2e-4, 1e-4, 5e-5]) } else { (0.4, &[2e-4, 1e-4]) };
    for rho_inf in [0.5, 0.8, 1.0] {
        for &dt in steps {
            let found = impact(size, SPEED, dt, second_order(rho_inf)?)?;
            let at = format!("rho_inf = {rho_inf}, dt = {}", short(dt));
            record.show(format!("{at}: restitution"), found.restitution, Some(RESTITUTION));
            record.show(format!("{at}: contact lasts [ms]"), 1e3 * found.duration, Some(DURATION));
            record.show(format!("{at}: energy lost"), found.loss, None);
        }
    }
    let dt = steps[steps.len() - 1];
    let found = impact(size, SPEED, dt, second_order(0.8)?)?;
    record.near("restitution", found.restitution, RESTITUTION, 0.02);
    record.near("contact lasts [ms]", 1e3 * found.duration, DURATION, 0.4);
    record.near_relative("smallest height [cm]", found.smallest_height, HEIGHT, 0.005);
    let euler = impact(size, SPEED, dt, TimeScheme::ImplicitEuler)?;
    record.show("implicit Euler: restitution", euler.restitution, Some(RESTITUTION));
    record.show("implicit Euler: contact lasts [ms]", 1e3 * euler.duration, Some(DURATION));
    record.note(format!(
        "Cells of {size} cm; the last rows are those of rho_inf = 0.8 and of implicit Euler at dt = {} s.",
        short(dt)
    ));
    Ok(())
}
