//! The mortaring terms, one per file.

mod adjoint_consistency;
mod consistency;
mod penalty;

pub use adjoint_consistency::AdjointConsistency;
pub use consistency::Consistency;
pub use penalty::{Penalty, PenaltyProfile};
