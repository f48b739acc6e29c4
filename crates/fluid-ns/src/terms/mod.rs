//! The terms, one per file.

use mesh::{Point, Vector};

mod backflow;
mod body_force;
mod cavitation;
mod cip;
mod convection;
mod film;
mod ghost_penalty;
mod hoop;
mod hoop_convection;
mod incompressibility;
mod inertia;
mod traction;
mod viscous;

pub use backflow::Backflow;
pub use body_force::BodyForce;
pub use cavitation::Cavitation;
pub use cip::{CipPressure, CipProfile, CipVelocity};
pub use convection::Convection;
pub use film::Film;
pub use ghost_penalty::GhostPenalty;
pub use hoop::Hoop;
pub use hoop_convection::HoopConvection;
pub use incompressibility::Incompressibility;
pub use inertia::Inertia;
pub use traction::Traction;
pub use viscous::Viscous;

/// Force per volume at a point and time.
pub type ForceFunction<'a, const D: usize> = &'a (dyn Fn(&Point<D>, f64) -> Vector<D> + Send + Sync);
/// Traction at a point, given the outward normal, at a time.
pub type TractionFunction<'a, const D: usize> = &'a (dyn Fn(&Point<D>, &Vector<D>, f64) -> Vector<D> + Send + Sync);
