//! Exact predicates: all signs on which a cut depends.

mod crossing;
mod integer;
mod number;
mod plane;
mod planes;
mod solved;

pub(crate) use crossing::{End, crossing, is_degenerate, pierces, signed_volume};
pub(crate) use plane::{HalfSpace, Plane, PlaneKind};
pub(crate) use planes::{Corner, Planes};
pub(crate) use solved::Known;
