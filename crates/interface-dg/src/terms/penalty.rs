//! Penalty on the velocity jump.

use algebra::{LocalSystem, Term};
use fluid_ns::NewtonianFluid;
use mesh::Tensor;

use crate::MortarPoint;

/// Scaling of the penalty with viscosity, inertia and size of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenaltyProfile {
    /// `σ_n = σ_t = γ_Σ μ/h_K`, as in the paper.
    Uniform {
        /// `γ_Σ`.
        gamma_sigma: f64,
    },
    /// `σ_n = γ_n (μ/h_K + ρ |u* - v^n|/6 + ρ h_K/(12 θ Δt))` and `σ_t = γ_t μ/h_K`; where the accelerations `a*` of the fluid and
    /// `b^n` of the body are known, `ρ √(h_K |a* - b^n|)/6` in place of the last share.
    ///
    /// The three shares of `σ_n` are those of viscosity, convection and inertia in a cell. Without inertia the surface
    /// leaks. With the length of the step in `σ_n` the normal part holds the fluid of cut cells to the body as steps become
    /// shorter; the speed that is gained over a cell does not depend on the step. With inertia in `σ_t` the fluid of a cut cell would be held to the body over the height of
    /// the cell, which is a boundary layer of the mesh.
    Split {
        /// `γ_n`.
        gamma_normal: f64,
        /// `γ_t`.
        gamma_tangential: f64,
    },
}

impl PenaltyProfile {
    /// Returns the share `3/γ_t` of the flux of a film between two surfaces that passes because the velocity slips on one of them.
    ///
    /// A pressure gradient `G` along a film of thickness `δ` in one layer of cells loads each surface with `G δ/2`. With the penalty `γ_t μ/δ` the
    /// velocity slips by `G δ²/(2 γ_t μ)`; half of it is the mean over the film, and the mean velocity of the parabola is `G δ²/(12 μ)`.
    pub fn slip_share(&self) -> f64 {
        match self {
            Self::Uniform { gamma_sigma: gamma } | Self::Split { gamma_tangential: gamma, .. } => 3.0 / gamma,
        }
    }
}

/// `(S (u - v_s), v - w)_Σ` with `S = σ_t I + (σ_n - σ_t) n ⊗ n` and the scaling of [`PenaltyProfile`]
///
/// Source: paper, Eq. (4), for `σ_n = σ_t`; shares of `σ_n` as in the Nitsche terms of Winter, Schott, Massing, Wall 2018,
/// arXiv 1706.05897.
/// Couples: velocity and solid × velocity and solid.   Domain: interface pieces of the step.
/// Units: force (2D: per unit depth).
/// `h_K` is the size of the background cell, `|u* - v^n|` the largest relative speed on the piece, at the start of the step or extrapolated
/// to its stage, and `|a* - b^n|` the largest relative acceleration of particles at the start.
pub struct Penalty {
    /// The scaling.
    pub profile: PenaltyProfile,
    /// Density and viscosity.
    pub fluid: NewtonianFluid,
    /// `1/(θ Δt)`: derivative of the acceleration with respect to the velocity; zero for a steady problem.
    pub rate: f64,
    /// Share of speeds in `σ_n`, 1/6.
    pub convection: f64,
    /// Share of the length of the step in `σ_n`, 1/12.
    pub inertia: f64,
}

impl Penalty {
    /// Returns `σ_n` and `σ_t` on a piece, by the size of its cell, the length over which the velocity can change, the relative speed and the relative
    /// acceleration.
    pub(crate) fn eigenvalues(
        &self,
        [cell_size, viscous_length]: [f64; 2],
        speed: f64,
        acceleration: Option<f64>,
    ) -> [f64; 2] {
        let NewtonianFluid { density, viscosity } = self.fluid;
        match self.profile {
            PenaltyProfile::Uniform { gamma_sigma } => [gamma_sigma * viscosity / viscous_length; 2],
            PenaltyProfile::Split { gamma_normal, gamma_tangential } => {
                let viscous = viscosity / viscous_length;
                let gained = match acceleration {
                    Some(acceleration) => self.convection * (cell_size * acceleration).sqrt(),
                    None => self.inertia * cell_size * self.rate,
                };
                let inertial = density * (self.convection * speed + gained);
                [gamma_normal * (viscous + inertial), gamma_tangential * viscous]
            }
        }
    }

    /// Returns `S` times the weight of the point.
    pub(crate) fn weighted<const D: usize>(&self, q: &MortarPoint<'_, D>) -> Tensor<D> {
        let [normal, tangential] =
            self.eigenvalues([q.cell_size, q.viscous_length], q.relative_speed, q.relative_acceleration);
        let n = &q.piece.normal;
        let weight = q.at.weight;
        Tensor::from_diagonal_element(weight * tangential) + n * n.transpose() * (weight * (normal - tangential))
    }
}

impl<const D: usize> Term<MortarPoint<'_, D>> for Penalty {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let weighted = self.weighted(q);
        for (row, test) in q.jump_basis() {
            let tested = weighted * test;
            out.add_vector::<D>(row, tested * q.jump);
            for (column, trial) in q.jump_basis() {
                out.add_block::<D, D>(row, column, tested * trial);
            }
        }
    }
}
