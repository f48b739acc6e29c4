//! Scenario files: declarations of their keys, reader and construction of the problem.

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
mod solver;
mod table;
mod units;

pub use body::{Body, BodyCondition, Material, TimeScheme};
pub use case::{Case, CaseVisitor, lower};
pub use contact::{Contact, ContactLaw, Obstacle};
pub use error::{ErrorKind, Location, ScenarioError};
pub use field::{Field, FieldFormula};
pub use file::{Output, Scenario, ScenarioFile};
pub use fluid::{
    Axis, Background, Cip, Convection, Fluid, FluidCondition, GradedSize, InflowProfile, Interface, InterfacePenalty,
    StabilisationSet, StabilisationTable,
};
pub use formula::{Formula, FormulaError};
pub use geometry::Shape;
pub use key::{Key, Quantity};
pub use motion::{Held, Motion};
pub use solver::{Blocks, BodyBlock, FluidBlock, Linear, Newton, Preconditioner, Solver, Time};
pub use table::{At, Components, Named, OrTable};
pub use units::{System, UnitNames, Units};
