//! Scenario files: declarations of their keys, reader and construction of the problem.
//!
//! The type of a table whose name is also a type of a library ends in `Keys` or `Choice`: a `dyn Body` is built from
//! [`BodyKeys`].

mod background;
mod balance;
mod body;
pub mod case;
mod condition;
mod contact;
mod error;
mod field;
mod field_table;
mod file;
mod fluid;
mod formula;
mod geometry;
pub mod key;
mod motion;
mod motion_table;
mod overrides;
mod placement;
mod probe;
mod quantity;
mod schema;
mod solver;
mod symmetry;
mod table;
mod units;

pub use background::{Axis, Background, GradedSize, Refinement, RegionChoice};
pub use body::{BodyCondition, BodyKeys, LameKeys, MaterialChoice};
pub use case::{Case, CaseVisitor, expected_cells, lower};
pub use condition::{FluidCondition, InflowProfile};
pub use contact::{ContactKeys, ContactLawChoice, ObstacleChoice};
pub(crate) use error::advice;
pub use error::{ErrorKind, Location, ScenarioError};
pub use field::{Field, FieldFormula};
pub use field_table::{FieldTable, Variable};
pub use file::{FieldChoice, Output, Scenario, ScenarioFile, is_name};
pub use fluid::{
    Cip, ConvectionChoice, FilmKeys, Fluid, Interface, InterfacePenalty, StabilisationChoice, StabilisationKeys,
};
pub use formula::{Formula, FormulaError};
pub use geometry::Shape;
pub use key::{Key, Quantity};
pub use motion::{GuideKeys, Held, MotionChoice};
pub(crate) use placement::overlapping;
pub use probe::ProbeChoice;
pub use schema::schema;
pub use solver::{
    Approach, Blocks, BodyBlock, FluidBlock, LinearSolverChoice, Newton, Preconditioner, Solver, Time, TimeSchemeChoice,
};
pub(crate) use symmetry::parabolas_at_symmetry;
pub(crate) use table::Choose;
pub use table::{At, Components, Named, OrTable};
pub use units::{System, UnitNames, Units};
pub(crate) use units::{rounded, rounded_down};
