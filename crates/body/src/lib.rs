//! Bodies, given to fluid, contact and solver by a closed surface that moves.
//!
//! [`Body`] has the data that are constant in time, [`BodyState`] those of one instant, and [`BodyStep`] is one time
//! step: it registers unknowns, adds contributions, and returns the state at the end. [`SurfaceMotion`] describes the
//! surface in that step, [`SurfaceStress`] the traction on it. The smallest implementation is [`PrescribedBody`]; the
//! crates `solid-svk` and `solid-rigid` have the others.
//!
//! This crate uses meshes and algebra. It does not contain equations of fluids or solids.

mod body;
mod output;
mod prescribed;
mod state;
mod step_time;
mod stress;
mod surface;

pub use body::{Body, BodyStep};
pub use output::{Balance, CellOutput, CellStress};
pub use prescribed::PrescribedBody;
pub use state::BodyState;
pub use step_time::StepTime;
pub use stress::{ByDof, SurfaceStress};
pub use surface::{SurfaceMotion, SurfaceVelocity};

use std::sync::Arc;

use mesh::{Point, Vector};

/// A vector at a point.
pub type PointField<const D: usize> = Arc<dyn Fn(&Point<D>) -> Vector<D> + Send + Sync>;
/// A vector at a point and time.
pub type TimeField<const D: usize> = Arc<dyn Fn(&Point<D>, f64) -> Vector<D> + Send + Sync>;
/// A vector at a time.
pub type VectorInTime<const D: usize> = Arc<dyn Fn(f64) -> Vector<D> + Send + Sync>;
/// Velocity of a material point. Arguments: a position and two times. The point has this position at the first time;
/// the velocity is that at the second.
pub type ParticleVelocity<const D: usize> = Arc<dyn Fn(&Point<D>, [f64; 2]) -> Vector<D> + Send + Sync>;
