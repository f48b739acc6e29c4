//! A boundary at given positions of its vertices.

use crate::simplex::{factorial, points_of};
use crate::tensor::area_vector;
use crate::{
    BoundaryMesh, FacetId, MAX_CELL_VERTICES, MAX_FACET_NODES, MAX_FACET_VERTICES, Order, Point, ShapeFunctions,
    SimplexRule, Tensor, Vector, mean, simplex_measure,
};

/// A boundary with borrowed positions of its vertices: the current configuration is a view and not a second mesh.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'m, const D: usize> {
    boundary: &'m BoundaryMesh<D>,
    positions: &'m [Point<D>],
}

impl<'m, const D: usize> Placed<'m, D> {
    /// Creates the view from one position per vertex of the mesh. Segments run counter-clockwise around the body,
    /// triangles turn counter-clockwise as seen from outside.
    ///
    /// Other methods panic if a facet has a vertex beyond the positions; [`Placed::new`] does not check it.
    pub fn new(boundary: &'m BoundaryMesh<D>, positions: &'m [Point<D>]) -> Self {
        Self { boundary, positions }
    }

    /// Returns the boundary.
    pub fn boundary(&self) -> &'m BoundaryMesh<D> {
        self.boundary
    }

    /// Returns the positions of the vertices.
    pub fn positions(&self) -> &'m [Point<D>] {
        self.positions
    }

    /// Returns the positions of the vertices of a facet; only the first `D` are used.
    #[inline]
    pub fn facet_points(&self, facet: FacetId) -> [Point<D>; MAX_FACET_VERTICES] {
        points_of(self.positions, self.boundary.facet(facet))
    }

    /// Returns the positions of the nodes of a facet ([`BoundaryMesh::nodes`]); the other entries are zero.
    #[inline]
    pub fn nodes(&self, facet: FacetId) -> [Point<D>; MAX_FACET_NODES] {
        self.boundary.at_nodes(facet, |node| self.positions[node.index()])
    }

    /// Returns an upper bound of the distance between the facets of the surface and the curved elements of which they
    /// are parts; zero for order 1. The difference of a quadratic function and its linear interpolation on a triangle
    /// is at most four thirds of the largest difference in the middles of the edges.
    pub fn bulge(&self, facets: impl Iterator<Item = FacetId>) -> f64 {
        if self.boundary.order() == Order::Linear {
            return 0.0;
        }
        let mut largest = 0.0_f64;
        for facet in facets {
            let (corners, nodes) = (self.facet_points(facet), self.nodes(facet));
            for (i, j) in (0..D).flat_map(|j| (0..j).map(move |i| (i, j))) {
                let middle = std::array::from_fn(|k| if k == i || k == j { 0.5 } else { 0.0 });
                let curved = self.boundary.shape(facet, &middle).at(&nodes);
                largest = largest.max((curved - mean(&[corners[i], corners[j]])).norm());
            }
        }
        4.0 / 3.0 * largest
    }

    /// Returns the measure (length, area) of a facet.
    pub fn facet_measure(&self, facet: FacetId) -> f64 {
        simplex_measure(&self.facet_points(facet)[..D])
    }

    /// Returns the measure that the facet would have with the tangents of its element at a point: on a part of a curved
    /// element its mean is the measure of the curved part; for order 1 it is that of the facet.
    pub fn measure_at(&self, facet: FacetId, shape: &ShapeFunctions) -> f64 {
        let order = self.boundary.order();
        if order == Order::Linear {
            return self.facet_measure(facet);
        }
        let (n_nodes, nodes) = (order.n_nodes(D - 1), self.nodes(facet));
        let mut tangents = Tensor::<D>::zeros();
        (1..D).for_each(|k| tangents.set_column(k, &shape.along(k - 1, &nodes[..n_nodes])));
        area_vector(&tangents).norm() / (factorial(D - 1) * order.parts(D - 1).len() as f64)
    }

    /// Returns the middle of a facet: the mean of its vertices.
    pub fn facet_middle(&self, facet: FacetId) -> Point<D> {
        mean(&self.facet_points(facet)[..D])
    }

    /// Returns the measure of a facet times the weight of the coordinates in its middle. With rotational symmetry this
    /// is the area of the whole ring, since the weight is linear.
    pub fn weighted_measure(&self, facet: FacetId) -> f64 {
        self.facet_measure(facet) * self.boundary.coordinates().weight(&self.facet_middle(facet))
    }

    /// Returns the unit normal of a facet, out of the solid; zero for a degenerate facet.
    #[inline]
    pub fn facet_normal(&self, facet: FacetId) -> Vector<D> {
        facet_normal(&self.facet_points(facet)[..D])
    }

    /// Computes volume, centre and second moment of the region inside the surface, exactly up to round-off.
    ///
    /// The region is the signed sum of the simplices between the facets and a point. For a simplex `T` with one vertex
    /// at the origin and the others at `x_i`: `∫ x xᵀ = |T| (Σ x_i x_iᵀ + s sᵀ)/((D + 1)(D + 2))`, `s = Σ x_i`. In
    /// axisymmetric coordinates the region is the whole body, whose centre lies on the axis.
    pub fn enclosed(&self) -> Enclosed<D> {
        if let Some(radial) = self.boundary.coordinates().radial() {
            return self.enclosed_around_axis(radial);
        }
        let origin = self.boundary.facets().next().map_or(Point::zeros(), |f| self.facet_points(f)[0]);
        let (mut volume, mut first, mut second) = (0.0, Point::<D>::zeros(), Tensor::<D>::zeros());
        for facet in self.boundary.facets() {
            let points = self.facet_points(facet).map(|x| x - origin);
            let corners = &points[..D];
            // The length of the scaled normal is (D - 1)! times the measure of the facet.
            let simplex = corners[0].dot(&scaled_normal(&self.facet_points(facet)[..D])) / factorial(D);
            let sum: Point<D> = corners.iter().sum();
            volume += simplex;
            first += sum * (simplex / (D + 1) as f64);
            let squares = corners.iter().map(|x| x * x.transpose()).sum::<Tensor<D>>() + sum * sum.transpose();
            second += squares * (simplex / ((D + 1) * (D + 2)) as f64);
        }
        let arm = first / volume;
        Enclosed { volume, centre: origin + arm, second_moment: second - arm * arm.transpose() * volume }
    }

    /// Integrates over the signed simplices with the weight of the coordinates. The integrands have degree 3.
    fn enclosed_around_axis(&self, radial: usize) -> Enclosed<D> {
        let rule = SimplexRule::of_degree(D, 3);
        let origin = self.boundary.facets().next().map_or(Point::zeros(), |f| self.facet_points(f)[0]);
        let (mut volume, mut first, mut second) = (0.0, Point::<D>::zeros(), Tensor::<D>::zeros());
        for facet in self.boundary.facets() {
            let mut corners = [origin; MAX_CELL_VERTICES];
            corners[1..=D].copy_from_slice(&self.facet_points(facet)[..D]);
            let simplex = (corners[1] - origin).dot(&scaled_normal(&corners[1..=D])) / factorial(D);
            rule.for_each_point(&corners[..=D], |x, share| {
                // The rule has the unsigned measure.
                let weight = share * simplex.signum() * self.boundary.coordinates().weight(&x);
                let mut along = x - origin;
                along[radial] = 0.0;
                volume += weight;
                first += along * weight;
                second += along * along.transpose() * weight;
                // The mean of x² over a circle around the axis is r²/2.
                second[(radial, radial)] += 0.5 * x[radial] * x[radial] * weight;
            });
        }
        let arm = first / volume;
        let mut centre = origin + arm;
        centre[radial] = 0.0;
        Enclosed { volume, centre, second_moment: second - arm * arm.transpose() * volume }
    }
}

