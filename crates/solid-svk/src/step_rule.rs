//! How displacement and acceleration at the end of a step follow from the velocity there.

use mesh::Vector;

use crate::Error;
use crate::error::{length, positive};

/// One step of a time scheme, with the velocity `v` at its end as the unknown:
///
/// `d = d_pred + c_d v`, `a = c_a v - a_pred`.
///
/// Terms see nothing else of the scheme; another scheme is another constructor.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRule<const D: usize> {
    displacement_per_velocity: f64,
    acceleration_per_velocity: f64,
    displacement: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
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
        Ok(Self {
            displacement_per_velocity: dt,
            acceleration_per_velocity: dt.recip(),
            displacement: displacement.to_vec(),
            acceleration: velocity.iter().map(|v| v / dt).collect(),
        })
    }

    /// `c_d`: derivative of displacement with respect to velocity.
    #[inline]
    pub fn displacement_per_velocity(&self) -> f64 {
        self.displacement_per_velocity
    }

    /// `c_a`: derivative of acceleration with respect to velocity.
    #[inline]
    pub fn acceleration_per_velocity(&self) -> f64 {
        self.acceleration_per_velocity
    }

    /// `d_pred`: displacements at zero velocity, one per vertex (implicit Euler: those of the step before).
    #[inline]
    pub fn predicted_displacement(&self) -> &[Vector<D>] {
        &self.displacement
    }

    /// `d = d_pred + c_d v` at a vertex.
    #[inline]
    pub fn displacement(&self, vertex: usize, velocity: &Vector<D>) -> Vector<D> {
        self.displacement[vertex] + self.displacement_per_velocity * velocity
    }

    /// `a = c_a v - a_pred` at a vertex.
    #[inline]
    pub fn acceleration(&self, vertex: usize, velocity: &Vector<D>) -> Vector<D> {
        self.acceleration_per_velocity * velocity - self.acceleration[vertex]
    }

    /// The velocity that leads to a displacement at a vertex: `v = (d - d_pred)/c_d`.
    #[inline]
    pub fn velocity_to_reach(&self, vertex: usize, displacement: &Vector<D>) -> Vector<D> {
        (displacement - self.displacement[vertex]) / self.displacement_per_velocity
    }

    /// Displacements of all vertices at the end of the step.
    ///
    /// # Errors
    /// [`Error::Length`]: not one velocity per vertex.
    pub fn displacements(&self, velocity: &[Vector<D>]) -> Result<Vec<Vector<D>>, Error> {
        length("velocity", velocity.len(), self.n_vertices())?;
        Ok(velocity.iter().enumerate().map(|(i, v)| self.displacement(i, v)).collect())
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.displacement.len()
    }
}
