//! Penalty on the velocity jump.

use algebra::{LocalSystem, Term};
use fluid_ns::NewtonianFluid;
use mesh::Tensor;

use crate::{MeanSlip, MortarPoint};

/// Scaling of the penalty with viscosity, inertia and size of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenaltyProfile {
    /// `σ_n = σ_t = γ_Σ μ/h_K`, as in the paper.
    Uniform {
        /// `γ_Σ`.
        gamma_sigma: f64,
    },
    /// `σ_n = γ_n (μ/h_K + ρ |u* - v^n|/6 + ρ h_K s/12)` and `σ_t = γ_t μ/h_K` with the rate `s`, `1/Δt` with implicit
    /// Euler. If the accelerations `a*` of the fluid and `b^n` of the body are known, `ρ √(h_K |a* - b^n|)/6` replaces
    /// the last share.
    ///
    /// The three shares of `σ_n` represent viscosity, convection and inertia in a cell. Without inertia the surface
    /// leaks. The share with the rate grows as steps become shorter, and then forces the fluid of cut cells to move
    /// with the body: it acts in the first step, and after a collision. The share with the acceleration, the speed that
    /// is gained over a cell, does not depend on the step. `σ_t` has no inertia: it would force the fluid of a cut cell
    /// to move along with the body, which is a boundary layer as thick as the cell.
    Split {
        /// `γ_n`.
        gamma_normal: f64,
        /// `γ_t`.
        gamma_tangential: f64,
    },
}

impl PenaltyProfile {
    /// Returns the share `3/γ_t` of the flux along a film that passes because the velocity slips on one of its two
    /// surfaces, if the viscous length is the thickness of the film. See [`fluid_ns::FilmValues::subtract_slip`].
    pub fn slip_share(&self) -> f64 {
        match self {
            Self::Uniform { gamma_sigma: gamma } | Self::Split { gamma_tangential: gamma, .. } => 3.0 / gamma,
        }
    }
}

/// `(S (u - v_s), v - w)_Σ` with `S = σ_t I + (σ_n - σ_t) n ⊗ n` and the scaling of [`PenaltyProfile`]
///
/// Source: paper, Eq. (4), for `σ_n = σ_t`; shares of `σ_n` as in the Nitsche terms of Winter, Schott, Massing, Wall
/// 2018, arXiv 1706.05897.
/// Couples: velocity and solid × velocity and solid.   Domain: interface pieces of the step.
/// Units: force (2D: per unit depth).
/// `h_K` is the size of the background cell. In films a length of at most this size,
/// [`crate::PieceValues::viscous_length`], replaces `h_K` in `γ μ/h_K`.
/// `|u* - v^n|` is the largest relative speed on the piece, at the start of the step or extrapolated to its stage.
/// `|a* - b^n|` is the largest relative acceleration of particles at the start.
/// In films the tangential slip `P (u - v_s)`, `P = I - n ⊗ n`, is divided into its mean `m` over a side of the body in
/// a fluid part, with the penalty `σ_t`, and the rest, with the smaller `σ_f = 1/(1/σ_t + χ d/μ)`. `χ d` is
/// [`MeanSlip::thickness`]. The sum is `(S_f (u - v_s), v - w)_Σ` on pieces, with `σ_f` in place of `σ_t`, plus, on the
/// side, `(σ_t - σ_f) m · m(v - w) |Σ|` ([`MeanSlip`]). See docs/adr/0044-mean-slip-in-films.md.
pub struct Penalty {
    /// The scaling.
    pub profile: PenaltyProfile,
    /// Density and viscosity.
    pub fluid: NewtonianFluid,
    /// The rate `s`: derivative of the acceleration with respect to the velocity; zero for a steady problem.
    pub rate: f64,
    /// Factor 1/6 of the speeds `|u* - v^n|` and `√(h_K |a* - b^n|)` in `σ_n/(γ_n ρ)`.
    pub convection: f64,
    /// Factor 1/12 of `h_K s` in `σ_n/(γ_n ρ)`.
    pub inertia: f64,
}

impl Penalty {
    /// Returns `σ_n` and `σ_t` on a piece with a cell size, a viscous length ([`crate::PieceValues::viscous_length`]),
    /// a relative speed and a relative acceleration; `None` if accelerations are not known.
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

    /// Returns `σ_f`, with the penalty and the layer of a film as springs in series.
    fn in_layer(&self, tangential: f64, film_thickness: f64) -> f64 {
        if film_thickness > 0.0 { 1.0 / (1.0 / tangential + film_thickness / self.fluid.viscosity) } else { tangential }
    }

    /// Returns `S_f` times the weight of the point.
    pub(crate) fn weighted<const D: usize>(&self, q: &MortarPoint<'_, D>) -> Tensor<D> {
        let [normal, tangential] =
            self.eigenvalues([q.cell_size, q.viscous_length], q.relative_speed, q.relative_acceleration);
        let tangential = self.in_layer(tangential, q.film_thickness);
        let n = &q.piece.normal;
        let weight = q.at.weight;
        Tensor::from_diagonal_element(weight * tangential) + n * n.transpose() * (weight * (normal - tangential))
    }

    /// Returns `σ_t - σ_f`. The tangential eigenvalue depends on the viscous length only.
    pub(crate) fn of_mean<const D: usize>(&self, slip: &MeanSlip<D>) -> f64 {
        let [_, tangential] = self.eigenvalues([slip.viscous_length; 2], 0.0, None);
        tangential - self.in_layer(tangential, slip.thickness)
    }
}

impl<const D: usize> Term<MortarPoint<'_, D>> for Penalty {
    fn add(&self, q: &MortarPoint<'_, D>, out: &mut LocalSystem) {
        let weighted = self.weighted(q);
        for (row, test) in q.jump_basis() {
            let tested = weighted * test;
            out.add_vector::<D>(row, tested * q.jump);
            if !out.has_tangent() {
                continue;
            }
            for (column, trial) in q.jump_basis() {
                out.add_block::<D, D>(row, column, tested * trial);
            }
        }
    }
}

impl<const D: usize> Term<MeanSlip<D>> for Penalty {
    fn add(&self, slip: &MeanSlip<D>, out: &mut LocalSystem) {
        let weight = slip.weight * self.of_mean(slip);
        for (row, test) in slip.derivatives.iter().enumerate() {
            out.add(row, weight * test.dot(&slip.value));
            if !out.has_tangent() {
                continue;
            }
            for (column, trial) in slip.derivatives.iter().enumerate() {
                out.add_tangent(row, column, weight * test.dot(trial));
            }
        }
    }
}
