//! Mesh generators for boxes, balls and the insides of closed lines, with refinement in regions, and mirror images.

mod ball;
mod bisect;
mod closed_line;
mod graded_box;
mod grid;
mod icosahedron;
mod inside;
mod mirror;
mod region;
mod size;
mod triangulate;
mod unit;

pub use ball::{BallOptions, HALF_BALL_PLANE, ball, half_ball};
pub use closed_line::ClosedLine;
pub use graded_box::{expected_cells, expected_cells_where, graded_box, refined_box};
pub use grid::structured_box;
pub use inside::{inside, refined_inside};
pub use mirror::mirrored;
pub use region::{Region, RegionShape};
pub use size::Size;
