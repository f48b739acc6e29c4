//! The coupled problem, one time step, the time loop.
//!
//! Read [`advance`] first: one step from state to state. Geometry is explicit in time, so everything geometric is
//! computed once per step and is read-only during Newton's method:
//!
//! ```text
//! state^n -> surfaces -> CutMesh -> XfemSpace -> history -> FsiProblem -> x -> state^{n+1} -> observers
//! ```
//!
//! This crate composes; of integrals it evaluates only those of its reports.

pub mod dry;

mod bodies;
mod error;
mod geometry;
mod observe;
mod pocket;
mod problem;
mod report;
mod setup;
mod state;
mod step;
mod system;
mod time_loop;

pub use bodies::{BodyForms, BodyUnknown, Motion};
pub use error::{SetupError, Stage, StepError};
pub use geometry::StepGeometry;
pub use observe::{Observer, ObserverError, StepView};
pub use pocket::{Pocket, pockets};
pub use problem::{FsiProblem, StepForms};
pub use report::{BodyReport, ForceBalance, StageSeconds, StepReport};
pub use setup::{
    Body, BodyKind, BodySupport, Contact, ContactObstacle, ElasticBody, FluidBoundary, FluidSetup, PointField,
    PrescribedBody, RigidBody, Setup, SupportKind, SurfaceVelocity, TimeField, TractionField,
};
pub use state::{BodyState, FluidState, State};
pub use step::{Substep, advance, advance_by};
pub use system::StepSystem;
pub use time_loop::TimeLoop;

pub use algebra;
pub use contact;
pub use cutcell;
pub use fluid_ns;
pub use interface_dg;
pub use mesh;
pub use solid_rigid;
pub use solid_svk;
pub use xfem_space;
