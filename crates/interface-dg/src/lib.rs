//! interface-dg.
