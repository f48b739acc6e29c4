//! Gap, obstacles, contact laws and contact tractions.
//!
//! The surface of a body (the *slave*) keeps away from an *obstacle*: a rigid one, or the surface of another body
//! (the *master*). At a point `x` of the slave's surface an [`Obstacle`] gives the closest point `Π(x)`, the unit
//! normal `n^w` **into the obstacle** and so the gap `Δ = (Π(x) - x) · n^w`, negative when the point has penetrated;
//! a [`ContactLaw`] turns the gap into the normal traction `λ ≤ 0`. The two meet only in the term
//! `terms/normal_traction.rs`.
//!
//! | formula | file |
//! |---|---|
//! | `λ = -(γ_C0/s) [ε - Δ]₊` | `law/penalty.rs` |
//! | `(-λ n^w, w^s)` on a rigid obstacle | `terms/normal_traction.rs`, `obstacle/rigid_plane.rs` |
//! | `(-λ n^w, w^s - w^m)` between two bodies | `terms/normal_traction.rs`, `obstacle/deformable.rs`, `segments.rs` |
//!
//! Unknowns are the velocities of the bodies at the end of the step, with positions `x = x_pred + c_d v`; component
//! `a` of vertex `i` is dof `D i + a` of the body's field.
//!
//! ```
//! use contact::{ContactLaw, ContactPoint, Obstacle, Penalty, RigidPlane, Motion};
//! use mesh::{Point, Vector};
//!
//! let ground = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0))?;
//! let x = Point::<2>::new(3.0, 0.04);
//! let gap = ground.project(&x, Motion::frozen(&[]), &[]).map(|p| p.gap(&x));
//! assert_eq!(gap, Some(0.04));
//!
//! let law = Penalty::new(1e8, 0.1)?;
//! let traction = law.traction(ContactPoint { gap: 0.04, element_size: 0.1, normal_stress: 0.0 });
//! assert!((traction.value + 0.06e9).abs() < 1e-6);
//! # Ok::<(), contact::Error>(())
//! ```

pub mod diagnostics;
pub mod law;
pub mod obstacle;
pub mod terms;

mod body;
mod error;
mod form;
mod segments;
mod site;

pub use body::{ContactBody, Motion};
pub use diagnostics::ContactReport;
pub use error::Error;
pub use form::{ContactFacets, ContactForm, ContactPair};
pub use law::{ContactLaw, ContactPoint, ContactTraction, Penalty};
pub use obstacle::{Anchor, Candidates, DeformableObstacle, Obstacle, Projection, RigidPlane};
pub use site::ContactSite;

pub use algebra;
pub use mesh;
