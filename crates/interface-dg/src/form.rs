//! The mortaring form.

use algebra::{Integral, Sites};
use fluid_ns::NewtonianFluid;

use crate::terms::{AdjointConsistency, Consistency, FilmEnd, Penalty, PenaltyProfile};
use crate::{InterfacePoints, MeanSlips};

/// The mortaring terms: the three of Eq. (4); in films also [`FilmEnd`] and the penalty on the mean slip
/// ([`MeanSlips`]).
pub struct MortarForm {
    /// `-(T n^f, v - w)`.
    pub consistency: Consistency,
    /// `-(u - v_s, T(v, -q; w) n^f)`.
    pub adjoint_consistency: AdjointConsistency,
    /// `(S (u - v_s), v - w)`.
    pub penalty: Penalty,
}

impl MortarForm {
    /// Creates the form of a fluid. `rate` is the derivative of the acceleration with respect to the velocity, 1/time;
    /// zero for a steady problem.
    pub fn new(fluid: NewtonianFluid, profile: PenaltyProfile, rate: f64) -> Self {
        Self {
            consistency: Consistency { fluid },
            adjoint_consistency: AdjointConsistency { fluid },
            penalty: Penalty { profile, fluid, rate, convection: 1.0 / 6.0, inertia: 1.0 / 12.0 },
        }
    }

    /// Returns the weak form on the interface. For `α = 1` it is linear, because the geometry is constant in the step.
    pub fn contributions<'p, const D: usize>(
        &'p self,
        points: InterfacePoints<'p, D>,
    ) -> Integral<'p, InterfacePoints<'p, D>> {
        let integral = if points.solid.is_none() { Integral::linear } else { Integral::new };
        integral("interface", points, vec![&self.consistency, &self.adjoint_consistency, &self.penalty, &FilmEnd])
    }

    /// Returns the weak form of the mean slip on surfaces along films; `None` if there are none.
    pub fn in_films<'p, const D: usize>(
        &'p self,
        points: InterfacePoints<'p, D>,
    ) -> Option<Integral<'p, MeanSlips<'p, D>>> {
        let slips = MeanSlips(points);
        (!slips.is_empty()).then(|| Integral::linear("slip in films", slips, vec![&self.penalty]))
    }
}
