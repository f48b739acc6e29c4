//! Elastic bodies moving, deforming and colliding inside an incompressible fluid, on a mesh that they cut.
//!
//! This crate re-exports the others; the names that most programs need are in [`prelude`].
//!
//! ```
//! use cutwater::prelude::*;
//!
//! let background = graded_box([0.0, 0.0], [10.0, 15.0], &Size::uniform(0.5))?;
//! let disk = ball([5.0, 7.0], 4.0, 0.1, &BallOptions { area_preserving: true })?;
//! let surface = disk.boundary();
//! let cut = CutMesh::overlay(&background, &[Placed::new(&surface, disk.vertices())], &OverlayOptions::new())?;
//! let exact = 150.0 - std::f64::consts::PI * 16.0;
//! assert!((cut.fluid_volume() - exact).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod prelude;

pub use algebra;
pub use body;
pub use contact;
pub use cutcell;
pub use fluid_ns;
pub use interface_dg;
pub use io;
pub use mesh;
#[cfg(feature = "report")]
pub use report;
pub use solid_rigid;
pub use solid_svk;
pub use solver;
pub use xfem_space;
