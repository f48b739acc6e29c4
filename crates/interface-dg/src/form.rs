//! The mortaring form.

use algebra::Integral;
use fluid_ns::NewtonianFluid;

use crate::InterfacePoints;
use crate::terms::{AdjointConsistency, Consistency, Penalty};

/// The three mortaring terms.
pub struct MortarForm {
    /// `-(T^f(u, p) n^f, v - w)`.
    pub consistency: Consistency,
    /// `-(u - v_s, T^f(v, -q) n^f)`.
    pub adjoint_consistency: AdjointConsistency,
    /// `γ_Σ μ^f/h_K (u - v_s, v - w)`.
    pub penalty: Penalty,
}

impl MortarForm {
    /// Creates the form of a fluid, with the penalty parameter `γ_Σ`.
    pub fn new(fluid: NewtonianFluid, gamma_sigma: f64) -> Self {
        Self {
            consistency: Consistency { fluid },
            adjoint_consistency: AdjointConsistency { fluid },
            penalty: Penalty { gamma_sigma, viscosity: fluid.viscosity },
        }
    }

    /// Returns the weak form on the interface. It is linear: the geometry is frozen and the traction is that of the
    /// fluid.
    pub fn contributions<'p, const D: usize>(
        &'p self,
        points: InterfacePoints<'p, D>,
    ) -> Integral<'p, InterfacePoints<'p, D>> {
        Integral::linear("interface", points, vec![&self.consistency, &self.adjoint_consistency, &self.penalty])
    }
}
