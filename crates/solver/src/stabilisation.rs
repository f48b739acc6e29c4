//! Sets of stabilisation parameters.

use fluid_ns::terms::CipProfile;
use interface_dg::terms::PenaltyProfile;

/// Parameters of the discrete problem that the equations do not have. One set is used for all problems: no parameter
/// depends on the case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stabilisation {
    /// Penalty on the velocity jump at the interface.
    pub penalty: PenaltyProfile,
    /// Interior penalty of the velocity.
    pub cip: CipProfile,
    /// `γ_p` of the interior penalty of the pressure.
    pub gamma_pressure: f64,
    /// `γ_g` of the ghost penalty.
    pub gamma_ghost: f64,
    /// Time `T` of the rate `1/T` in the weight of the pressure's interior penalty; `None`: the rate of the time
    /// scheme. Then the weight, and so the error of the mesh, depends on the step; a study of the step needs a `T`.
    pub time: Option<f64>,
}

impl Stabilisation {
    /// The standard set.
    ///
    /// - `γ_n = γ_t = 35`: above 10, from which on the mortar is coercive for P1 on every cut, and below 100, above
    ///   which cut cells move with the body (locking).
    /// - `γ_u = γ_p = 0.05`, `γ_g = 0.1`: sizes in use for P1 with the interior penalties that vanish under refinement.
    ///   They are those of the comparison with an independent code on the same meshes (`benchmarks/RESULTS.md`).
    pub const STANDARD: Self = Self {
        penalty: PenaltyProfile::Split { gamma_normal: 35.0, gamma_tangential: 35.0 },
        cip: CipProfile::Consistent { gamma_u: 0.05 },
        gamma_pressure: 0.05,
        gamma_ghost: 0.1,
        time: None,
    };

    /// The set that reproduces the results of MOX-Report 44/2019: a calibration. `γ_Σ = 1e5` is the paper's; the
    /// interior penalty of the velocity, which the paper does not state, is fitted to its results.
    pub const PAPER_44_2019: Self = Self {
        penalty: PenaltyProfile::Uniform { gamma_sigma: 1e5 },
        cip: CipProfile::Paper { gamma_1: 0.7 },
        gamma_pressure: 0.1,
        gamma_ghost: 1.0,
        time: None,
    };
}
