//! Impact of a disk of the paper's material on a rigid plane without a fluid: the effect of the time step alone on the
//! rebound.

use std::sync::Arc;

use cutwater::mesh::Aabb;
use cutwater::mesh::generate::{BallOptions, half_ball};
use cutwater::solid_svk::{SaintVenantKirchhoff, SupportKind};

use crate::outcome::Failure;
use crate::verify::dry::{LAME, RADIUS, Scheme, elastic, floor, run};
use crate::verify::run::{DirectRun, V};

/// Speed of the ball at the virtual barrier, cm/s.
pub(crate) const SPEED: f64 = 52.45;
// Contact penalty over contact size, as in the cases.
const GAMMA_CONTACT: f64 = 1e8;
const CONTACT_SIZE: f64 = 0.1;
/// Steps without contact, as a time in s, after which the impact is over.
const SILENCE: f64 = 1.5e-3;
/// Time after which an unfinished impact has failed, s.
const LATEST: f64 = 0.05;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impact {
    /// Time step, s.
    pub(crate) dt: f64,
    /// Time from the first to the last step in contact, s.
    pub(crate) duration: f64,
    /// Velocity of the centre of mass after the impact, divided by that before.
    pub(crate) restitution: f64,
    /// Smallest height of the disk, cm; 8 if undeformed.
    pub(crate) smallest_height: f64,
    /// Largest elastic energy, divided by the kinetic energy before the impact.
    pub(crate) elastic_peak: f64,
    /// Lost energy, divided by the energy before the impact.
    pub(crate) loss: f64,
}

/// Creates the run of the disk above the plane: one half of it, by symmetry.
fn start(size: f64, speed: f64, dt: f64, scheme: Scheme) -> Result<DirectRun, Failure> {
    let mesh = half_ball([0.0, RADIUS], RADIUS, size, &BallOptions { area_preserving: false })?;
    let mut body = elastic(mesh, 1.0, SaintVenantKirchhoff::new(LAME), V::zeros(), scheme)?;
    body.hold("left", SupportKind::symmetry(0))?;
    body.options.initial_velocity = Some(Arc::new(move |_| V::new(0.0, -speed)));
    let contact = floor(body.part("surface")?, GAMMA_CONTACT, CONTACT_SIZE)?;
    run(vec![body], Some(contact), dt, 1e-9)
}

/// Computes the impact of the disk with cells of a size, at a speed, with a time step.
///
/// # Errors
/// A step fails, or the disk does not leave the plane.
pub(crate) fn impact(size: f64, speed: f64, dt: f64, scheme: Scheme) -> Result<Impact, Failure> {
    let mut run = start(size, speed, dt, scheme)?;
    let balance = |run: &DirectRun| run.setup.bodies[0].balance(&run.state.bodies[0]).ok_or("the disk is elastic");
    let height =
        |run: &DirectRun| Aabb::of_points(&run.state.bodies[0].positions(run.setup.bodies[0].reference())).extent()[1];
    let before = balance(&run)?;
    let (mut first, mut last) = (None, 0.0);
    let (mut smallest_height, mut elastic_peak) = (height(&run), 0.0_f64);
    while run.state.time < LATEST && first.is_none_or(|_| run.state.time - last < SILENCE) {
        let report = run.advance()?;
        if report.contacts[0].is_active() {
            first.get_or_insert(run.state.time - dt);
            last = run.state.time;
        }
        smallest_height = smallest_height.min(height(&run));
        elastic_peak = elastic_peak.max(balance(&run)?.elastic_energy / before.kinetic_energy);
    }
    let after = balance(&run)?;
    Ok(Impact {
        dt,
        duration: last - first.ok_or("the disk did not reach the plane")?,
        restitution: -after.momentum[1] / before.momentum[1],
        smallest_height,
        elastic_peak,
        loss: 1.0 - after.energy() / before.energy(),
    })
}

#[cfg(test)]
mod tests {
    use cutwater::algebra::time::ImplicitEuler;

    use super::*;

    /// Explicit central differences on finer meshes: 11.1 ms, restitution 0.98, height 7.77. Implicit Euler takes
    /// energy, and less of it with smaller steps.
    #[test]
    fn the_rebound_tends_to_the_known_one() {
        let coarse = impact(0.8, SPEED, 1e-3, Arc::new(ImplicitEuler)).unwrap();
        let fine = impact(0.8, SPEED, 1e-4, Arc::new(ImplicitEuler)).unwrap();
        assert!(coarse.restitution < fine.restitution && fine.restitution < 1.0, "{coarse:?} {fine:?}");
        assert!(coarse.loss > fine.loss && fine.loss > 0.0);
        assert!((fine.duration - 11.1e-3).abs() < 1e-3 && (fine.smallest_height - 7.77).abs() < 0.02, "{fine:?}");
    }
}
