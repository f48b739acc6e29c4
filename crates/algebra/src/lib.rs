//! Blocks of unknowns, local systems, sparse assembly, Newton's method and linear solvers.
//!
//! Nothing here knows a space dimension, a mesh or a physical quantity: physics arrives as [`Contributions`].

mod contributions;
mod layout;
mod local_system;

pub use contributions::Contributions;
pub use layout::{BlockLayout, DofId, FieldId};
pub use local_system::LocalSystem;
