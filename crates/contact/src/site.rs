//! Contact points with the data that terms evaluate.

use mesh::{MAX_FACET_NODES, Point, Tensor, Vector};

use crate::{Anchor, ContactPoint, ContactTraction, Frame, Local, Projection};

/// Largest number of nodes at one point: those of the elements of slave and anchor.
pub(crate) const MAX_NODES: usize = 2 * MAX_FACET_NODES;

/// A node that takes part in contact at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactNode<const D: usize> {
    /// First local row of the velocity of the node; `None` if its motion is prescribed.
    pub row: Option<usize>,
    /// Share `s_a` in the relative motion `x - Π(x)`: shape function (slave), minus shape function (master).
    pub share: f64,
    /// Derivative `G_a` of the master's shape function with respect to `x`; zero at the slave.
    pub gradient: Vector<D>,
    /// Derivative of the position at the end of the step with respect to the velocity, a time.
    pub slope: f64,
    /// Displacement of the node over the step.
    pub displacement: Vector<D>,
    /// Velocity of the node.
    pub velocity: Vector<D>,
}

impl<const D: usize> ContactNode<D> {
    pub(crate) fn none() -> Self {
        let zero = Vector::zeros();
        Self { row: None, share: 0.0, gradient: zero, slope: 0.0, displacement: zero, velocity: zero }
    }
}

/// A quadrature point of the slave's surface in contact, its projection and the traction between them.
#[derive(Clone, Debug)]
pub struct ContactSite<const D: usize> {
    /// Index of the point within its item.
    pub number: usize,
    /// Quadrature weight with the measure of the facet at the start of the step.
    pub weight: f64,
    /// Closest point of the obstacle, at the end of the step.
    pub projection: Projection<D>,
    /// Normal and tangents.
    pub frame: Frame<D>,
    /// Traction `σ n` on the slave's surface, in global axes.
    pub stress: Vector<D>,
    /// Derivatives of the stress, with the local rows of the dofs on which it depends.
    pub stress_derivatives: Vec<(usize, Vector<D>)>,
    /// Arguments of the law at the end of the step.
    pub at: ContactPoint,
    /// Gap at the start of the step, if the law acts as a discrete gradient.
    pub gap_at_start: Option<f64>,
    /// Displacement of the slave's point over the step along the normal, relative to its closest point.
    pub advance: f64,
    /// Result of the law.
    pub traction: ContactTraction,
    /// Derivative of the traction with respect to `advance`, zero unless the law acts as a discrete gradient.
    pub by_advance: Local,
    pub(crate) nodes: [ContactNode<D>; MAX_NODES],
    pub(crate) n_nodes: usize,
    /// Number of nodes of the slave, the first ones.
    pub(crate) n_slave_nodes: usize,
}

impl<const D: usize> ContactSite<D> {
    /// Creates a point without weight and nodes.
    pub(crate) fn new() -> Self {
        let projection = Projection {
            point: Point::zeros(),
            normal: Vector::zeros(),
            normal_gradient: Tensor::zeros(),
            anchor: Anchor::Fixed,
        };
        Self {
            number: 0,
            weight: 0.0,
            projection,
            frame: Frame { axes: [Vector::zeros(); 3] },
            stress: Vector::zeros(),
            stress_derivatives: Vec::new(),
            at: ContactPoint::default(),
            gap_at_start: None,
            advance: 0.0,
            traction: ContactTraction::default(),
            by_advance: Local::default(),
            nodes: [ContactNode::none(); MAX_NODES],
            n_nodes: 0,
            n_slave_nodes: 0,
        }
    }

    /// Returns the nodes that take part, those of the slave first.
    #[inline]
    pub fn nodes(&self) -> &[ContactNode<D>] {
        &self.nodes[..self.n_nodes]
    }
}