/// Moments of the region inside a closed surface.
///
/// Units: those of the positions to the power of `D`, 1 and `D + 2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosed<const D: usize> {
    /// Volume (area in 2D), positive if the normals point outwards.
    pub volume: f64,
    /// Centre; NaN if the volume is zero.
    pub centre: Point<D>,
    /// `∫ r rᵀ` with `r = x - centre`; NaN if the volume is zero.
    pub second_moment: Tensor<D>,
}

/// Returns the unit normal of an oriented facet: to the right of a segment, by the right-hand rule for a triangle; zero
/// for a degenerate facet.
#[inline]
pub fn facet_normal<const D: usize>(points: &[Point<D>]) -> Vector<D> {
    let n = scaled_normal(points);
    let length = n.norm();
    if length > 0.0 { n / length } else { n }
}

/// Returns the normal of an oriented facet. Its length is the measure of the facet in 2D and twice the measure in 3D
/// (the cross product). Zero for a degenerate facet.
#[inline]
fn scaled_normal<const D: usize>(points: &[Point<D>]) -> Vector<D> {
    let mut tangents = Tensor::<D>::zeros();
    (1..D).for_each(|k| tangents.set_column(k, &(points[k] - points[0])));
    area_vector(&tangents)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::structured_box;

    /// Compares with the moments of a box: its volume times the squares of its edges, divided by twelve.
    fn check<const D: usize>(low: [f64; D], high: [f64; D], n: [usize; D]) {
        let mesh = structured_box(low, high, n).unwrap();
        let [low, high] = [low, high].map(Point::<D>::from);
        let found = Placed::new(&mesh.boundary(), mesh.vertices()).enclosed();
        let volume = (high - low).product();
        assert!((found.volume - volume).abs() < 1e-14 * volume);
        assert!((found.centre - 0.5 * (low + high)).norm() < 1e-14);
        let moments = (high - low).map(|edge| edge * edge * volume / 12.0);
        assert!((found.second_moment - Tensor::from_diagonal(&moments)).norm() < 1e-13 * volume);
    }

    #[test]
    fn a_ring_has_the_moments_of_the_body_that_it_draws() {
        // Hollow cylinder, 1 < r < 3, -2 < z < 2.
        let mesh = structured_box([1.0, -2.0], [3.0, 2.0], [2, 3]).unwrap();
        let mesh = mesh.with_coordinates(crate::Coordinates::Axisymmetric).unwrap();
        let found = Placed::new(&mesh.boundary(), mesh.vertices()).enclosed();
        let volume = std::f64::consts::PI * 8.0 * 4.0;
        assert!((found.volume - volume).abs() < 1e-13 * volume);
        assert!(found.centre.norm() < 1e-14);
        // ∫ z² = V L²/12, ∫ x² = V (a² + b²)/4.
        let moments = Vector::<2>::new(10.0 / 4.0, 16.0 / 12.0) * volume;
        assert!((found.second_moment - Tensor::from_diagonal(&moments)).norm() < 1e-13 * volume);
    }

    #[test]
    fn boxes_have_their_moments() {
        check([1.0, -2.0], [4.0, 0.0], [3, 2]);
        check([0.0, 0.0, 1.0], [1.0, 2.0, 4.0], [1, 2, 2]);
    }
}
