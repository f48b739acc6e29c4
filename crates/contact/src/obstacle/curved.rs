//! Closest points of curved elements.

use mesh::search::Foot;
use mesh::{Aabb, Barycentric, MAX_CELL_VERTICES, MAX_FACET_NODES, Order, Point, Tensor, Vector, area_vector};

/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 50;
/// Correction of coordinates that is the last one. The error after it is of the order of its square.
const LAST: f64 = 1e-9;
/// Round-off of squared distances, relative to those and to squared sizes.
const ROUND_OFF: f64 = 1e-14;
/// Barycentric coordinates above minus this value are inside.
const INSIDE: f64 = 1e-13;
/// Squared distances with a smaller relative difference are treated as equal.
const TIE: f64 = 1e-8;
/// Squared distances that are round-off, relative to squared sizes: those of points on the surface.
const TOUCHING: f64 = 1e-22;

/// Closest point `Π(x)` of the facet of a quadratic element to a point `x`, with derivatives.
///
/// The point lies inside of the facet, or on one of its edges or vertices. Its coordinates along the tangents `t_i` of
/// the facet or edge fulfil `(x - Π) · t_i = 0`. With the shape functions `N_a`, `g_ij = t_i · t_j` and
///   `A_ij = g_ij - (x - Π) · ∂_i ∂_j Π`
/// their derivatives are `G_a = Σ_ij ∂_i N_a A⁻¹_ij t_j`. The metric is `W = T g⁻¹ A g⁻¹ Tᵀ` with the tangents as
/// columns of `T`, so that `G_a · W G_b = Σ_ij ∂_i N_a A⁻¹_ij ∂_j N_b`.
///
/// Source: Wriggers 2006, Computational Contact Mechanics, Chap. 4, DOI 10.1007/978-3-540-32609-0.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvedFoot<const D: usize> {
    /// The closest point.
    pub(super) point: Point<D>,
    squared_distance: f64,
    /// Square of the length of the first edge.
    squared_size: f64,
    /// Barycentric coordinates in the facet of the element; exactly zero at vertices that do not span the feature.
    pub(super) at: Barycentric,
    /// Shape functions.
    pub(super) shape: [f64; MAX_FACET_NODES],
    /// Derivatives of the shape functions with respect to `x`.
    pub(super) gradient: [Vector<D>; MAX_FACET_NODES],
    /// The metric `W`.
    pub(super) metric: Tensor<D>,
    /// Derivative of the closest point with respect to `x`.
    pub(super) point_gradient: Tensor<D>,
    /// Normal into the body and its derivative with respect to `x`, if the closest point lies inside of the facet.
    pub(super) normal: Option<(Vector<D>, Tensor<D>)>,
    /// Local vertices that span the feature, one bit each.
    face: usize,
}

/// Returns a box that contains the facet of a quadratic element: that of its control points as a Bézier patch.
pub(super) fn bounds<const D: usize>(nodes: &[Point<D>; MAX_FACET_NODES]) -> Aabb<D> {
    let n_nodes = Order::Quadratic.n_nodes(D - 1);
    let control = |k: usize| {
        let mean: Point<D> = nodes[..D].iter().zip(Order::Quadratic.node(D - 1, k)).map(|(x, l)| x * l).sum();
        if k < D { nodes[k] } else { nodes[k] * 2.0 - mean }
    };
    Aabb::of_points((0..n_nodes).map(control).collect::<Vec<_>>().iter())
}

/// Returns the coordinates of the closest point of the linear parts of the facet of an element.
fn on_parts<const D: usize>(x: &Point<D>, nodes: &[Point<D>; MAX_FACET_NODES]) -> Barycentric {
    let order = Order::Quadratic;
    let on_part = |(part, of): (usize, &[usize; MAX_CELL_VERTICES])| {
        let foot = Foot::<D>::on_facet(x, &of.map(|k| nodes[k])[..D]);
        let mut at = Barycentric::default();
        at[..D].copy_from_slice(&foot.barycentric[..D]);
        (foot.squared_distance, order.in_part(D - 1, part, &at))
    };
    let feet = order.parts(D - 1).iter().enumerate().map(on_part);
    feet.fold((f64::INFINITY, Barycentric::default()), |best, foot| if foot.0 < best.0 { foot } else { best }).1
}

impl<const D: usize> CurvedFoot<D> {
    /// Computes the closest point of the facet of an element with the given nodes: the closest of those inside of the
    /// facet, on its edges and at its vertices.
    pub(super) fn new(x: &Point<D>, nodes: &[Point<D>; MAX_FACET_NODES]) -> Self {
        let start = on_parts(x, nodes);
        let faces = (1..1_usize << D).filter(|face| face.count_ones() > 1);
        let faces = faces.filter_map(|face| Self::on_face(x, nodes, face, start));
        let vertices = (1..D).map(|vertex| Self::on_vertex(x, nodes, vertex));
        let closer = |best: Self, foot: Self| if foot.is_preferred_to(&best) { foot } else { best };
        faces.chain(vertices).fold(Self::on_vertex(x, nodes, 0), closer)
    }

