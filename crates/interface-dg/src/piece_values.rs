//! Traces of fluid and solid on interface pieces.

use cutcell::CutMesh;
use mesh::{MAX_CELL_VERTICES, Point, SimplexMesh, SimplexRule, Vector};
use xfem_space::PartValues;

/// A quadrature point of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePoint<const D: usize> {
    /// Position.
    pub point: Point<D>,
    /// Weight, with the measure.
    pub weight: f64,
    /// Shape values of the fluid part; only the first `D + 1` are used.
    pub fluid: [f64; MAX_CELL_VERTICES],
    /// Shape values of the solid facet; only the first `D` are used.
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
    /// Creates the values with a rule of the given degree on every piece.
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

    /// Returns the quadrature points of a piece.
    #[inline]
    pub fn points(&self, piece: usize) -> &[PiecePoint<D>] {
        &self.points[piece * self.per_piece..][..self.per_piece]
    }

    /// Returns the gradients of the shape functions of the fluid part of a piece.
    #[inline]
    pub fn gradients(&self, piece: usize) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[piece]
    }

    /// Returns the size `h_K` of the background cell of a piece.
    #[inline]
    pub fn cell_size(&self, piece: usize) -> f64 {
        self.cell_sizes[piece]
    }
}
