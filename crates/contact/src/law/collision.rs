//! Collisions of bodies that do not deform.

use mesh::{non_negative, require};

use super::{ContactLaw, ContactPoint, ContactTraction};
use crate::Error;

/// Reversal of the velocity of approach in one step, where the gap is below the roughness: `w_n^{n+1} = -e w_n^n`
///
/// A collision of stiff bodies lasts for microseconds, far less than a step. The step in which it happens solves for bodies and fluid together, so that
/// the velocity of the fluid around the body is reversed with it. The law has no traction of its own.
/// Units: the restitution `e` is a number, the roughness a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionLaw {
    restitution: f64,
    roughness: f64,
}

impl CollisionLaw {
    /// Creates the law with the restitution `e` of a collision without fluid, and the gap at which the asperities of the two surfaces touch.
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
