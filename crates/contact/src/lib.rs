//! Gap, obstacles, contact laws and contact tractions.
//!
//! The surface of a body (the *slave*) must not penetrate an *obstacle*: a rigid one, or the surface of another body
//! (the *master*). At a point `x` of the slave's surface an [`Obstacle`] gives the closest point `Π(x)`, the unit
//! normal `n^w` **into the obstacle** and so the gap `Δ = (Π(x) - x) · n^w`, negative when the point has penetrated. A
//! [`ContactLaw`] maps gap, slip and stress to a traction in the local [`Frame`]. Only the term `terms/contact_work.rs`
//! combines the two. A collision law has no traction but a coefficient of restitution, which the crate `solver`
//! applies.
//!
//! | formula | file |
//! |---|---|
//! | `λ = -(γ_C0/s) [ε - Δ]₊` | `law/penalty.rs` |
//! | `λ = -[γ_C (ε - Δ) - s_n]₊` | `law/nitsche.rs` |
//! | `λ = -[(γ_C0/s) (ε - Δ) - m_n]₊` | `law/augmented_lagrangian.rs` |
//! | `τ = -P(γ g - s_t)` | `law/coulomb.rs` |
//! | `w_n^{n+1} = -e w_n^n` | `law/collision.rs` |
//! | `-(f, w^s - w^m)` | `terms/contact_work.rs` |
//! | closest points and normals | `obstacle/rigid_plane.rs`, `rigid_ball.rs`, `rigid_surface.rs`, `deformable.rs` |
//! | contact of a body with itself | `obstacle/own.rs` |
//! | quadrature points, and their time levels | `sites.rs`, `segments.rs` |
//!
//! Symbols: contact parameters `γ_C0` and `γ_C`, `γ` for `γ_C0/s` or `γ_C`, contact size `s`, offset `ε`, normal and
//! tangential stress `s_n` and `s_t`, multiplier `m_n`, projection `P` onto the disk of friction, slip `g`, relative
//! normal velocity `w_n`, coefficient of restitution `e`, traction `f = λ n^w + τ`, test functions `w^s` and `w^m` of
//! slave and master, `[a]₊ = max(a, 0)`.
//!
//! ```
//! use contact::{ContactLaw, ContactPoint, Obstacle, PenaltyLaw, Positions, RigidPlane};
//! use mesh::{Point, Vector};
//!
//! let ground = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0))?;
//! let x = Point::<2>::new(3.0, 0.04);
//! let gap = ground.project(&x, Positions::Fixed(&[]), &[]).map(|p| p.gap(&x));
//! assert_eq!(gap, Some(0.04));
//!
//! let law = PenaltyLaw::new(1e8, 0.1)?;
//! let traction = law.traction(&ContactPoint { gap: 0.04, size: 0.1, ..ContactPoint::default() });
//! assert!((traction.value[0] + 0.06e9).abs() < 1e-6);
//! # Ok::<(), contact::Error>(())
//! ```

pub mod diagnostics;
pub mod law;
mod near;
pub mod obstacle;
pub mod terms;

mod error;
mod frame;
mod positions;
mod segments;
mod site;
mod sites;

pub use diagnostics::ContactReport;
pub use error::Error;
pub use frame::{Frame, Local};
pub use law::{
    AugmentedLagrangianLaw, CollisionLaw, ContactLaw, ContactPoint, ContactTraction, NitscheLaw, PenaltyLaw,
    StressSource,
};
pub use obstacle::{Anchor, DeformableObstacle, Obstacle, OwnSurface, Projection, RigidBall, RigidPlane, RigidSurface};
pub use positions::Positions;
pub use site::{ContactNode, ContactSite};
pub use sites::{ContactForm, ContactItems, ContactPair, ContactSites, Multipliers, check_pair};
