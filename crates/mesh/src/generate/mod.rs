//! Mesh generators for boxes, balls and their mirror images.

mod ball;
mod graded_box;
mod grid;
mod mirror;
mod size;
mod triangulate;

pub use ball::{BallOptions, ball, half_ball};
pub use graded_box::graded_box;
pub use grid::structured_box;
pub use mirror::mirrored;
pub use size::Size;
