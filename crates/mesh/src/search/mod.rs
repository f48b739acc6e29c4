//! Spatial search: closest points on a surface, cells and facets near a box.

mod cells;
mod parry;
mod surface;

pub use cells::CellIndex;
pub use surface::{ClosestPoint, Feature, SignedClosestPoint, SurfaceIndex};
