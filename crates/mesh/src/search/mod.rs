//! Spatial search: closest points on a surface, cells and facets near a box.
