//! The terms of contact, one file each.

mod contact_work;

pub use contact_work::ContactWork;
