//! Bodies that move without deforming: three degrees of freedom in 2D, six in 3D.
//!
//! The unknowns of a body are the velocity `V` of its centre of mass and its spin `ω` at the stage of the step, and
//! with them the velocity of every point, `v(x) = V + ω × (x - c)`. Geometry is explicit in time as everywhere: `c` and
//! the positions `x` are those at which the background is cut, so that `v` is linear in the unknowns ([`modes`]).
//!
//! | line | formula | file |
//! |---|---|---|
//! | balance of momentum | `dP/dt - M g`, `dL/dt` at the stage; implicit Euler: `(M V - P^n)/Δt - M g`, `(J ω - L^n)/Δt` | `terms/momentum.rs` |
//! | gravity that varies in time | `-M g(t)` | `terms/variable_gravity.rs` |
//!
//! Fluid and contact act on the velocities of vertices, which are tied to the unknowns of the body ([`RigidBody`]).
//!
//! ```
//! use mesh::{BoundaryMesh, Placed, Point, VertexId};
//! use solid_rigid::MassProperties;
//!
//! let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(Point::<2>::from);
//! let sides = BoundaryMesh::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
//! let mass = MassProperties::of_surface(&Placed::new(&sides, &square), 3.0)?;
//! assert!((mass.mass - 12.0).abs() < 1e-12);
//! assert!((mass.second_moment.trace() - 12.0 * (4.0 + 4.0) / 12.0).abs() < 1e-12); // m (a² + b²)/12
//! # Ok::<(), solid_rigid::Error>(())
//! ```

pub mod modes;
pub mod terms;

mod centre;
mod error;
mod mass;
mod motion;
mod rigid;

pub use centre::{RigidCentre, RigidVelocity};
pub use error::Error;
pub use mass::MassProperties;
pub use modes::Spin;
pub use motion::RigidMotion;
pub use rigid::{Guide, RigidBody};
