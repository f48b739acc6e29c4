//! One quadrature point of contact: what the term sees.

use mesh::{Point, Vector};

use crate::obstacle::MAX_FACET_VERTICES;
use crate::{ContactPoint, ContactTraction, Projection};

/// Vertices that can take part at one point: those of the slave's facet and those of the anchor.
pub(crate) const MAX_NODES: usize = 2 * MAX_FACET_VERTICES;

/// A vertex that takes part in contact at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactNode<const D: usize> {
    /// First local row of its velocity.
    pub row: usize,
    /// Its share `s_a` in the relative motion `x - Π(x)`: shape function at the slave, minus barycentric coordinate at
    /// the master.
    pub share: f64,
    /// Derivative `G_a` of its barycentric coordinate with respect to `x`; zero at the slave.
    pub gradient: Vector<D>,
    /// `c_d` of its body.
    pub displacement_per_velocity: f64,
}

impl<const D: usize> ContactNode<D> {
    pub(crate) fn none() -> Self {
        Self { row: 0, share: 0.0, gradient: Vector::zeros(), displacement_per_velocity: 0.0 }
    }
}

/// A quadrature point of the slave's surface, its projection and the traction between them.
#[derive(Clone, Copy, Debug)]
pub struct ContactSite<const D: usize> {
    /// Quadrature weight, measure of the facet included.
    pub weight: f64,
    /// Position at the end of the step.
    pub x: Point<D>,
    /// Closest point of the obstacle.
    pub projection: Projection<D>,
    /// What the law was asked.
    pub at: ContactPoint,
    /// What it answered.
    pub traction: ContactTraction,
    /// Whether the law says that there is contact.
    pub is_active: bool,
    pub(crate) nodes: [ContactNode<D>; MAX_NODES],
    pub(crate) n_nodes: usize,
}

impl<const D: usize> ContactSite<D> {
    /// The vertices that take part, those of the slave first.
    #[inline]
    pub fn nodes(&self) -> &[ContactNode<D>] {
        &self.nodes[..self.n_nodes]
    }
}
