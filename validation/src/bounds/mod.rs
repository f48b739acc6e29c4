//! Bounds and limits for the falling balls that do not depend on the method.

pub(crate) mod impact;
pub(crate) mod potential;
