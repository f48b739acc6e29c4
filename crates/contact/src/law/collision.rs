//! Collisions of bodies that do not deform.

use mesh::{non_negative, require};

use super::{ContactLaw, ContactPoint, ContactTraction};
use crate::Error;

/// `w_n^{n+1} = -e w_n^n`: reversal of the relative normal velocity in one step if the gap is below the roughness
///
/// A collision of stiff bodies is treated as an impulse within one step, whatever the length of the step. The velocity
/// is reversed by the coupled problem of the step, so that the fluid around the body is reversed with it. The law has
/// no traction.
///
/// Source: Newton's law of restitution.
/// Units: the restitution `e` is a number, `w_n` length per time, the roughness a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionLaw {
    restitution: f64,
    roughness: f64,
}

impl CollisionLaw {
    /// Creates the law with the restitution `e` of a collision without fluid, and the roughness: the gap at which the
    /// asperities of the two surfaces touch.
    ///
    /// # Errors
    /// [`Error::Parameter`]: restitution outside of 0 to 1, roughness negative.
    pub fn new(restitution: f64, roughness: f64) -> Result<Self, Error> {
        require((0.0..=1.0).contains(&restitution), "restitution", restitution, "from 0 to 1")?;
        non_negative("roughness", roughness)?;
        Ok(Self { restitution, roughness })
    }
}

impl ContactLaw for CollisionLaw {
    fn traction(&self, _at: &ContactPoint) -> ContactTraction {
        ContactTraction::default()
    }

    fn is_active(&self, at: &ContactPoint) -> bool {
        at.gap < self.roughness
    }

    fn offset(&self) -> f64 {
        self.roughness
    }

    fn restitution(&self) -> Option<f64> {
        Some(self.restitution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_laws_are_refused() {
        assert!(CollisionLaw::new(1.1, 0.1).is_err() && CollisionLaw::new(-0.1, 0.1).is_err());
        assert!(CollisionLaw::new(0.5, -0.1).is_err() && CollisionLaw::new(f64::NAN, 0.1).is_err());
    }
}
