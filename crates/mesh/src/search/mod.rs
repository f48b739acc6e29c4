//! Spatial search: closest points on a surface, cells and facets near a box.

mod cells;
mod closest;
mod parry;
mod surface;

pub use cells::CellIndex;
pub use closest::{Feature, Foot, VertexToFacet, facets_are_within};
pub use surface::{ClosestPoint, SurfaceIndex};
