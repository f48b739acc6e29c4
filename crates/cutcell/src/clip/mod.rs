//! Convex pieces of planes and of cells, divided by planes.

mod face;
mod piece;
mod polygon;
mod polytope;

pub(crate) use face::{face_difference, face_overlap};
pub(crate) use piece::Piece;
pub(crate) use polygon::{FacePoints, Place, Polygon, Polygons, Side};
pub(crate) use polytope::Polytopes;
pub use polytope::{FaceLabel, Polytope};
