//! Shape values on fluid parts.

use cutcell::{CutMesh, PartId};
use mesh::{MAX_CELL_VERTICES, QuadratureRule, SimplexMesh, SimplexRule, Vector, equilateral_side};

/// A part below this fraction of its cell contributes no volume integral; its dofs, faces and interface pieces stay.
const NEGLIGIBLE_FRACTION: f64 = 1e-9;

/// A quadrature point of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPoint {
    /// Weight, with the volume.
    pub weight: f64,
    /// Shape values; the first `D + 1` count.
    pub shape: [f64; MAX_CELL_VERTICES],
}

/// Quadrature points and gradients of all parts of a cut: immutable, computed once per step.
#[derive(Clone, Debug)]
pub struct PartValues<const D: usize> {
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    cell_sizes: Vec<f64>,
    offsets: Vec<u32>,
    points: Vec<PartPoint>,
}

impl<const D: usize> PartValues<D> {
    /// Values with a rule that is exact for polynomials of the given degree on every part.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>, degree: usize) -> Self {
        let rule = SimplexRule::of_degree(D, degree);
        let n = cut.n_parts();
        let mut values = Self {
            gradients: Vec::with_capacity(n),
            cell_sizes: Vec::with_capacity(n),
            offsets: Vec::with_capacity(n + 1),
            points: Vec::with_capacity(n * rule.points().len()),
        };
        values.offsets.push(0);
        let mut on_part = QuadratureRule::default();
        for part in cut.all_parts() {
            let simplex = background.simplex(cut.part_cell(part));
            let volume = simplex.volume();
            let gradients = simplex.barycentric_gradients().unwrap_or([Vector::zeros(); MAX_CELL_VERTICES]);
            values.gradients.push(gradients);
            values.cell_sizes.push(equilateral_side::<D>(volume));
            if cut.is_whole(part) {
                let points = rule.points().iter().zip(rule.weights());
                values
                    .points
                    .extend(points.map(|(shape, weight)| PartPoint { weight: weight * volume, shape: *shape }));
            } else if cut.part_volume(part) > NEGLIGIBLE_FRACTION * volume {
                on_part.points.clear();
                on_part.weights.clear();
                cut.part_quadrature(background, part, &rule, &mut on_part);
                let origin = simplex.points()[0];
                for (x, &weight) in on_part.points.iter().zip(&on_part.weights) {
                    let mut shape = [0.0; MAX_CELL_VERTICES];
                    for i in 0..=D {
                        shape[i] = gradients[i].dot(&(x - origin)) + if i == 0 { 1.0 } else { 0.0 };
                    }
                    values.points.push(PartPoint { weight, shape });
                }
            }
            values.offsets.push(values.points.len() as u32);
        }
        values
    }

    /// Gradients of the shape functions of a part; the first `D + 1` count.
    #[inline]
    pub fn gradients(&self, part: PartId) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[part.index()]
    }

    /// Size `h_K` of the cell of a part: side of the equilateral simplex of the same volume.
    #[inline]
    pub fn cell_size(&self, part: PartId) -> f64 {
        self.cell_sizes[part.index()]
    }

    /// Quadrature points of a part; empty for a part of negligible volume.
    #[inline]
    pub fn points(&self, part: PartId) -> &[PartPoint] {
        &self.points[self.offsets[part.index()] as usize..self.offsets[part.index() + 1] as usize]
    }

    /// Number of parts.
    pub fn len(&self) -> usize {
        self.gradients.len()
    }

    /// Whether there are no parts.
    pub fn is_empty(&self) -> bool {
        self.gradients.is_empty()
    }
}
