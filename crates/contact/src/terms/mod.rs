//! The terms of contact, one file each.

mod normal_traction;

pub use normal_traction::NormalTraction;
