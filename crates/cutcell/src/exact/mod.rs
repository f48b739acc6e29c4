//! Exact decisions: everything that a cut decides by a sign is decided here.

mod crossing;
mod integer;
mod number;
mod planes;

pub(crate) use crossing::{End, crossing, is_degenerate, pierces, signed_volume};
pub(crate) use planes::{Corner, HalfSpace, Known, Plane, PlaneKind, Planes};
