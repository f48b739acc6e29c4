//! How displacement and acceleration in a step follow from the velocity at its end.

use mesh::Vector;

use crate::Error;
use crate::error::{length, positive};
use crate::time_scheme::GeneralisedAlpha;

/// A vector at each vertex that is affine in the velocity `v` of the vertex at the end of the step: `q = q_pred + c v`.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineInVelocity<const D: usize> {
    slope: f64,
    predicted: Vec<Vector<D>>,
}

impl<const D: usize> AffineInVelocity<D> {
    /// `c`: derivative with respect to velocity.
    #[inline]
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// `q_pred`: values at zero velocity, one per vertex.
    #[inline]
    pub fn predicted(&self) -> &[Vector<D>] {
        &self.predicted
    }

    /// `q_pred + c v` at a vertex.
    #[inline]
    pub fn at(&self, vertex: usize, velocity: &Vector<D>) -> Vector<D> {
        self.predicted[vertex] + self.slope * velocity
    }

    /// Values at all vertices.
    ///
    /// # Errors
    /// [`Error::Length`]: not one velocity per vertex.
    pub fn values(&self, velocity: &[Vector<D>]) -> Result<Vec<Vector<D>>, Error> {
        length("velocity", velocity.len(), self.predicted.len())?;
        Ok(velocity.iter().enumerate().map(|(i, v)| self.at(i, v)).collect())
    }
}

/// Displacement and acceleration of a body, both affine in the velocity at the end of the step.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics<const D: usize> {
    /// `d = d_pred + c_d v`.
    pub displacement: AffineInVelocity<D>,
    /// `a = c_a v - a_pred`.
    pub acceleration: AffineInVelocity<D>,
}

/// One step of a time scheme, with the velocity `v` at its end as the unknown.
///
/// The balance of momentum holds at a **stage** of the step, `(ρ a_stage, w) + (P(F(d_stage)), ∇w) = ..`: at its end for implicit
/// Euler, between its ends for generalised-α. Terms see the stage and nothing else of the scheme; what touches
/// the body, contact and fluid, sees the end. Another scheme is another constructor.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRule<const D: usize> {
    end: Kinematics<D>,
    /// `None` where it is the end.
    stage: Option<Kinematics<D>>,
}

impl<const D: usize> StepRule<D> {
    /// Implicit Euler: `d = d^n + Δt v`, `a = (v - v^n)/Δt`.
    ///
    /// Shapes: `displacement` (`d^n`) and `velocity` (`v^n`): one vector per vertex.
    ///
    /// Source: paper, fully discrete problem, with the velocity of the solid as unknown.
    ///
    /// # Errors
    /// [`Error::Parameter`]: time step not positive. [`Error::Length`]: lists of different lengths.
    pub fn implicit_euler(dt: f64, displacement: &[Vector<D>], velocity: &[Vector<D>]) -> Result<Self, Error> {
        positive("time step", dt)?;
        length("velocity", velocity.len(), displacement.len())?;
        let end = Kinematics {
            displacement: AffineInVelocity { slope: dt, predicted: displacement.to_vec() },
            acceleration: AffineInVelocity {
                slope: dt.recip(),
                predicted: velocity.iter().map(|v| -(v / dt)).collect(),
            },
        };
        Ok(Self { end, stage: None })
    }

    /// Statics: `d = d^n + Δt v` and no inertia. With `Δt = 1` the unknown is the increment of displacement.
    ///
    /// # Errors
    /// [`Error::Parameter`]: time step not positive.
    pub fn quasi_static(dt: f64, displacement: &[Vector<D>]) -> Result<Self, Error> {
        positive("time step", dt)?;
        let end = Kinematics {
            displacement: AffineInVelocity { slope: dt, predicted: displacement.to_vec() },
            acceleration: AffineInVelocity { slope: 0.0, predicted: vec![Vector::zeros(); displacement.len()] },
        };
        Ok(Self { end, stage: None })
    }

