//! Moments and gradients of fluid parts.

use cutcell::{CutMesh, PartId};
use mesh::{Coordinates, MAX_CELL_VERTICES, Point, QuadratureRule, SimplexMesh, SimplexRule, Vector, equilateral_side};

/// A part below this fraction of its cell contributes no volume integral; its dofs, faces and interface pieces stay.
const NEGLIGIBLE_FRACTION: f64 = 1e-9;

/// Degree of the rule for integrals with the radius in the denominator. They are exact for functions that are
/// proportional to the radius, such as the radial velocity near the axis.
const HOOP_DEGREE: usize = 4;

/// Moments `m_ij = ∫ N_i N_j` of the shape functions of a cell over a part, with the weight [`Coordinates::weight`].
///
/// The shape functions add up to one, so `Σ_j m_ij = ∫ N_i`, and all entries add up to the volume. Integrals of
/// constants, of P1 functions and of products of two of them follow from the moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    entries: [[f64; MAX_CELL_VERTICES]; MAX_CELL_VERTICES],
}

impl Moments {
    /// Returns the moments of a whole cell: `m_ij = V (1 + δ_ij)/((D + 1)(D + 2))`.
    fn of_whole(volume: f64, dimension: usize) -> Self {
        let mut moments = Self::default();
        let off_diagonal = volume / ((dimension + 1) * (dimension + 2)) as f64;
        for i in 0..=dimension {
            for j in 0..=dimension {
                moments.entries[i][j] = if i == j { 2.0 * off_diagonal } else { off_diagonal };
            }
        }
        moments
    }

    /// Adds a point of a rule that is exact for products of two shape functions.
    fn add(&mut self, weight: f64, shape: &[f64; MAX_CELL_VERTICES]) {
        for (row, n_i) in self.entries.iter_mut().zip(shape) {
            row.iter_mut().zip(shape).for_each(|(entry, n_j)| *entry += weight * n_i * n_j);
        }
    }

    /// Returns `∫ N_i N_j`.
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[i][j]
    }

    /// Returns `∫ N_i`.
    #[inline]
    pub fn of(&self, i: usize) -> f64 {
        self.entries[i].iter().sum()
    }

    /// Returns `∫ 1`.
    #[inline]
    pub fn volume(&self) -> f64 {
        (0..MAX_CELL_VERTICES).map(|i| self.of(i)).sum()
    }

    /// Returns `∫ N_i u = Σ_j m_ij u_j` of a vector field with the values `u_j` at the vertices.
    #[inline]
    pub fn weighted<const D: usize>(&self, i: usize, values: &[Vector<D>; MAX_CELL_VERTICES]) -> Vector<D> {
        // The compiler unrolls this; it does not unroll the `sum` of vectors or an inclusive range.
        (0..D + 1).fold(Vector::zeros(), |sum, j| sum + values[j] * self.entries[i][j])
    }
}

/// Moments over a part in axisymmetric coordinates with the radius in the denominator.
///
/// All are sums over the same points inside the part, so that `Σ_ij u_i u_j (∫ N_i N_j/r²)` is a sum of squares of
/// `u/r` for every cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoopMoments {
    /// `∫ N_i N_j / r`.
    pub by_radius: Moments,
    /// `∫ N_i N_j / r²`.
    pub by_square: Moments,
}

/// Moments and gradients of all parts of a cut, computed once per step.
#[derive(Clone, Debug)]
pub struct PartValues<const D: usize> {
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    moments: Vec<Moments>,
    /// One per part in axisymmetric coordinates, else empty.
    hoop: Vec<HoopMoments>,
    coordinates: Coordinates,
    cell_sizes: Vec<f64>,
}

