//! Simplicial meshes and their boundaries, quadrature on simplices, and spatial search.
//!
//! Definitions
//! - A *cell* is a simplex of dimension `D` (triangle, tetrahedron), a *facet* is a simplex of dimension `D - 1`.
//! - Cells are positively oriented. Local facet `i` of a cell is opposite to its local vertex `i`.
//! - A mesh is immutable. A moved mesh is the same mesh at other positions of its vertices ([`Placed`]).
//!
//! ```
//! use mesh::generate::{graded_box, Size};
//! let mesh = graded_box::<2>([0.0, 0.0], [2.0, 1.0], &Size::uniform(0.25))?;
//! let area: f64 = mesh.cells().map(|c| mesh.cell_volume(c)).sum();
//! assert!((area - 2.0).abs() < 1e-12);
//! # Ok::<(), mesh::Error>(())
//! ```

pub mod generate;
pub mod search;

mod aabb;
mod boundary_mesh;
mod coordinates;
mod element;
mod error;
mod ids;
mod placement;
mod quadrature;
mod range;
mod simplex;
mod simplex_mesh;
mod tensor;
mod topology;

pub use aabb::Aabb;
pub use boundary_mesh::BoundaryMesh;
pub use coordinates::Coordinates;
pub use element::{Barycentric, MAX_CELL_NODES, MAX_FACET_NODES, Order, ShapeFunctions};
pub use error::Error;
pub use ids::{BodyId, CellId, FacetId, Tag, VertexId};
pub use placement::{Enclosed, Placed, facet_normal};
pub use quadrature::{QuadratureRule, SimplexRule};
pub use range::{ParameterError, non_negative, positive, require};
pub use simplex::{MAX_CELL_VERTICES, MAX_FACET_VERTICES, Simplex, diameter, equilateral_side, simplex_measure};
pub use simplex_mesh::SimplexMesh;
pub use tensor::{AXES, Point, Tensor, Vector, are_opposite, area_vector, det, mean, moment_of, sym, unit_vector};

pub use nalgebra;
