//! Mesh generators for boxes, balls and their mirror images.

mod ball;
mod bisect;
mod graded_box;
mod grid;
mod mirror;
mod region;
mod size;
mod triangulate;

pub use ball::{BallOptions, ball, half_ball};
pub use graded_box::{expected_cells, graded_box, refined_box};
pub use grid::structured_box;
pub use mirror::mirrored;
pub use region::{Region, RegionShape};
pub use size::Size;
