//! The one geometric primitive: splitting a convex polytope by a plane.

mod face;
mod polytope;

pub(crate) use face::{face_difference, face_overlap};
pub use polytope::{FaceLabel, Polytope};
