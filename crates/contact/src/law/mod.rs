//! Contact laws: normal traction as a function of the gap.

mod check;
mod penalty;

pub use check::{LawCheck, check_law};
pub use penalty::Penalty;

/// What a law may depend on, at one point of the slave's surface.
///
/// Units: cm, cm, dyn/cm².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Gap `Δ`, negative when the point has penetrated.
    pub gap: f64,
    /// Contact size `s` of the scenario.
    pub element_size: f64,
    /// Normal stress of the slave; for consistent laws (paper, Remark 1). The forms here pass zero.
    pub normal_stress: f64,
}

/// Normal traction and its derivatives.
///
/// Units: dyn/cm², dyn/cm³, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactTraction {
    /// `λ ≤ 0`; the force on the slave is `λ n^w`, away from the obstacle.
    pub value: f64,
    /// Derivative with respect to the gap, not negative.
    pub d_gap: f64,
    /// Derivative with respect to the normal stress.
    pub d_normal_stress: f64,
}

/// A frictionless contact law. One criterion, [`ContactLaw::is_active`], serves force, active set and reported
/// contact times.
pub trait ContactLaw: Send + Sync + std::fmt::Debug {
    /// Normal traction at a point.
    fn traction(&self, at: ContactPoint) -> ContactTraction;

    /// Whether there is contact at a point.
    fn is_active(&self, at: ContactPoint) -> bool;

    /// Distance `ε` that the law keeps between slave and obstacle.
    fn offset(&self) -> f64;

    /// Energy per area that contact has stored, whose derivative with respect to the gap is the traction; zero for
    /// laws that store none.
    ///
    /// Units: erg/cm².
    fn energy_density(&self, at: ContactPoint) -> f64;
}
