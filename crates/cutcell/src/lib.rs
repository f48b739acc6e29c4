//! Cutting a simplicial background mesh by the explicit, moving, closed surfaces of any number of bodies.
//!
//! Definitions
//! - *Fluid* is the background without the union of the bodies.
//! - A background cell is in the state [`CellState::Fluid`] (untouched), [`CellState::Covered`] (inside the
//!   bodies) or [`CellState::Cut`].
//! - A *fluid part* ([`PartId`]) is one connected piece of fluid inside one cell. An uncut fluid cell has exactly
//!   one part; a cell crossed by a thin body has two or more.
//! - An *interface piece* ([`InterfacePiece`]) is a piece of a body's facet with fluid in front of it; it knows its
//!   cell, part, body and facet.
//! - A *part face* ([`PartFace`]) is an interior face of the background seen by one pair of parts that share fluid
//!   on it; next to a cut cell it is a *ghost face*.
//!
//! How it works: every cell that facets touch is split by the planes of those facets into convex pieces, a plane
//! only through the pieces that its facet really enters. Whether a piece is fluid is decided by counting crossings
//! between a mesh vertex and the piece, with exact predicates. Pieces are joined to parts, and parts of neighbouring
//! cells to part faces, wherever they share a face of positive measure.
//!
//! ```
//! use cutcell::{CutMesh, OverlayOptions};
//! use mesh::{Placed, generate::{Size, structured_box}};
//!
//! let background = structured_box::<2>([0.0, 0.0], [4.0, 4.0], [8, 8])?;
//! let square = structured_box::<2>([1.1, 1.2], [2.3, 3.1], [3, 5])?;
//! let boundary = square.boundary();
//! let cut = CutMesh::overlay(&background, &[Placed::new(&boundary, square.vertices())], &OverlayOptions::new())?;
//! assert!((cut.fluid_volume() - (16.0 - 1.2 * 1.9)).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod capsule;
mod cell;
mod classify;
mod clip;
mod cut_mesh;
mod error;
mod exact;
mod faces;
mod overlay;
mod report;
mod soundness;
mod surface;
mod touched;
mod tree;

pub use capsule::Capsule;
pub use clip::{FaceLabel, Polytope};
pub use cut_mesh::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};
pub use error::Error;
pub use overlay::OverlayOptions;
pub use report::{CutReport, SLIVER};

pub use mesh;
