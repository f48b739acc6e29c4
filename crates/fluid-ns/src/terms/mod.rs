//! The terms, one per file.

mod backflow;
mod body_force;
mod cip;
mod convection;
mod ghost_penalty;
mod incompressibility;
mod inertia;
mod traction;
mod viscous;

pub use backflow::Backflow;
pub use body_force::BodyForce;
pub use cip::{CipPressure, CipProfile, CipVelocity};
pub use convection::Convection;
pub use ghost_penalty::GhostPenalty;
pub use incompressibility::Incompressibility;
pub use inertia::Inertia;
pub use traction::Traction;
pub use viscous::Viscous;