impl<const D: usize> PartValues<D> {
    /// Computes the values on all parts of a cut.
    pub fn new(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Self {
        let coordinates = background.coordinates();
        let rule = SimplexRule::of_degree(D, if coordinates.radial().is_some() { HOOP_DEGREE } else { 2 });
        let n = cut.n_parts();
        let mut values = Self {
            gradients: Vec::with_capacity(n),
            moments: Vec::with_capacity(n),
            hoop: Vec::new(),
            coordinates,
            cell_sizes: Vec::with_capacity(n),
        };
        let mut points = QuadratureRule::default();
        for part in cut.all_parts() {
            let simplex = background.simplex(cut.part_cell(part));
            let volume = simplex.volume();
            let gradients = simplex.barycentric_gradients().unwrap_or([Vector::zeros(); MAX_CELL_VERTICES]);
            let (mut moments, mut hoop) = (Moments::default(), HoopMoments::default());
            if cut.is_whole(part) && coordinates.radial().is_none() {
                moments = Moments::of_whole(volume, D);
            } else if cut.part_volume(part) > NEGLIGIBLE_FRACTION * volume {
                cut.part_quadrature(background, part, rule, &mut points);
                for (x, &weight) in points.points.iter().zip(&points.weights) {
                    let (weight, shape) = (weight * coordinates.weight(x), shape(&gradients, &simplex.points()[0], x));
                    moments.add(weight, &shape);
                    if let Some(radial) = coordinates.radial() {
                        let radius = x[radial];
                        hoop.by_radius.add(weight / radius, &shape);
                        hoop.by_square.add(weight / (radius * radius), &shape);
                    }
                }
                points.points.clear();
                points.weights.clear();
            }
            values.hoop.extend(coordinates.radial().map(|_| hoop));
            values.gradients.push(gradients);
            values.cell_sizes.push(equilateral_side::<D>(volume));
            values.moments.push(moments);
        }
        values
    }

    /// Calls `visit` with position, weight and shape values of the points of a rule on a part. The rule is exact for
    /// polynomials of the given degree. A part of negligible volume has no points.
    pub fn for_each_point(
        &self,
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        part: PartId,
        degree: usize,
        mut visit: impl FnMut(&Point<D>, f64, &[f64; MAX_CELL_VERTICES]),
    ) {
        if self.moments(part).volume() == 0.0 {
            return;
        }
        let rule = SimplexRule::of_degree(D, degree + self.coordinates.degree());
        let origin = background.simplex(cut.part_cell(part)).points()[0];
        cut.for_each_simplex(background, part, |simplex| {
            rule.for_each_point(simplex, |x, weight| {
                visit(&x, weight * self.coordinates.weight(&x), &shape(self.gradients(part), &origin, &x));
            });
        });
    }

    /// Returns the gradients of the shape functions of a part; only the first `D + 1` are used.
    #[inline]
    pub fn gradients(&self, part: PartId) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[part.index()]
    }

    /// Returns the moments of a part; zero for a part of negligible volume.
    #[inline]
    pub fn moments(&self, part: PartId) -> &Moments {
        &self.moments[part.index()]
    }

    /// Returns the moments of a part with the radius in the denominator; `None` in Cartesian coordinates.
    #[inline]
    pub fn hoop(&self, part: PartId) -> Option<&HoopMoments> {
        self.hoop.get(part.index())
    }

    /// Returns the coordinates.
    #[inline]
    pub fn coordinates(&self) -> Coordinates {
        self.coordinates
    }

    /// Returns the size `h_K` of the cell of a part: side of the equilateral simplex of the same volume.
    #[inline]
    pub fn cell_size(&self, part: PartId) -> f64 {
        self.cell_sizes[part.index()]
    }
}

/// Computes the shape values at a point; only the first `D + 1` are used.
fn shape<const D: usize>(
    gradients: &[Vector<D>; MAX_CELL_VERTICES],
    origin: &Point<D>,
    x: &Point<D>,
) -> [f64; MAX_CELL_VERTICES] {
    let mut shape = [0.0; MAX_CELL_VERTICES];
    for i in 0..=D {
        shape[i] = gradients[i].dot(&(x - origin)) + if i == 0 { 1.0 } else { 0.0 };
    }
    shape
}
