//! The terms of the weak form, one file each.

mod body_force;
mod hoop_work;
mod inertia;
mod internal_work;
mod pressure;
mod traction;

pub use body_force::BodyForce;
pub use hoop_work::HoopWork;
pub use inertia::Inertia;
pub use internal_work::InternalWork;
pub use pressure::FollowerPressure;
pub use traction::Traction;
