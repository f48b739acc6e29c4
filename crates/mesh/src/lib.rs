//! Simplicial meshes, their boundaries, positions in time, quadrature on simplices and spatial search.
//!
//! Vocabulary
//! - a *cell* is a simplex of dimension `D` (triangle, tetrahedron), a *facet* a simplex of dimension `D - 1`;
//! - cells are positively oriented, local facet `i` of a cell lies opposite to its local vertex `i`;
//! - a mesh is immutable; a moved mesh is the same mesh *seen at* other positions ([`Placed`]).
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

mod boundary_mesh;
mod error;
mod ids;
mod placement;
mod quadrature;
mod simplex;
mod simplex_mesh;
mod tensor;
mod topology;

pub use boundary_mesh::BoundaryMesh;
pub use error::Error;
pub use ids::{BodyId, CellId, FacetId, Tag, VertexId};
pub use placement::{Placed, facet_normal};
pub use quadrature::{QuadratureRule, SimplexRule};
pub use simplex::{MAX_CELL_VERTICES, Simplex, equilateral_side, simplex_measure};
pub use simplex_mesh::SimplexMesh;
pub use tensor::{Point, Tensor, Vector, det, sym};

pub use nalgebra;
