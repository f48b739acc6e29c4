//! Blocks of unknowns, local systems, sparse assembly, Newton's method and linear solvers.
//!
//! Nothing here knows a space dimension, a mesh or a physical quantity: physics arrives as [`Contributions`].

mod block_system;
mod check;
mod constraints;
mod contributions;
mod faer_view;
mod layout;
mod linear;
mod local_system;
mod newton;
mod pattern;
mod scatter;
mod workspace;

pub use block_system::{BlockSystem, ContributionTiming};
pub use check::{TangentDeviation, check_tangent, worst_tangent_entry};
pub use constraints::Constraints;
pub use contributions::Contributions;
pub use layout::{BlockLayout, DofId, FieldId};
pub use linear::{DirectSolver, Equilibration, LinearError, LinearReport, LinearSolver, MatrixView};
pub use local_system::LocalSystem;
pub use newton::{NewtonError, NewtonReport, NewtonSettings, NonlinearProblem, newton};
pub use pattern::{ItemMap, Pattern};
pub use workspace::Workspace;