    /// Generalised-α: Newmark's rules for the end of the step,
    ///
    /// `v = v^n + Δt ((1-γ) a^n + γ a)`, `d = d^n + Δt v^n + Δt² ((1/2-β) a^n + β a)`,
    ///
    /// solved for `a` and `d`, and the stage `a_stage = (1-α_m) a + α_m a^n`, `d_stage = (1-α_f) d + α_f d^n`.
    ///
    /// Where `a^n` is not known (`None`, at the start of a run) acceleration counts as constant over the step, `a^n = a`: no
    /// equation has to be solved for it, motion under constant acceleration stays exact, and the order is kept.
    ///
    /// Shapes: `displacement` (`d^n`), `velocity` (`v^n`), `acceleration` (`a^n`): one vector per vertex.
    ///
    /// Source: Chung and Hulbert 1993, A time integration algorithm for structural dynamics with improved numerical dissipation,
    /// doi:10.1115/1.2900803.
    ///
    /// # Errors
    /// [`Error::Parameter`]: time step not positive. [`Error::Length`]: lists of different lengths.
    pub fn generalised_alpha(
        scheme: GeneralisedAlpha,
        dt: f64,
        displacement: &[Vector<D>],
        velocity: &[Vector<D>],
        acceleration: Option<&[Vector<D>]>,
    ) -> Result<Self, Error> {
        positive("time step", dt)?;
        length("velocity", velocity.len(), displacement.len())?;
        if let Some(acceleration) = acceleration {
            length("acceleration", acceleration.len(), displacement.len())?;
        }
        let [alpha_m, alpha_f] = [scheme.alpha_m(), scheme.alpha_f()];
        // Newmark's rules with a^n = a are those with a^n = 0, β = 1/2 and γ = 1.
        let (beta, gamma) = if acceleration.is_some() { (scheme.beta(), scheme.gamma()) } else { (0.5, 1.0) };
        let old = |vertex: usize| acceleration.map_or(Vector::zeros(), |a| a[vertex]);
        let n = displacement.len();
        let end = Kinematics {
            displacement: AffineInVelocity {
                slope: dt * beta / gamma,
                predicted: (0..n)
                    .map(|i| {
                        let drift = (1.0 - beta / gamma) * velocity[i] + dt * (0.5 - beta / gamma) * old(i);
                        displacement[i] + dt * drift
                    })
                    .collect(),
            },
            acceleration: AffineInVelocity {
                slope: (gamma * dt).recip(),
                predicted: (0..n).map(|i| -(velocity[i] / dt + (1.0 - gamma) * old(i)) / gamma).collect(),
            },
        };
        // Between the old value and the end, the old one with the given weight.
        let between = |weight: f64, end: &AffineInVelocity<D>, old: &dyn Fn(usize) -> Vector<D>| AffineInVelocity {
            slope: (1.0 - weight) * end.slope,
            predicted: (0..n).map(|i| (1.0 - weight) * end.predicted[i] + weight * old(i)).collect(),
        };
        let stage = Kinematics {
            displacement: between(alpha_f, &end.displacement, &|i| displacement[i]),
            acceleration: match acceleration {
                Some(old) => between(alpha_m, &end.acceleration, &|i| old[i]),
                None => end.acceleration.clone(),
            },
        };
        Ok(Self { end, stage: Some(stage) })
    }

    /// Displacement and acceleration at the end of the step.
    #[inline]
    pub fn end(&self) -> &Kinematics<D> {
        &self.end
    }

    /// Displacement and acceleration at which momentum is balanced: those of inertia, internal work and loads.
    #[inline]
    pub fn stage(&self) -> &Kinematics<D> {
        self.stage.as_ref().unwrap_or(&self.end)
    }

    /// The velocity that leads to a displacement at the end of the step, at a vertex: `v = (d - d_pred)/c_d`.
    #[inline]
    pub fn velocity_to_reach(&self, vertex: usize, displacement: &Vector<D>) -> Vector<D> {
        let end = &self.end.displacement;
        (displacement - end.predicted[vertex]) / end.slope
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.end.displacement.predicted.len()
    }
}
