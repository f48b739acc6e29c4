//! Cuts of a simplicial background mesh by the closed, moving surfaces of any number of bodies.
//!
//! # Definitions
//! - A *body* is the region enclosed by its surface, also where the surface encloses it more than once. *Fluid* is the
//!   background without the union of the bodies.
//! - A background cell is in the state [`CellState::Fluid`] (untouched), [`CellState::Covered`] (inside the
//!   bodies) or [`CellState::Cut`].
//! - A *fluid part* ([`PartId`]) is a connected component of the fluid inside one cell. An uncut fluid cell has exactly
//!   one part; a cell crossed by a thin body has two or more. A part of a cut cell is a union of convex pieces
//!   ([`Polytope`]). The bodies' side of the cut is given by the covered pieces of cut cells.
//! - An *interface piece* ([`InterfacePiece`]) is a piece of a body's facet with fluid in front of it; it stores its
//!   cell, part, body and facet. If several bodies share a facet, the piece belongs to one of them.
//! - A *part face* ([`PartFace`]) is the wet portion of an interior face of the background that two parts share. Next
//!   to a cut cell, it is a *ghost face*.
//!
//! Fluid parts of a box of triangles with a disk and a thin bar, and of tetrahedra around a rotated cube (exploded
//! view):
//!
#![doc = concat!("<div>\n", include_str!("../images/cut-mesh-plane.svg"), "</div>\n")]
#![doc = concat!("<div>\n", include_str!("../images/cut-mesh-space.svg"), "</div>\n")]
//!
//! # Algorithm
//! Every cell that facets touch is divided into convex pieces by the planes of these facets. A plane divides only the
//! pieces that its facet crosses, so the division is a binary tree of planes per cell. Facets are inserted one after
//! the other: a piece of a facet descends to the leaves that it crosses, and divides them. Walls between leaves follow
//! from the tree. The number of bodies around a leaf is computed for one leaf by counting crossings, and for the others
//! from the facets on the walls.
//!
//! # Accuracy
//! - Every geometric decision is exact: the side of a plane on which a corner lies is the sign of a rational function
//!   of the input, evaluated with exact arithmetic if rounding makes it uncertain. No tolerance is used, no point is
//!   moved, and neighbouring cells agree.
//! - Coordinates of corners are exact points, rounded. The volumes of parts and covered pieces add up to that of the
//!   cell, and the measures of the pieces of a facet to that of the facet, up to the round-off of the coordinates.
//! - Coordinates of surfaces below 1e-60 are set to zero, and those beyond [`FARTHEST`] times the background are
//!   errors, so that products do not overflow or underflow.
//! - Weights of quadrature rules are positive, and points lie inside their part.
//! - Fluid parts thinner than [`OverlayOptions::relative_tolerance`] cell sizes are left out, and the facets behind
//!   them belong to the neighbouring cell. Bodies at such a distance touch each other, and facets at such a distance
//!   from a face of the background lie on it.
//! - Surfaces that are open, non-manifold, oriented inwards, self-intersecting or not finite are errors with their
//!   location ([`Error`]). A cell can be stored as a [`Capsule`] to reproduce a defect.
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

mod build;
mod capsule;
mod cell;
mod classify;
mod clip;
mod cut_mesh;
mod cutter;
mod cutting;
mod error;
mod exact;
mod faces;
mod options;
mod orientation;
mod report;
mod soundness;
mod surface;
mod touched;
mod tree;

pub use capsule::Capsule;
pub use clip::{FaceLabel, Polytope};
pub use cut_mesh::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};
pub use cutter::{Cutter, OverlayTimes};
pub use error::{Error, SurfaceVertex};
pub use options::OverlayOptions;
pub use report::{CutReport, SLIVER};
pub use soundness::FARTHEST;

pub use mesh;
