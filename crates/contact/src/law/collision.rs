//! Collisions of bodies that do not deform in the computation.

use std::f64::consts::PI;

use mesh::{non_negative, positive, require};

use super::{ContactLaw, ContactPoint, ContactTraction};
use crate::Error;

/// `F = k D^(3/2) + c √(m k) D^(1/4) Ḋ` with `k = 4/3 E* √R`: the force of Hertz at the closest points of two bodies that are stiff, with a damping
///
/// `D` is the depth by which the gap is below the roughness. The two bodies do not deform; the depth stands for their deformation. There is no attraction. Over a collision the damping
/// leaves about the part `e` of the speed, for every speed and mass: `c = -√5 ln e/√(π² + ln² e)`.
///
/// A collision takes the time `2.94 D_max/v` with `D_max = (15 m v²/(16 E* √R))^(2/5)`, which steps have to resolve: within it the flow around the bodies turns.
/// The law has no traction on a surface.
/// Source: Hertz 1882; damping: Tsuji, Tanaka, Ishida 1992, doi:10.1016/0032-5910(92)88030-L, whose constant is the closed form of Antypov and Elliott 2011,
/// doi:10.1209/0295-5075/94/50004.
/// Units: `E*` force per area, `R` and the roughness lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionLaw {
    stiffness: f64,
    damping: f64,
    roughness: f64,
}

impl CollisionLaw {
    /// Creates the law with the effective modulus `E*` of the two materials, `1/E* = Σ (1 - ν²)/E`, the radius `R` of the surfaces where they touch, `1/R = Σ 1/R_k`,
    /// the restitution `e` of a collision without fluid, and the gap at which the asperities of the two surfaces touch.
    ///
    /// # Errors
    /// [`Error::Parameter`]: modulus or radius not positive, restitution not above 0 and at most 1, roughness negative.
    pub fn new(modulus: f64, radius: f64, restitution: f64, roughness: f64) -> Result<Self, Error> {
        positive("modulus", modulus)?;
        positive("radius", radius)?;
        require(restitution > 0.0 && restitution <= 1.0, "restitution", restitution, "above 0 and at most 1")?;
        non_negative("roughness", roughness)?;
        let log = restitution.ln();
        let damping = -5.0_f64.sqrt() * log / (PI * PI + log * log).sqrt();
        Ok(Self { stiffness: 4.0 / 3.0 * modulus * radius.sqrt(), damping, roughness })
    }

    /// Returns the force that pushes the bodies apart, which is never an attraction, and its derivatives by the gap at the end of a step and by the speed of
    /// approach. `gaps` are those at start and end; the damping has the depth at the start, because its derivative has no bound at first contact. `mass` is the
    /// reduced mass of the bodies.
    pub fn force(&self, gaps: [f64; 2], approach: f64, mass: f64) -> [f64; 3] {
        let [begin, depth] = gaps.map(|gap| (self.roughness - gap).max(0.0));
        let viscous = self.damping * (mass * self.stiffness).sqrt() * begin.sqrt().sqrt();
        let force = self.stiffness * depth * depth.sqrt() + viscous * approach;
        if depth <= 0.0 || force <= 0.0 {
            return [0.0; 3];
        }
        [force, -1.5 * self.stiffness * depth.sqrt(), viscous]
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

    fn collision(&self) -> Option<&CollisionLaw> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_collision_has_the_depth_and_the_time_of_hertz_and_its_restitution() {
        let (modulus, radius, mass, speed) = (5.5e10, 1.5e-3, 1.1e-4, 0.54);
        let depth = (15.0 * mass * speed * speed / (16.0 * modulus * f64::sqrt(radius))).powf(0.4);
        for (restitution, mass) in [(1.0, mass), (0.97, mass), (0.5, mass), (0.5, 20.0 * mass)] {
            let law = CollisionLaw::new(modulus, radius, restitution, 1e-7).expect("a law");
            let (mut gap, mut approach, mut time, mut deepest) = (1e-7, speed, 0.0, 0.0_f64);
            let dt = 1e-10;
            while approach > 0.0 || gap < 1e-7 {
                approach -= dt * law.force([gap; 2], approach, mass)[0] / mass;
                gap -= dt * approach;
                time += dt;
                deepest = deepest.max(1e-7 - gap);
            }
            // The constant is that of a damping that attracts at the end.
            assert!(
                (-approach / speed - restitution).abs() < 0.1 * (1.0 - restitution) + 1e-3,
                "{restitution}: {}",
                -approach / speed
            );
            if restitution == 1.0 {
                assert!((deepest / depth - 1.0).abs() < 1e-3 && (time / (2.943 * depth / speed) - 1.0).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_force() {
        let law = CollisionLaw::new(3.0, 2.0, 0.8, 0.1).expect("a law");
        for (begin, gap, approach) in [(0.06, 0.05, 0.3), (-0.1, -0.2, -0.4), (0.3, 0.2, 1.0), (0.0, 0.09, -9.0)] {
            let ([force, by_gap, by_approach], step) = (law.force([begin, gap], approach, 2.0), 1e-6);
            let slope = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]) / (2.0 * step);
            let at = |gap: f64, approach: f64| law.force([begin, gap], approach, 2.0);
            let of_gap = slope(at(gap + step, approach), at(gap - step, approach));
            let of_approach = slope(at(gap, approach + step), at(gap, approach - step));
            assert!((of_gap - by_gap).abs() < 1e-7 && (of_approach - by_approach).abs() < 1e-7 && force >= 0.0);
        }
    }

    #[test]
    fn impossible_laws_are_refused() {
        let law = |modulus, radius, restitution, roughness| CollisionLaw::new(modulus, radius, restitution, roughness);
        assert!(law(0.0, 1.0, 0.9, 0.1).is_err() && law(1.0, 0.0, 0.9, 0.1).is_err());
        assert!(law(1.0, 1.0, 1.1, 0.1).is_err() && law(1.0, 1.0, 0.0, 0.1).is_err());
        assert!(law(1.0, 1.0, 0.9, -0.1).is_err() && law(1.0, 1.0, f64::NAN, 0.1).is_err());
    }
}
