//! DG mortaring of fluid and solid on the cut interface, with the traction `T = α T^f + (1 - α) T^s`.
//!
//! With `α = 1` the traction is that of the fluid alone.
//!
//! The three mortaring lines of Eq. (4), side by side with their files; `n^f = -n`, `n` the normal out of the solid:
//!
//! | line | file |
//! |---|---|
//! | `-(T(u, p; d) n^f, v - w)` | `terms/consistency.rs` |
//! | `-(u - v_s, T(v, -q; w) n^f)` | `terms/adjoint_consistency.rs` |
//! | `(S (u - v_s), v - w)` | `terms/penalty.rs` |
//!
//! In films there are two more: the penalty on the mean slip (`mean_slip.rs`, docs/adr/0044-mean-slip-in-films.md), and
//! the pressure of a film up to the edge at which it ends (`terms/film_end.rs`,
//! docs/adr/0045-pressure-at-the-end-of-films.md).
//!
//! Where surfaces are in contact they border no fluid. On these *closed* parts acts the term `(p n, w)` of
//! `terms/closed_pressure.rs`, with the pressure `p` of the fluid at the rim. The pressure acts on the elements of a
//! body at the stage of the step, or with implicit Euler at the positions of the cut: `terms/moved_pressure.rs` moves
//! it there from the plane facets of the cut.
//!
//! The velocity of the body is unknown, or given at every point ([`body::SurfaceVelocity`]).

mod closed;
mod form;
mod leak;
mod mean_slip;
mod moved_facet;
mod moved_surface;
mod piece_point;
mod piece_values;
mod pockets;
mod points;
mod power;
mod slip_patch;
mod solid_share;
mod stability;
mod stress;
pub mod terms;
mod traction;

pub use closed::{ClosedPoint, ClosedPoints};
pub use form::MortarForm;
pub use leak::{InterfaceFlow, interface_flow};
pub use mean_slip::{MeanSlip, MeanSlips};
pub use moved_surface::{MovedPoint, MovedSurface};
pub use piece_point::PiecePoint;
pub use piece_values::PieceValues;
pub use pockets::{Pocket, pockets};
pub use points::{InterfacePoints, MortarPoint};
pub use power::{InterfacePower, interface_power};
pub use solid_share::{SolidShare, SolidTraction};
pub use stability::{UnstableShare, unstable_share};
pub use stress::{FluidStress, StressJump};
pub use traction::{InterfaceTraction, interface_tractions};
