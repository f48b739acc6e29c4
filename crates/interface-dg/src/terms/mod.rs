//! Terms on the interface, one per file.

mod adjoint_consistency;
mod closed_pressure;
mod consistency;
mod film_end;
mod moved_pressure;
mod penalty;

pub use adjoint_consistency::AdjointConsistency;
pub use closed_pressure::ClosedPressure;
pub use consistency::Consistency;
pub use film_end::FilmEnd;
pub use moved_pressure::MovedPressure;
pub use penalty::{Penalty, PenaltyProfile};
