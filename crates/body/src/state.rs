//! A body at one time.

use algebra::time::{Affine, Level, Row};
use mesh::{Point, Vector};

/// Displacements, velocities and accelerations of the vertices of a body at one time, and data of the kind of body.
///
/// A checkpoint writes the lists as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyState<const D: usize> {
    /// Displacements from the reference positions, velocities and accelerations of the vertices.
    pub level: Level<Vector<D>>,
    /// Numbers that only the body interprets, such as position and spin of a rigid body.
    pub inner: Vec<f64>,
}

impl<const D: usize> BodyState<D> {
    /// Creates a state without acceleration, from one displacement and one velocity per vertex.
    pub fn new(displacement: Vec<Vector<D>>, velocity: Vec<Vector<D>>) -> Self {
        Self { level: Level { displacement, velocity, acceleration: Vec::new() }, inner: Vec::new() }
    }

    /// Returns the displacements from the reference positions, one per vertex.
    pub fn displacement(&self) -> &[Vector<D>] {
        &self.level.displacement
    }

    /// Returns the velocities, one per vertex.
    pub fn velocity(&self) -> &[Vector<D>] {
        &self.level.velocity
    }

    /// Returns the largest speed of a vertex.
    pub fn largest_speed(&self) -> f64 {
        self.velocity().iter().map(Vector::norm).fold(0.0, f64::max)
    }

    /// Returns the current positions of the vertices, from their reference positions.
    pub fn positions(&self, reference: &[Point<D>]) -> Vec<Point<D>> {
        reference.iter().zip(self.displacement()).map(|(x, d)| x + d).collect()
    }

    /// Returns the positions of the vertices that a row of a time scheme gives for zero velocity at the stage.
    pub fn positions_by(&self, row: &Row, reference: &[Point<D>]) -> Vec<Point<D>> {
        let displacement = Affine::new(row, &self.level);
        reference.iter().enumerate().map(|(node, x)| x + displacement.at(node, Vector::zeros())).collect()
    }
}