    /// Returns whether a point at the given squared distance is farther away, by more than round-off.
    pub(super) fn is_closer_than(&self, squared_distance: f64) -> bool {
        squared_distance > self.squared_distance * (1.0 + TIE)
    }

    /// Returns whether this point is closer, or equally close and on a feature of higher dimension.
    pub(super) fn is_preferred_to(&self, other: &Self) -> bool {
        let tolerance = TIE * other.squared_distance + TOUCHING * other.squared_size;
        self.squared_distance < other.squared_distance - tolerance
            || (self.squared_distance <= other.squared_distance + tolerance
                && self.face.count_ones() > other.face.count_ones())
    }

    /// Returns the node in the middle of the vertex or edge that is the feature.
    pub(super) fn node(&self) -> usize {
        let n_nodes = Order::Quadratic.n_nodes(D - 1);
        let spans = |node: &usize| {
            let at = Order::Quadratic.node(D - 1, *node);
            (0..D).all(|k| (at[k] > 0.0) == (self.face & (1 << k) != 0))
        };
        (0..n_nodes).find(spans).unwrap_or(0)
    }

    /// Returns a vertex as the closest point.
    fn on_vertex(x: &Point<D>, nodes: &[Point<D>; MAX_FACET_NODES], vertex: usize) -> Self {
        let at = Order::Quadratic.node(D - 1, vertex);
        Self {
            point: nodes[vertex],
            squared_distance: (x - nodes[vertex]).norm_squared(),
            squared_size: (nodes[1] - nodes[0]).norm_squared(),
            at,
            shape: std::array::from_fn(|node| f64::from(u8::from(node == vertex))),
            gradient: [Vector::zeros(); MAX_FACET_NODES],
            metric: Tensor::identity(),
            point_gradient: Tensor::zeros(),
            normal: None,
            face: 1 << vertex,
        }
    }

