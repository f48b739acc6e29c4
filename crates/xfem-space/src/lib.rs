//! P1 spaces on a cut mesh, with one copy of the degrees of freedom per fluid part.
//!
//! One sentence defines the space: *a dof is a class of (part, vertex) pairs; two pairs with the same vertex are the
//! same dof when their parts share a piece of a face that contains the vertex.* There is no distinction between
//! standard and extended dofs. A cell that a thin body divides has two independent sets of values.
//!
//! [`XfemSpace`] numbers the dofs, [`PartValues`] and [`FaceValue`] hold integrals of shape functions for assembly, and
//! [`Sources`] carry fields from one space to the next.

mod boundary;
mod classes;
mod face_values;
mod numbering;
mod part_values;
mod regions;
mod space;
mod transfer;

pub use boundary::{BoundaryPoint, boundary_dofs, boundary_points};
pub use classes::Classes;
pub use face_values::{FaceValue, face_values, symmetry_values};
pub use part_values::{HoopMoments, Moments, PartValues};
pub use regions::{regions, small_regions};
pub use space::XfemSpace;
pub use transfer::Sources;
