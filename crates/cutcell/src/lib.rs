//! Cutting a simplicial background mesh by the explicit, moving, closed surfaces of any number of bodies.
//!
//! # Definitions
//! - *Fluid* is the background without the union of the bodies. A body is what its surface encloses; a place that a
//!   surface encloses twice is inside once.
//! - A background cell is in the state [`CellState::Fluid`] (untouched), [`CellState::Covered`] (inside the
//!   bodies) or [`CellState::Cut`].
//! - A *fluid part* ([`PartId`]) is one connected piece of fluid inside one cell. An uncut fluid cell has exactly
//!   one part; a cell crossed by a thin body has two or more. Parts are made of convex pieces ([`Polytope`]); the
//!   covered pieces of cut cells are the solid side.
//! - An *interface piece* ([`InterfacePiece`]) is a piece of a body's facet with fluid in front of it; it knows its
//!   cell, part, body and facet. Where several bodies share a facet, one of them owns the piece.
//! - A *part face* ([`PartFace`]) is an interior face of the background seen by one pair of parts that share fluid
//!   on it; next to a cut cell it is a *ghost face*.
//!
//! A disk and a thin bar in a box of triangles, and the fluid parts of tetrahedra behind a turned cube, drawn apart:
//!
#![doc = concat!("<div>\n", include_str!("../../../docs/src/images/cut-mesh-plane.svg"), "</div>\n")]
#![doc = concat!("<div>\n", include_str!("../../../docs/src/images/cut-mesh-space.svg"), "</div>\n")]
//!
//! # How it works
//! Every cell that facets touch is divided by the planes of those facets into convex pieces, a plane only through the
//! pieces that its facet runs through: a tree of planes per cell. A piece of a facet that reaches a node of the tree
//! lies on it; what reaches a leaf divides it. Walls between leaves follow from the tree, the number of bodies around
//! each leaf from the facets on the walls, starting at one leaf where crossings are counted.
//!
//! # Accuracy
//! - Every decision is exact: on which side of a plane a corner lies is a rational number of the input, decided with
//!   exact arithmetic where rounding leaves a doubt. There is no tolerance, no shifting of points, and neighbouring
//!   cells agree.
//! - Coordinates of corners are exact points rounded: parts and covered pieces of a cell add up to its volume, and
//!   pieces of a facet to the facet, up to the round-off of the coordinates.
//! - Coordinates of surfaces below 1e-60 count as zero, those beyond [`FARTHEST`] times the background are refused: products
//!   stay in the range of numbers.
//! - Weights of quadrature rules are positive and points lie inside their part.
//! - Fluid parts thinner than [`OverlayOptions::relative_tolerance`] cell sizes are left out, and the facets behind them
//!   border the next cell: bodies this close touch, and a facet this close to a face of the background lies on it.
//! - Surfaces that are open, non-manifold, turned inwards, self-intersecting or not finite are refused with the place
//!   where they are ([`Error`]). A cell whose cut looks wrong can be kept as a [`Capsule`].
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
mod workspace;

pub use capsule::Capsule;
pub use clip::{FaceLabel, Polytope};
pub use cut_mesh::{BoundaryPiece, CellState, CutMesh, InterfacePiece, PartFace, PartId};
pub use error::Error;
pub use overlay::OverlayOptions;
pub use report::{CutReport, SLIVER};
pub use soundness::FARTHEST;
pub use workspace::{OverlayTimes, Workspace};

pub use mesh;
