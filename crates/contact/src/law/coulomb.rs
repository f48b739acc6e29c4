//! Signorini's condition and Coulomb friction, as projections of a stress.

use super::{ContactPoint, ContactTraction};

/// `λ = -[γ (ε - Δ) - s_n]₊` and `τ = -P(γ g - s_t)` with the projection `P` onto the disk of radius `-μ_f λ`
///
/// Both are equivalent to Signorini's and Coulomb's conditions if `s` is the traction itself: the stress of the slave
/// in Nitsche's method, a multiplier in the augmented Lagrangian. With a multiplier the radius is `μ_f [-s_n]₊`, the
/// value of the previous solve, so that the disk is fixed during a solve. A point that leaves contact has no friction.
///
/// Source: Alart and Curnier 1991, doi:10.1016/0045-7825(91)90022-X.
pub(super) struct Coulomb {
    /// `γ`, force per volume.
    pub(super) stiffness: f64,
    /// `ε`, a length.
    pub(super) offset: f64,
    /// `μ_f`.
    pub(super) friction: f64,
    /// Whether the radius of the disk is computed with `s_n` instead of `λ`.
    pub(super) is_lagged: bool,
}

impl Coulomb {
    /// Returns `γ (ε - Δ) - s_n`, which is positive in contact.
    #[inline]
    pub(super) fn pressing(&self, at: &ContactPoint) -> f64 {
        self.stiffness * (self.offset - at.gap) - at.stress[0]
    }

    /// Returns the traction and its derivatives.
    #[inline]
    pub(super) fn traction(&self, at: &ContactPoint) -> ContactTraction {
        let pressing = self.pressing(at);
        let mut traction = ContactTraction::default();
        if pressing > 0.0 {
            traction.value[0] = -pressing;
            traction.by_gap[0] = self.stiffness;
            traction.by_stress[0][0] = 1.0;
            if self.friction > 0.0 {
                self.add_friction(at, &mut traction);
            }
        }
        traction
    }

    /// Adds the tangential traction and its derivatives to a normal traction.
    fn add_friction(&self, at: &ContactPoint, traction: &mut ContactTraction) {
        let trial = [1, 2].map(|k| self.stiffness * at.slip[k - 1] - at.stress[k]);
        let pressure = if self.is_lagged { (-at.stress[0]).max(0.0) } else { -traction.value[0] };
        let (norm, limit) = (trial[0].hypot(trial[1]), self.friction * pressure);
        if limit <= 0.0 {
            return;
        }
        let sticks = norm <= limit;
        let direction = trial.map(|component| if sticks { 0.0 } else { component / norm });
        for (row, k) in [1, 2].into_iter().enumerate() {
            traction.value[k] = if sticks { -trial[row] } else { -limit * direction[row] };
            // A lagged radius does not depend on the gap.
            traction.by_gap[k] = if self.is_lagged { 0.0 } else { self.friction * direction[row] * traction.by_gap[0] };
            traction.by_stress[0][k] = self.friction * direction[row];
            for (column, l) in [1, 2].into_iter().enumerate() {
                let same = f64::from(u8::from(row == column));
                let by_trial = if sticks { -same } else { -limit / norm * (same - direction[row] * direction[column]) };
                traction.by_slip[column][k] = self.stiffness * by_trial;
                traction.by_stress[l][k] = -by_trial;
            }
        }
    }
}
