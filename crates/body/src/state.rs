//! A body at one time.

use algebra::time::Level;
use mesh::{Point, Vector};

/// Positions and velocities of the vertices of a body at one time, and its own numbers.
///
/// A checkpoint writes both lists as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyState<const D: usize> {
    /// Levels of the vertices, newest first: one at least, and as many as the time scheme reads.
    pub levels: Vec<Level<Vector<D>>>,
    /// Numbers that only the body interprets, such as position and spin of a rigid body.
    pub inner: Vec<f64>,
}

impl<const D: usize> BodyState<D> {
    /// Creates a state of one level without acceleration, from one displacement and one velocity per vertex.
    pub fn new(displacement: Vec<Vector<D>>, velocity: Vec<Vector<D>>) -> Self {
        let level = Level { displacement, velocity, acceleration: Vec::new() };
        Self { levels: vec![level], inner: Vec::new() }
    }

    /// Returns the displacements from the reference positions, one per vertex.
    pub fn displacement(&self) -> &[Vector<D>] {
        &self.levels[0].displacement
    }

    /// Returns the velocities, one per vertex.
    pub fn velocity(&self) -> &[Vector<D>] {
        &self.levels[0].velocity
    }

    /// Returns the current positions.
    pub fn positions(&self, reference: &[Point<D>]) -> Vec<Point<D>> {
        reference.iter().zip(self.displacement()).map(|(x, d)| x + d).collect()
    }
}
