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

/// Pairs of vertices of the largest cell.
const MAX_PAIRS: usize = MAX_CELL_VERTICES * (MAX_CELL_VERTICES + 1) / 2;

/// `m_ij = ∫ N_i N_j` over a part. As the shape functions add up to one, `Σ_j m_ij = ∫ N_i`, and all entries add up to the
/// volume: no integral of constants, P1 functions or products of two of them needs anything else.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartMass {
    lower_triangle: [f64; MAX_PAIRS],
}

impl PartMass {
    /// Over a whole cell: `m_ij = V (1 + δ_ij)/((D + 1)(D + 2))`.
    fn of_whole(volume: f64, dimension: usize) -> Self {
        let mut mass = Self::default();
        let off_diagonal = volume / ((dimension + 1) * (dimension + 2)) as f64;
        for i in 0..=dimension {
            for j in 0..=i {
                mass.lower_triangle[i * (i + 1) / 2 + j] = if i == j { 2.0 * off_diagonal } else { off_diagonal };
            }
        }
        mass
    }

    /// By a rule that is exact for products.
    fn of_points(points: &[PartPoint]) -> Self {
        let mut mass = Self::default();
        for q in points {
            let mut entries = mass.lower_triangle.iter_mut();
            for (i, n_i) in q.shape.iter().enumerate() {
                entries.by_ref().zip(&q.shape[..=i]).for_each(|(entry, n_j)| *entry += q.weight * n_i * n_j);
            }
        }
        mass
    }

    /// `m_ij`
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        let (row, column) = (i.max(j), i.min(j));
        self.lower_triangle[row * (row + 1) / 2 + column]
    }
}

/// Quadrature points, moments and gradients of all parts of a cut: immutable, computed once per step.
#[derive(Clone, Debug)]
pub struct PartValues<const D: usize> {
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    masses: Vec<PartMass>,
    cell_sizes: Vec<f64>,
    offsets: Vec<u32>,
    points: Vec<PartPoint>,
}

impl<const D: usize> PartValues<D> {
    /// Values with a rule that is exact for polynomials of the given degree (at least 2) on every part.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>, degree: usize) -> Self {
        assert!(degree >= 2, "moments are of degree 2");
        let rule = SimplexRule::of_degree(D, degree);
        let n = cut.n_parts();
        let mut values = Self {
            gradients: Vec::with_capacity(n),
            masses: Vec::with_capacity(n),
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
                values.masses.push(PartMass::of_whole(volume, D));
                values.offsets.push(values.points.len() as u32);
                continue;
            }
            let first = values.points.len();
            if cut.part_volume(part) > NEGLIGIBLE_FRACTION * volume {
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
            values.masses.push(PartMass::of_points(&values.points[first..]));
            values.offsets.push(values.points.len() as u32);
        }
        values
    }

    /// Gradients of the shape functions of a part; the first `D + 1` count.
    #[inline]
    pub fn gradients(&self, part: PartId) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[part.index()]
    }

    /// Moments of a part; zero for a part of negligible volume.
    #[inline]
    pub fn mass(&self, part: PartId) -> &PartMass {
        &self.masses[part.index()]
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
