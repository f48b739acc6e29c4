//! What is known about the falling balls without the method: bounds and limits.

pub(crate) mod impact;
pub(crate) mod potential;
