//! Incompressible Navier-Stokes on a cut domain, P1/P1, with interior and ghost penalty.
//!
//! Strong form, in the fluid domain:
//!
//! ```text
//! ρ ∂u/∂t + ρ u·∇u - ∇·T(u, p) = f,    ∇·u = 0,    T = -p I + 2 μ D(u)
//! ```
//!
//! Weak form, one file per term:
//!
//! | term | file |
//! |---|---|
//! | `ρ (a, v)` | `terms/inertia.rs` |
//! | `2 μ (D(u), ∇v)` | `terms/viscous.rs` |
//! | `-(p, ∇·v) + (q, ∇·u)` | `terms/incompressibility.rs` |
//! | `ρ (u·∇u, v)` | `terms/convection.rs` |
//! | `-(f, v)` | `terms/body_force.rs` |
//! | hoop parts of these terms, in axisymmetric coordinates | `terms/hoop.rs`, `terms/hoop_convection.rs` |
//! | `(κ (∇p - f), ∇q)_Ω - (κ_s (∇p - f), ∇q)_Σ` in thin films | `terms/film.rs` |
//! | `-Σ_i q_i C K \|∇N_i\|² [p_c - p_i]_+`: vapour in thin films | `terms/cavitation.rs` |
//! | `s_h`: interior penalty of velocity and pressure | `terms/cip.rs` |
//! | `g_h`: ghost penalty | `terms/ghost_penalty.rs` |
//! | backflow stabilisation on open boundaries | `terms/backflow.rs` |
//! | traction given on open boundaries | `terms/traction.rs` |
//!
//! `u` and `p` are the unknowns at the stage of the step. `u*` is the velocity at its start, carried to the new space,
//! and extrapolated to the stage if accelerations are known. All stabilisation weights use `u*`, so that they are
//! constant during Newton's method.

mod cell;
mod face;
mod film;
mod film_edges;
mod film_layer;
mod fluid;
mod form;
mod geometry;
mod open_boundary;
pub mod terms;

pub use cell::{FluidCell, FluidCells};
pub use face::{FluidFace, FluidFaces, face_powers};
pub use film::{FilmPart, FilmSurfaces, FilmValues, LastPiece};
pub use fluid::NewtonianFluid;
pub use form::FluidForm;
pub use geometry::{FluidFields, FluidGeometry};
pub use open_boundary::{OpenBoundary, OpenPoint};
