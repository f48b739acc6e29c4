//! Scenario files: declarations of their keys, reader and construction of the problem.
//!
//! Where the name of a table is that of a library's type, the declaration ends in `Keys` or `Choice`: [`BodyKeys`] are read,
//! and a `dyn Body` is built of them.

mod body;
pub mod case;
mod contact;
mod error;
mod field;
mod file;
mod fluid;
mod formula;
mod geometry;
pub mod key;
mod motion;
mod motion_table;
mod overrides;
mod probe;
mod schema;
mod solver;
mod table;
mod units;

pub use body::{BodyCondition, BodyKeys, MaterialChoice};
pub use case::{Case, CaseVisitor, lower};
pub use contact::{ContactKeys, ContactLawChoice, ObstacleChoice};
pub(crate) use error::advice;
pub use error::{ErrorKind, Location, ScenarioError};
pub use field::{Field, FieldFormula};
pub use file::{Output, Scenario, ScenarioFile};
pub use fluid::{
    Axis, Background, Cip, ConvectionChoice, Fluid, FluidCondition, GradedSize, InflowProfile, Interface,
    InterfacePenalty, Refinement, RegionChoice, StabilisationChoice, StabilisationKeys,
};
pub use formula::{Formula, FormulaError};
pub use geometry::Shape;
pub use key::{Key, Quantity};
pub use motion::{Held, MotionChoice};
pub use probe::ProbeChoice;
pub use schema::schema;
pub use solver::{Blocks, BodyBlock, FluidBlock, Linear, Newton, Preconditioner, Solver, Time, TimeSchemeChoice};
pub use table::{At, Components, Named, OrTable};
pub use units::{System, UnitNames, Units};
