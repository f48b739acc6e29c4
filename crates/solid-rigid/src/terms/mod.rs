//! The terms of a rigid body, one file each.

mod momentum;
mod variable_gravity;

pub use momentum::Momentum;
pub use variable_gravity::VariableGravity;
