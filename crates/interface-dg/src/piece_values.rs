//! Traces of fluid and solid on interface pieces.

use cutcell::{CutMesh, InterfacePiece};
use mesh::{MAX_CELL_VERTICES, Point, SimplexMesh, SimplexRule, Vector};
use xfem_space::{PartValues, cutcell};

/// A quadrature point of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePoint<const D: usize> {
    /// Where.
    pub point: Point<D>,
    /// Weight, with the measure.
    pub weight: f64,
    /// Shape values of the fluid part; the first `D + 1` count.
    pub fluid: [f64; MAX_CELL_VERTICES],
    /// Shape values of the solid facet; the first `D` count.
    pub solid: [f64; MAX_CELL_VERTICES],
}

/// Quadrature points of all interface pieces of a cut, computed once per step.
#[derive(Clone, Debug)]
pub struct PieceValues<const D: usize> {
    points: Vec<PiecePoint<D>>,
    per_piece: usize,
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    cell_sizes: Vec<f64>,
}

impl<const D: usize> PieceValues<D> {
    /// Values with a rule of the given degree on every piece.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>, parts: &PartValues<D>, degree: usize) -> Self {
        let rule = SimplexRule::of_degree(D - 1, degree);
        let n = cut.interface().len();
        let mut values = Self {
            points: Vec::with_capacity(n * rule.points().len()),
            per_piece: rule.points().len(),
            gradients: Vec::with_capacity(n),
            cell_sizes: Vec::with_capacity(n),
        };
        for piece in cut.interface() {
            let simplex = background.simplex(piece.cell);
            let gradients = parts.gradients(piece.part);
            values.gradients.push(*gradients);
            values.cell_sizes.push(parts.cell_size(piece.part));
            for (barycentric, weight) in rule.points().iter().zip(rule.weights()) {
                let mut point = PiecePoint {
                    point: Point::zeros(),
                    weight: weight * piece.measure,
                    fluid: [0.0; MAX_CELL_VERTICES],
                    solid: [0.0; MAX_CELL_VERTICES],
                };
                for (corner, l) in barycentric[..D].iter().enumerate() {
                    point.point += piece.points[corner] * *l;
                    for (solid, share) in point.solid[..D].iter_mut().zip(&piece.barycentric[corner]) {
                        *solid += l * share;
                    }
                }
                point.fluid[0] = 1.0;
                for (value, gradient) in point.fluid[..=D].iter_mut().zip(gradients) {
                    *value += gradient.dot(&(point.point - simplex.points()[0]));
                }
                values.points.push(point);
            }
        }
        values
    }

    /// Quadrature points of a piece.
    #[inline]
    pub fn points(&self, piece: usize) -> &[PiecePoint<D>] {
        &self.points[piece * self.per_piece..][..self.per_piece]
    }

    /// Gradients of the shape functions of the fluid part of a piece.
    #[inline]
    pub fn gradients(&self, piece: usize) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[piece]
    }

    /// Size `h_K` of the background cell of a piece.
    #[inline]
    pub fn cell_size(&self, piece: usize) -> f64 {
        self.cell_sizes[piece]
    }
}

/// An interface piece with its local state, at one quadrature point.
///
/// Local unknowns: velocity component `a` of fluid node `i` at row `D i + a`, then the pressures of the fluid nodes,
/// then (elastic body) the velocity of the vertices of the facet.
pub(crate) struct MortarPoint<'a, const D: usize> {
    /// Geometry and shape values.
    pub(crate) at: &'a PiecePoint<D>,
    /// The piece.
    pub(crate) piece: &'a InterfacePiece<D>,
    /// Gradients of the fluid's shape functions.
    pub(crate) gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    /// Size `h_K` of the background cell.
    pub(crate) cell_size: f64,
    /// Fluid velocity minus velocity of the body.
    pub(crate) jump: Vector<D>,
    /// Pressure.
    pub(crate) pressure: f64,
    /// Traction `T^f(u, p) n^f`.
    pub(crate) traction: Vector<D>,
    /// Whether the velocity of the body is unknown.
    pub(crate) is_unknown: bool,
}

impl<const D: usize> MortarPoint<'_, D> {
    /// Normal `n^f = -n`, into the body.
    #[inline]
    pub(crate) fn fluid_normal(&self) -> Vector<D> {
        -self.piece.normal
    }

    /// The basis of the jump `v - w`: first row and value of each vector-valued test function.
    #[inline]
    pub(crate) fn jump_basis(&self) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let fluid = (0..=D).map(|i| (D * i, self.at.fluid[i]));
        let n_solid = if self.is_unknown { D } else { 0 };
        let first_solid = (D + 1) * (D + 1);
        let solid = (0..n_solid).map(move |k| (first_solid + D * k, -self.at.solid[k]));
        fluid.chain(solid)
    }

    /// Row of the pressure of a fluid node.
    #[inline]
    pub(crate) fn pressure_row(&self, node: usize) -> usize {
        D * (D + 1) + node
    }
}
