//! Contact laws: traction as a function of gap, slip and stress, in the frame of the contact point.

mod augmented_lagrangian;
mod check;
mod collision;
mod coulomb;
mod discrete_gradient;
mod nitsche;
mod penalty;

pub use augmented_lagrangian::AugmentedLagrangianLaw;
pub use check::{LawCheck, check_law};
pub use collision::CollisionLaw;
pub(crate) use discrete_gradient::discrete_gradient;
pub use nitsche::NitscheLaw;
pub use penalty::PenaltyLaw;

use crate::Local;

/// The state on which a law may depend, at one point of the slave's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Gap `Δ`, negative when the point has penetrated; a length.
    pub gap: f64,
    /// Slip over the step along each tangent: displacement of the slave's point relative to its closest point; a length.
    pub slip: [f64; 2],
    /// Traction `σ n` on the slave's surface in the frame, or the multiplier, force per area of the surface at the start of
    /// the step. Zero if the law does not depend on a stress ([`ContactLaw::stress`]).
    pub stress: Local,
    /// Stiffness of the slave's cell divided by its height, `(2 μ + λˢ)/h` for linear elements, force per volume. Zero
    /// if the law does not depend on a stress.
    pub stiffness: f64,
    /// Contact size `s`, a length.
    pub size: f64,
}

/// Traction on the slave in the frame, force per area, and its derivatives.
///
/// The first component is `λ ≤ 0` along `n^w`, which points into the obstacle; the others are friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactTraction {
    /// The traction.
    pub value: Local,
    /// Derivative with respect to the gap.
    pub by_gap: Local,
    /// Derivatives with respect to each component of the slip.
    pub by_slip: [Local; 2],
    /// Derivatives with respect to each component of the stress.
    pub by_stress: [Local; 3],
}

impl ContactTraction {
    /// Returns the traction and its derivatives multiplied by a factor.
    pub(crate) fn times(self, part: f64) -> Self {
        let of = |local: Local| local.map(|value| part * value);
        let Self { value, by_gap, by_slip, by_stress } = self;
        Self { value: of(value), by_gap: of(by_gap), by_slip: by_slip.map(of), by_stress: by_stress.map(of) }
    }
}

/// The stress on which a law depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StressSource {
    /// The law does not depend on a stress.
    #[default]
    None,
    /// The stress of the slave, which must be a body that deforms.
    Solid,
    /// The stress of the fluid in front of the slave. Where no fluid borders the surface, it is a pressure that is
    /// continued from the nearest point with fluid.
    Fluid,
    /// The stress of the slave, which must be a body that deforms, minus that of the fluid in front of it. Without a
    /// fluid it is the stress of the slave.
    Jump,
    /// The traction of the law in the previous solve of the step, zero in the first one. The step is solved again until it no longer
    /// changes ([`ContactLaw::accepted_change`]). Slaves need no stress.
    Multiplier,
}

/// A contact law. One criterion, [`ContactLaw::is_active`], serves force, active set and reported contact times.
pub trait ContactLaw: Send + Sync + std::fmt::Debug {
    /// Returns the traction at a point.
    fn traction(&self, at: &ContactPoint) -> ContactTraction;

    /// Returns whether there is contact at a point; the traction is zero otherwise.
    fn is_active(&self, at: &ContactPoint) -> bool;

    /// Returns the distance `ε` from which obstacles are searched and penetration is measured. A law with stress may be
    /// active slightly beyond it.
    fn offset(&self) -> f64;

    /// Returns the stored energy per area, whose derivative with respect to the gap is the normal traction; `None` for
    /// laws without energy.
    fn energy_density(&self, _at: &ContactPoint) -> Option<f64> {
        None
    }

    /// Returns the restitution of collisions, from 0 to 1, for bodies that do not deform; `None` for laws that act by
    /// their traction.
    ///
    /// The velocity of approach is reversed in a step at whose start [`ContactLaw::is_active`] holds.
    fn restitution(&self) -> Option<f64> {
        None
    }

    /// Returns the stress that [`ContactPoint::stress`] holds.
    fn stress(&self) -> StressSource {
        StressSource::None
    }

    /// Returns the largest change of the traction from one solve of a step to the next after which the step is not solved
    /// again, given the largest traction of the contact, both force per area; only for laws with [`StressSource::Multiplier`].
    fn accepted_change(&self, _largest: f64) -> f64 {
        0.0
    }
}
