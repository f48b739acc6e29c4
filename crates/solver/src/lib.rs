//! The coupled problem, one time step, the time loop.
//!
//! Read [`advance`] first: one step from state to state. Geometry is explicit in time, so cut, space, interface pieces
//! and quadrature weights are computed once per step and are read-only during Newton's method:
//!
//! ```text
//! state^n -> Step (surfaces, CutMesh, XfemSpace, history, unknowns) -> Problem -> x -> state^{n+1} -> observers
//! ```
//!
//! Without a fluid the same step advances bodies in vacuum. This crate composes. Its only weak forms are the extension
//! of velocities to points that bodies have left and the condition of a collision; its other integrals are those of
//! reports.

mod approach;
mod augment;
mod collision;
mod contact_step;
mod error;
mod extension;
mod fluid_step;
mod ledger;
mod lists;
mod observe;
mod overlay;
mod passage;
mod prepare;
mod problem;
mod report;
mod seconds;
mod setup;
mod sides;
mod stabilisation;
mod state;
mod step;
mod surfaces;
mod time_loop;

pub use error::{Error, ObserverError, StepError};
pub use ledger::Ledger;
pub use observe::{Observer, StepView};
pub use prepare::{Step, Substep};
pub use problem::Problem;
pub use report::{BodyReport, FluidReport, ForceBalance, StepReport};
pub use seconds::StepSeconds;
pub use setup::{
    ApproachSteps, Contact, ContactObstacle, ConvectionForm, FilmSetup, FluidBoundary, FluidSetup, Setup, TractionField,
};
pub use sides::SideForce;
pub use stabilisation::Stabilisation;
pub use state::{FluidState, State};
pub use step::advance;
pub use time_loop::TimeLoop;

pub use algebra;
pub use body;
pub use contact;
pub use cutcell;
pub use fluid_ns;
pub use interface_dg;
pub use mesh;
pub use xfem_space;