    /// Computes the closest point of the surface or line through a facet or edge, by Newton's method from the point
    /// with the given coordinates, or the point of the edge closest to it; `None` if it lies outside, or the iteration
    /// does not converge.
    fn on_face(x: &Point<D>, nodes: &[Point<D>; MAX_FACET_NODES], face: usize, start: Barycentric) -> Option<Self> {
        let spans = |k: &usize| face & (1 << k) != 0;
        let base = (0..D).find(spans)?;
        let others = || (base + 1..D).filter(spans);
        let order = Order::Quadratic;
        let n_nodes = order.n_nodes(D - 1);
        let missing = (0..D).filter(|k| !spans(k)).map(|k| start[k]).sum::<f64>() / f64::from(face.count_ones());
        let mut at = Barycentric::default();
        (0..D).filter(spans).for_each(|k| at[k] = start[k] + missing);
        // Derivatives of shape functions while coordinate k grows and that of the base falls.
        let along = |derivatives: &[f64; 3], k: usize| {
            let by = |k: usize| if k == 0 { 0.0 } else { derivatives[k - 1] };
            by(k) - by(base)
        };
        let tangents = |at: &Barycentric| {
            let shape = order.shape(D - 1, at);
            let mut tangents = Tensor::<D>::zeros();
            for k in others() {
                let tangent = nodes.iter().zip(&shape.derivatives[..n_nodes]).map(|(x, by)| x * along(by, k)).sum();
                tangents.set_column(k, &tangent);
            }
            (shape, tangents)
        };
        let moved = |at: &Barycentric, step: &Vector<D>| {
            let mut moved = *at;
            for k in others() {
                moved[k] += step[k];
                moved[base] -= step[k];
            }
            moved
        };
        let squared = |at: &Barycentric| (x - order.shape(D - 1, at).at(&nodes[..n_nodes])).norm_squared();
        // Second derivatives are constant: differences of tangents.
        let at_start = tangents(&at).1;
        let unit = |l: usize| Vector::<D>::from_fn(|k, _| if k == l { 1.0 } else { 0.0 });
        let mut bending = [Tensor::<D>::zeros(); 3];
        others().for_each(|l| bending[l] = tangents(&moved(&at, &unit(l))).1 - at_start);
        let by_bending = |v: &Vector<D>| Tensor::<D>::from_fn(|i, j| bending[j].column(i).dot(v));
        // Coordinates that do not span the feature are columns of the identity.
        let fixed = Tensor::<D>::from_fn(|i, j| if i == j && others().all(|k| k != i) { 1.0 } else { 0.0 });
        let mut is_converged = false;
        for _ in 0..=MOST_ITERATIONS {
            let (shape, t) = tangents(&at);
            let point = shape.at(&nodes[..n_nodes]);
            let r = x - point;
            let g = t.transpose() * t + fixed;
            let a = g - by_bending(&r);
            let inverse_g = g.try_inverse()?;
            // Where the distance is no minimum, the curvature is left out.
            let (inverse, is_minimum) = match a.cholesky() {
                Some(factor) => (factor.inverse(), true),
                None => (inverse_g, false),
            };
            if is_converged {
                let is_inside = (0..D).filter(spans).all(|k| at[k] >= -INSIDE);
                if !is_inside || !is_minimum {
                    return None;
                }
                let by_coordinates = |derivatives: &[f64; 3]| {
                    let mut by = Vector::<D>::zeros();
                    others().for_each(|k| by[k] = along(derivatives, k));
                    by
                };
                let to_gradient = t * inverse;
                let normal = (face.count_ones() as usize == D).then(|| {
                    let into = -area_vector(&t).normalize();
                    (into, -(t * inverse_g * by_bending(&into) * inverse * t.transpose()))
                });
                return Some(Self {
                    point,
                    squared_distance: r.norm_squared(),
                    squared_size: (nodes[1] - nodes[0]).norm_squared(),
                    at,
                    shape: std::array::from_fn(|k| shape.values[k]),
                    gradient: std::array::from_fn(|k| to_gradient * by_coordinates(&shape.derivatives[k])),
                    metric: t * inverse_g * a * inverse_g * t.transpose(),
                    point_gradient: to_gradient * t.transpose(),
                    normal,
                    face,
                });
            }
            let mut step = inverse * (t.transpose() * r);
            is_converged = step.norm() <= LAST;
            let largest = r.norm_squared() + ROUND_OFF * (r.norm_squared() + g.trace());
            while step.norm() > LAST && squared(&moved(&at, &step)) > largest {
                step *= 0.5;
            }
            at = moved(&at, &step);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::SplitMix64;

    use super::*;

    /// Compares closest points of elements with nodes off the middles of their edges with the closest ones of many.
    fn closest_of_many<const D: usize>(n: usize) {
        let mut random = SplitMix64::seed_from_u64(4);
        let mut between = |size: f64| Vector::<D>::from_fn(|_, _| random.random_range(-size..size));
        let samples = || (0..=n).flat_map(|i| (0..=if D == 2 { 0 } else { n - i }).map(move |j| [i, j]));
        for _ in 0..300 {
            let mut nodes = [Point::<D>::zeros(); MAX_FACET_NODES];
            for (k, node) in nodes.iter_mut().enumerate().take(Order::Quadratic.n_nodes(D - 1)) {
                let at = Order::Quadratic.node(D - 1, k);
                *node = Point::from_fn(|a, _| if a + 1 == D { 0.0 } else { at[a + 1] }) + between(0.1);
            }
            let x = Point::from_fn(|a, _| if a + 1 == D { 0.0 } else { 0.4 }) + between(0.5);
            let foot = CurvedFoot::new(&x, &nodes);
            let at = |[i, j]: [usize; 2]| {
                let [b, c] = [i, j].map(|k| k as f64 / n as f64);
                Order::Quadratic.shape(D - 1, &[1.0 - b - c, b, c, 0.0]).at(&nodes[..Order::Quadratic.n_nodes(D - 1)])
            };
            let closest = samples().map(|k| (x - at(k)).norm()).fold(f64::INFINITY, f64::min);
            let found = foot.squared_distance.sqrt();
            assert!(found < closest + 1e-9 && found > closest - 3.0 / n as f64, "{found} {closest}: {x} {nodes:?}");
            assert!(bounds(&nodes).squared_distance(&foot.point) < 1e-20);
            let on_edge = CurvedFoot::new(&at([n / 4, 0]), &nodes);
            assert!(on_edge.normal.is_some() && on_edge.squared_distance < 1e-24, "a point on an edge is on the facet");
            assert!(samples().all(|k| bounds(&nodes).squared_distance(&at(k)) < 1e-20));
        }
    }

    #[test]
    fn no_point_of_an_element_is_closer() {
        closest_of_many::<2>(400);
        closest_of_many::<3>(40);
    }

    /// The middle of a trough is the farthest of its points, although it is over the point.
    #[test]
    fn the_bottom_of_a_trough_is_not_the_closest_point_to_one_above_its_focus() {
        let mut nodes = [Point::<2>::zeros(); MAX_FACET_NODES];
        (nodes[0], nodes[1]) = (Point::<2>::new(-1.0, 1.0), Point::<2>::new(1.0, 1.0));
        let foot = CurvedFoot::new(&Point::<2>::new(0.01, 1.0), &nodes);
        assert!((foot.squared_distance.sqrt() - 0.75_f64.sqrt()).abs() < 1e-2, "{foot:?}");
        assert!(foot.point[0] > 0.0 && foot.normal.is_some());
    }
}
