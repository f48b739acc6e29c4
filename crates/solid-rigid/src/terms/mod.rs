//! The terms of a rigid body, one file each.

mod momentum;
mod variable_weight;

pub use momentum::Momentum;
pub use variable_weight::VariableWeight;
