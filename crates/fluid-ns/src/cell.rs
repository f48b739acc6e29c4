//! One fluid part as its terms see it.

use algebra::LocalSystem;
use mesh::{MAX_CELL_VERTICES, Point, Simplex, Tensor, Vector};
use xfem_space::PartPoint;

/// A fluid part with its local state. P1: gradients are constant on it.
///
/// Local unknowns: velocity component `a` of node `i` at row `D i + a`, then the pressures of the nodes.
pub struct FluidCell<'a, const D: usize> {
    /// The background cell.
    pub simplex: Simplex<D>,
    /// Gradients of the shape functions; the first `D + 1` count.
    pub gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    /// Quadrature points of the part.
    pub points: &'a [PartPoint],
    /// Velocity of each node.
    pub velocities: [Vector<D>; MAX_CELL_VERTICES],
    /// Pressure of each node.
    pub pressures: [f64; MAX_CELL_VERTICES],
    /// History `u*` of each node.
    pub histories: [Vector<D>; MAX_CELL_VERTICES],
}

/// A quadrature point with the fields evaluated.
pub struct FluidPoint<const D: usize> {
    /// Weight.
    pub weight: f64,
    /// Shape values; the first `D + 1` count.
    pub shape: [f64; MAX_CELL_VERTICES],
    /// Velocity.
    pub velocity: Vector<D>,
    /// Pressure.
    pub pressure: f64,
    /// History `u*`.
    pub history: Vector<D>,
}

impl<const D: usize> FluidCell<'_, D> {
    /// Local nodes.
    #[inline]
    pub fn nodes(&self) -> std::ops::RangeInclusive<usize> {
        0..=D
    }

    /// First row of the velocity of a node.
    #[inline]
    pub fn velocity(&self, node: usize) -> usize {
        D * node
    }

    /// Row of the pressure of a node.
    #[inline]
    pub fn pressure(&self, node: usize) -> usize {
        D * (D + 1) + node
    }

    /// Velocity gradient, `grad_u[(a, b)] = ∂u_a/∂x_b`.
    #[inline]
    pub fn grad_u(&self) -> Tensor<D> {
        let mut grad_u = Tensor::zeros();
        for i in self.nodes() {
            grad_u += self.velocities[i] * self.gradients[i].transpose();
        }
        grad_u
    }

    /// Volume of the part, as its quadrature sees it.
    #[inline]
    pub fn volume(&self) -> f64 {
        self.points.iter().map(|q| q.weight).sum()
    }

    /// Quadrature points with the fields.
    #[inline]
    pub fn points(&self) -> impl Iterator<Item = FluidPoint<D>> + '_ {
        self.points.iter().map(|q| {
            let mut point = FluidPoint {
                weight: q.weight,
                shape: q.shape,
                velocity: Vector::zeros(),
                pressure: 0.0,
                history: Vector::zeros(),
            };
            for i in self.nodes() {
                point.velocity += self.velocities[i] * q.shape[i];
                point.pressure += self.pressures[i] * q.shape[i];
                point.history += self.histories[i] * q.shape[i];
            }
            point
        })
    }

    /// Position of a quadrature point.
    #[inline]
    pub fn position(&self, shape: &[f64; MAX_CELL_VERTICES]) -> Point<D> {
        self.simplex.points().iter().zip(shape).map(|(x, n)| x * *n).sum()
    }
}

/// A term integrated over fluid parts: residual and tangent next to each other.
pub trait CellTerm<const D: usize>: Sync {
    /// Adds the term's own line of the equation, with the paper's sign.
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem);
}
