//! The terms of a rigid body, one file each.

mod momentum;

pub use momentum::Momentum;
