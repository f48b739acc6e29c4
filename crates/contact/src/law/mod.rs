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
    /// Slip over the step along each tangent, a length: displacement of the slave's point relative to its closest
    /// point.
    pub slip: [f64; 2],
    /// Traction `σ n` on the slave's surface, `n` out of the slave, or the multiplier, in the frame of the point, per
    /// area of the surface at the start of the step. Zero if the law does not depend on a stress
    /// ([`ContactLaw::stress`]).
    pub stress: Local,
    /// Stiffness of the slave's cell divided by its height, `(2 μ + λˢ)/h` for linear elements, force per volume. Zero
    /// if the law does not depend on a stress.
    pub stiffness: f64,
    /// Contact size `s`, the length by which penalty laws divide `γ_C0`, constant in a contact
    /// ([`crate::ContactForm::size`]).
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
    pub(crate) fn times(self, factor: f64) -> Self {
        let of = |local: Local| local.map(|value| factor * value);
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
    /// The stress of the slave, which must be a body that deforms, minus the stress of the fluid in front of it.
    /// Without fluid, the stress of the slave.
    Jump,
    /// The traction of the law in the previous solve of the step; zero in the first solve. The step is solved again
    /// until the traction changes by at most [`ContactLaw::accepted_change`]. The slave may be a body without stress.
    Multiplier,
}

/// A contact law. The traction is zero where [`ContactLaw::is_active`] is false. The active set of Newton's method and
/// the reported contact times use the same criterion.
pub trait ContactLaw: Send + Sync + std::fmt::Debug {
    /// Returns the traction at a point.
    fn traction(&self, at: &ContactPoint) -> ContactTraction;

    /// Returns whether there is contact at a point. A point in contact must also be in contact with a smaller gap and
    /// with a smaller normal stress, whatever slip and tangential stress are: points that are not active with the
    /// smallest gap and normal stress that are possible in a step are not evaluated.
    fn is_active(&self, at: &ContactPoint) -> bool;

    /// Returns the contact offset `ε`, a length. Penetration is `ε - Δ`. A law with stress may act at slightly larger
    /// gaps.
    fn offset(&self) -> f64;

    /// Returns the stored energy per area, whose derivative with respect to the gap is the normal traction; `None` for
    /// laws without energy. The energy, and with it the normal traction, depend on the gap only: schemes that conserve
    /// energy use `(W^{n+1} - W^n)/(Δ^{n+1} - Δ^n)` with its derivative by the gap.
    fn energy_density(&self, _at: &ContactPoint) -> Option<f64> {
        None
    }

    /// Returns the coefficient of restitution of collisions, from 0 to 1, for bodies that do not deform; `None` for
    /// laws that act by their traction.
    ///
    /// If [`ContactLaw::is_active`] holds at the start of a step, the relative normal velocity at its end is minus the
    /// coefficient times that at its start.
    fn restitution(&self) -> Option<f64> {
        None
    }

    /// Returns the stress that [`ContactPoint::stress`] holds.
    fn stress(&self) -> StressSource {
        StressSource::None
    }

    /// Returns the largest change of the traction since the previous solve with which the step is not solved again, a
    /// force per area. `largest_traction` is the maximum over all points. Only used for [`StressSource::Multiplier`].
    fn accepted_change(&self, _largest_traction: f64) -> f64 {
        0.0
    }
}
