//! Spatial search: closest points on a surface, cells and facets near a box.

mod cells;
mod parry;

pub use cells::CellIndex;
