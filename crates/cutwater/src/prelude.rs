//! The names that most programs need.

pub use algebra::{NewtonSettings, Workspace};
pub use cutcell::{CellState, CutMesh, OverlayOptions};
pub use io::{ScenarioFile, Summary, Watch, run};
pub use mesh::generate::{
    BallOptions, Region, RegionShape, Size, ball, graded_box, half_ball, mirrored, refined_box, structured_box,
};
pub use mesh::{BoundaryMesh, Placed, Point, SimplexMesh, Vector};
pub use solver::{Observer, Setup, State, StepReport, StepView, TimeLoop, advance};
