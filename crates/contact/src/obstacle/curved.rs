//! Closest points of curved elements.

use mesh::search::Foot;
use mesh::{Aabb, Barycentric, MAX_FACET_NODES, Order, Point, Tensor, Vector, area_vector};

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

/// Facet of a quadratic element with its nodes at given positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvedFacet<const D: usize>(pub(super) [Point<D>; MAX_FACET_NODES]);

/// Point of a facet that is closest to another point: inside of the facet, or on one of its edges or vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvedPoint {
    squared_distance: f64,
    /// Square of the length of the first edge.
    squared_size: f64,
    /// Barycentric coordinates in the facet of the element; exactly zero at vertices that do not span the feature.
    pub(super) at: Barycentric,
    /// Local vertices that span the feature, one bit each.
    face: usize,
}

/// Closest point of the linear parts of a facet. Newton's method starts there.
struct OnParts {
    /// Barycentric coordinates in the facet.
    at: Barycentric,
    distance: f64,
    /// Upper bound of the distance between the facet and its parts.
    bulge: f64,
    /// Length of the first edge.
    size: f64,
}

/// Closest point `Π(x)` of the facet of a quadratic element to a point `x`, with derivatives.
///
/// The coordinates of the point along the tangents `t_i` of its facet or edge fulfil `(x - Π) · t_i = 0`. With the
/// shape functions `N_a`, `g_ij = t_i · t_j` and
///   `A_ij = g_ij - (x - Π) · ∂_i ∂_j Π`
/// their derivatives are `G_a = Σ_ij ∂_i N_a A⁻¹_ij t_j`. The metric is `W = T g⁻¹ A g⁻¹ Tᵀ` with the tangents as
/// columns of `T`, so that `G_a · W G_b = Σ_ij ∂_i N_a A⁻¹_ij ∂_j N_b`.
///
/// Source: Wriggers 2006, Computational Contact Mechanics, Chap. 4, DOI 10.1007/978-3-540-32609-0.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvedFoot<const D: usize> {
    /// The closest point.
    pub(super) point: Point<D>,
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
}

/// Facet, edge or vertex as a polynomial `x_b + Σ a_k λ_k + Σ b_kl λ_k λ_l / 2` in the barycentric coordinates of the
/// vertices that span it. The coordinate of the vertex `b` is one minus the others. Those of vertices that do not span
/// it are zero.
struct Polynomial<const D: usize> {
    face: usize,
    base: usize,
    /// `x_b`.
    origin: Point<D>,
    /// `a_k` in column `k`.
    linear: Tensor<D>,
    /// `b_kl` in column `k` of tensor `l`.
    bending: [Tensor<D>; 3],
}

impl OnParts {
    /// Returns a lower bound of the distance to the facet, with round-off taken as zero.
    fn bound(&self) -> f64 {
        let bound = self.distance - self.bulge;
        if bound > TOUCHING.sqrt() * self.size { bound } else { 0.0 }
    }
}

impl CurvedPoint {
    /// Returns whether a point at the given squared distance is farther away, by more than round-off.
    fn is_closer_than(&self, squared_distance: f64) -> bool {
        squared_distance > self.squared_distance * (1.0 + TIE) + TOUCHING * self.squared_size
    }

    /// Returns whether this point is closer, or equally close and on a feature of higher dimension.
    fn is_preferred_to(&self, other: &Self) -> bool {
        let tolerance = TIE * other.squared_distance + TOUCHING * other.squared_size;
        self.squared_distance < other.squared_distance - tolerance
            || (self.squared_distance <= other.squared_distance + tolerance
                && self.face.count_ones() > other.face.count_ones())
    }

    /// Returns the node in the middle of the vertex or edge that is the feature of a facet with `n` vertices.
    pub(super) fn node(&self, n: usize) -> usize {
        let spans = |node: &usize| {
            let at = Order::Quadratic.node(n - 1, *node);
            (0..n).all(|k| (at[k] > 0.0) == (self.face & (1 << k) != 0))
        };
        (0..Order::Quadratic.n_nodes(n - 1)).find(spans).unwrap_or(0)
    }
}

impl<const D: usize> Polynomial<D> {
    /// Returns the polynomial of the facet, edge or vertex with the given local vertices.
    fn new(facet: &CurvedFacet<D>, face: usize) -> Self {
        let base = face.trailing_zeros() as usize;
        let origin = facet.0[base];
        let mut of = Self { face, base, origin, linear: Tensor::zeros(), bending: [Tensor::zeros(); 3] };
        let middle = |i: usize, j: usize| facet.middle(i, j);
        for k in of.others() {
            of.linear.set_column(k, &(middle(base, k) * 4.0 - origin * 3.0 - facet.0[k]));
            of.bending[k].set_column(k, &((origin + facet.0[k] - middle(base, k) * 2.0) * 4.0));
            for l in of.others().filter(|l| *l != k) {
                let mixed = (origin - middle(base, k) - middle(base, l) + middle(k, l)) * 4.0;
                of.bending[l].set_column(k, &mixed);
            }
        }
        of
    }

    /// Returns the vertices whose coordinates are used.
    fn others(&self) -> impl Iterator<Item = usize> + use<D> {
        let (face, base) = (self.face, self.base);
        (base + 1..D).filter(move |k| face & (1 << k) != 0)
    }

    /// Returns the tangents at a point, as columns.
    fn tangents(&self, at: &Barycentric) -> Tensor<D> {
        self.others().fold(self.linear, |sum, l| sum + self.bending[l] * at[l])
    }

    /// Returns a point.
    fn point(&self, at: &Barycentric) -> Point<D> {
        let mean = (self.linear + self.tangents(at)) * 0.5;
        self.origin + self.others().map(|k| mean.column(k) * at[k]).sum::<Vector<D>>()
    }

    /// Returns the scalar products of the second derivatives with a vector.
    fn by_bending(&self, v: &Vector<D>) -> Tensor<D> {
        let mut products = Tensor::<D>::zeros();
        self.others().for_each(|l| products.set_column(l, &(self.bending[l].transpose() * v)));
        products
    }

    /// Returns `g`; unused coordinates have columns of the identity.
    fn first_form(&self, tangents: &Tensor<D>) -> Tensor<D> {
        let mut g = tangents.transpose() * tangents;
        (0..D).filter(|k| *k == self.base || self.face & (1 << k) == 0).for_each(|k| g[(k, k)] = 1.0);
        g
    }

    /// Returns a point moved by changes of the coordinates.
    fn moved(&self, at: &Barycentric, step: &Vector<D>) -> Barycentric {
        let mut moved = *at;
        for k in self.others() {
            moved[k] += step[k];
            moved[self.base] -= step[k];
        }
        moved
    }

    /// Computes the coordinates of the point closest to `x` and its squared distance by Newton's method. It starts at
    /// the point with the given coordinates in the facet. On an edge, the coordinates that span it grow by equal shares
    /// of the others. Returns `None` if the closest point lies outside, if the tangents there are linearly dependent,
    /// or if the iteration does not converge.
    fn closest(&self, x: &Point<D>, start: &Barycentric) -> Option<(Barycentric, f64)> {
        let spans = |k: &usize| self.face & (1 << k) != 0;
        let missing = (0..D).filter(|k| !spans(k)).map(|k| start[k]).sum::<f64>() / f64::from(self.face.count_ones());
        let mut at = Barycentric::default();
        (0..D).filter(spans).for_each(|k| at[k] = start[k] + missing);
        let mut is_converged = false;
        for _ in 0..=MOST_ITERATIONS {
            let (t, r) = (self.tangents(&at), x - self.point(&at));
            let g = self.first_form(&t);
            let factor = (g - self.by_bending(&r)).cholesky();
            if is_converged {
                // Where the distance is no minimum, there is no factor.
                let is_inside = (0..D).filter(spans).all(|k| at[k] >= -INSIDE);
                let is_regular = factor.is_some() && g.try_inverse().is_some();
                return (is_inside && is_regular).then(|| (at, r.norm_squared()));
            }
            let downhill = t.transpose() * r;
            let mut step = match factor {
                Some(factor) => factor.solve(&downhill),
                // The curvature is left out.
                None => g.try_inverse()? * downhill,
            };
            is_converged = step.norm() <= LAST;
            let largest = r.norm_squared() + ROUND_OFF * (r.norm_squared() + g.trace());
            while step.norm() > LAST && (x - self.point(&self.moved(&at, &step))).norm_squared() > largest {
                step *= 0.5;
            }
            at = self.moved(&at, &step);
        }
        None
    }
}

impl<const D: usize> CurvedFacet<D> {
    /// Returns the node between two vertices.
    fn middle(&self, i: usize, j: usize) -> Point<D> {
        self.0[D + i + j - 1]
    }

    /// Returns a box that contains the facet: that of its control points as a Bézier patch.
    fn bounds(&self) -> Aabb<D> {
        let n_nodes = Order::Quadratic.n_nodes(D - 1);
        let control = |k: usize| {
            let mean: Point<D> = self.0[..D].iter().zip(Order::Quadratic.node(D - 1, k)).map(|(x, l)| x * l).sum();
            if k < D { self.0[k] } else { self.0[k] * 2.0 - mean }
        };
        let points: [Point<D>; MAX_FACET_NODES] = std::array::from_fn(|k| control(k.min(n_nodes - 1)));
        Aabb::of_points(&points)
    }

    /// Returns an upper bound of the distance between a facet or edge and its linear parts, given its local vertices.
    ///
    /// On a part with barycentric coordinates `μ_i`, the difference is `-Σ_(i<j) μ_i μ_j d_ij / 2` with
    /// `d_ij = x_i + x_j - 2 m_ij`, and the sum of `μ_i μ_j` over `i < j` is at most `(n - 1)/(2 n)` for `n` vertices.
    fn bulge(&self, face: usize) -> f64 {
        let spans = |k: usize| face & (1 << k) != 0;
        let edges = (0..D).flat_map(|j| (0..j).map(move |i| (i, j))).filter(|&(i, j)| spans(i) && spans(j));
        let largest = edges.map(|(i, j)| (self.0[i] + self.0[j] - self.middle(i, j) * 2.0).norm()).fold(0.0, f64::max);
        let n = f64::from(face.count_ones());
        largest * (n - 1.0) / (4.0 * n)
    }

    /// Computes the closest point of the linear parts of the facet.
    fn on_parts(&self, x: &Point<D>) -> OnParts {
        let order = Order::Quadratic;
        let mut best = (0, Barycentric::default(), f64::INFINITY);
        for (part, nodes) in order.parts(D - 1).iter().enumerate() {
            let corners = &nodes.map(|k| self.0[k])[..D];
            if Aabb::of_points(corners).squared_distance(x) >= best.2 {
                continue;
            }
            let foot = Foot::<D>::on_facet(x, corners);
            if foot.squared_distance < best.2 {
                best.1[..D].copy_from_slice(&foot.barycentric[..D]);
                (best.0, best.2) = (part, foot.squared_distance);
            }
        }
        OnParts {
            at: order.in_part(D - 1, best.0, &best.1),
            distance: best.2.sqrt(),
            bulge: self.bulge((1 << D) - 1),
            size: (self.0[1] - self.0[0]).norm(),
        }
    }

    /// Returns the squared distance to the closest of the two linear parts of an edge, given its local vertices.
    fn on_edge_parts(&self, x: &Point<D>, face: usize) -> f64 {
        let [i, j] = [face.trailing_zeros(), face.ilog2()].map(|k| k as usize);
        let middle = self.middle(i, j);
        let to_part = |end: Point<D>| {
            let (along, from) = (end - middle, x - middle);
            let share = (along.dot(&from) / along.norm_squared()).clamp(0.0, 1.0);
            (from - along * share).norm_squared()
        };
        to_part(self.0[i]).min(to_part(self.0[j]))
    }

    /// Computes the closest of the points inside of the facet, on its edges and at its vertices.
    fn closest(&self, x: &Point<D>, on_parts: &OnParts) -> CurvedPoint {
        let whole = (1_usize << D) - 1;
        let squared_size = (self.0[1] - self.0[0]).norm_squared();
        let on = |face, (at, squared_distance)| CurvedPoint { squared_distance, squared_size, at, face };
        let vertex = |k| on(1_usize << k, (Order::Quadratic.node(D - 1, k), (x - self.0[k]).norm_squared()));
        let mut best =
            (1..D).fold(vertex(0), |best, k| if vertex(k).is_preferred_to(&best) { vertex(k) } else { best });
        for face in (1..=whole).rev().filter(|face| face.count_ones() > 1) {
            let bound = || (self.on_edge_parts(x, face).sqrt() - self.bulge(face)).max(0.0).powi(2);
            if face != whole && best.is_closer_than(bound()) {
                continue;
            }
            let found = Polynomial::new(self, face).closest(x, &on_parts.at).map(|found| on(face, found));
            best = found.filter(|found| found.is_preferred_to(&best)).unwrap_or(best);
        }
        best
    }
}

/// Finds the closest point of some facets, and its facet, which has a label; `None` without facets.
///
/// The facets are visited in the order of lower bounds of their distances: those that may touch in the order in which
/// they are given, so that round-off does not choose among equals. Those that are too far away are left out.
pub(super) fn closest_of<L, const D: usize>(
    x: &Point<D>,
    facets: impl Iterator<Item = (L, CurvedFacet<D>)>,
) -> Option<(L, CurvedFacet<D>, CurvedPoint)> {
    let mut farthest = f64::INFINITY;
    let mut near = Vec::new();
    for (label, facet) in facets {
        if facet.bounds().squared_distance(x) > farthest * (1.0 + TIE) {
            continue;
        }
        let on_parts = facet.on_parts(x);
        farthest = farthest.min((on_parts.distance + on_parts.bulge).powi(2));
        near.push((label, facet, on_parts));
    }
    near.sort_by(|a, b| a.2.bound().total_cmp(&b.2.bound()));
    let mut best: Option<(L, CurvedFacet<D>, CurvedPoint)> = None;
    for (label, facet, on_parts) in near {
        if best.as_ref().is_some_and(|(_, _, known)| known.is_closer_than(on_parts.bound().powi(2))) {
            continue;
        }
        let found = facet.closest(x, &on_parts);
        if best.as_ref().is_none_or(|(_, _, known)| found.is_preferred_to(known)) {
            best = Some((label, facet, found));
        }
    }
    best
}

impl<const D: usize> CurvedFoot<D> {
    /// Computes the closest point and the derivatives.
    pub(super) fn new(x: &Point<D>, facet: &CurvedFacet<D>, closest: &CurvedPoint) -> Self {
        let (order, on) = (Order::Quadratic, Polynomial::new(facet, closest.face));
        let shape = order.shape(D - 1, &closest.at);
        let point = shape.at(&facet.0[..order.n_nodes(D - 1)]);
        let t = on.tangents(&closest.at);
        let g = on.first_form(&t);
        let a = g - on.by_bending(&(x - point));
        // The tangents are linearly independent at the closest point, and the distance is a minimum.
        let [inverse_g, inverse] = [g, a].map(|form| form.try_inverse().unwrap_or_else(Tensor::identity));
        let to_gradient = t * inverse;
        // Derivatives of a shape function while coordinate k grows and that of the base falls.
        let by_coordinates = |derivatives: &[f64; 3]| {
            let by = |k: usize| if k == 0 { 0.0 } else { derivatives[k - 1] };
            let mut along = Vector::<D>::zeros();
            on.others().for_each(|k| along[k] = by(k) - by(on.base));
            along
        };
        let normal = (closest.face.count_ones() as usize == D).then(|| {
            let into = -area_vector(&t).normalize();
            (into, -(t * inverse_g * on.by_bending(&into) * inverse * t.transpose()))
        });
        Self {
            point,
            shape: std::array::from_fn(|k| shape.values[k]),
            gradient: std::array::from_fn(|k| to_gradient * by_coordinates(&shape.derivatives[k])),
            metric: t * inverse_g * a * inverse_g * t.transpose(),
            point_gradient: to_gradient * t.transpose(),
            normal,
        }
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
            let facet = CurvedFacet(nodes);
            let foot_of = |x: &Point<D>| {
                let closest = facet.closest(x, &facet.on_parts(x));
                (closest.squared_distance, CurvedFoot::new(x, &facet, &closest))
            };
            let (squared_distance, foot) = foot_of(&x);
            let at = |[i, j]: [usize; 2]| {
                let [b, c] = [i, j].map(|k| k as f64 / n as f64);
                Order::Quadratic.shape(D - 1, &[1.0 - b - c, b, c, 0.0]).at(&nodes[..Order::Quadratic.n_nodes(D - 1)])
            };
            let closest = samples().map(|k| (x - at(k)).norm()).fold(f64::INFINITY, f64::min);
            let found = squared_distance.sqrt();
            assert!((found - (x - foot.point).norm()).abs() < 1e-14);
            assert!(found < closest + 1e-9 && found > closest - 3.0 / n as f64, "{found} {closest}: {x} {nodes:?}");
            assert!(facet.bounds().squared_distance(&foot.point) < 1e-20);
            let on_edge = foot_of(&at([n / 4, 0]));
            assert!(on_edge.1.normal.is_some() && on_edge.0 < 1e-24, "a point on an edge is on the facet");
            let mut others = [nodes, nodes].map(|nodes| nodes.map(|node| node + between(0.3)));
            others[1] = others[1].map(|node| node + between(0.2));
            let facets = [others[0], nodes, others[1]].map(CurvedFacet);
            let distances = facets.map(|facet| facet.closest(&x, &facet.on_parts(&x)).squared_distance);
            let (number, _, closest) = closest_of(&x, facets.into_iter().enumerate()).expect("three facets");
            assert!(closest.squared_distance == distances[number]);
            assert!(distances.iter().all(|other| closest.squared_distance <= other * (1.0 + TIE)), "{distances:?}");
            assert!(samples().all(|k| facet.bounds().squared_distance(&at(k)) < 1e-20));
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
        let (x, facet) = (Point::<2>::new(0.01, 1.0), CurvedFacet(nodes));
        let closest = facet.closest(&x, &facet.on_parts(&x));
        let foot = CurvedFoot::new(&x, &facet, &closest);
        assert!((closest.squared_distance.sqrt() - 0.75_f64.sqrt()).abs() < 1e-2, "{foot:?}");
        assert!(foot.point[0] > 0.0 && foot.normal.is_some());
    }

    #[test]
    fn steps_that_lead_away_are_halved() {
        let mut nodes = [Point::<3>::zeros(); MAX_FACET_NODES];
        nodes[0] = Point::<3>::new(0.03508091628439738, 0.14695507486125173, -0.19070483661929383);
        nodes[1] = Point::<3>::new(1.049913849483829, 0.08725885635649733, -0.022624688910626214);
        nodes[2] = Point::<3>::new(-0.04093796875934688, 1.163314700842897, -0.030164160468425873);
        nodes[3] = Point::<3>::new(0.635000902437355, 0.19056216819912072, -0.10045557962651284);
        nodes[4] = Point::<3>::new(0.15984906197101775, 0.35002902596836494, -0.06611062041111992);
        nodes[5] = Point::<3>::new(0.3961637573007246, 0.6795366079526346, -0.13189758630848153);
        let x = Point::<3>::new(0.7249846960675914, 0.24398280930369676, -0.44721330851746793);
        let facet = CurvedFacet(nodes);
        // Found by a search over many points.
        let distance = facet.closest(&x, &facet.on_parts(&x)).squared_distance.sqrt();
        assert!((distance - 0.3585).abs() < 1e-4, "{distance}");
    }

    #[test]
    fn a_facet_folded_onto_itself_has_no_normal_where_it_turns() {
        for middle in [0.8, 0.9, 1.1, 1.25, 2.0] {
            let mut nodes = [Point::<2>::zeros(); MAX_FACET_NODES];
            (nodes[1][0], nodes[2][0]) = (1.0, middle);
            let (x, facet) = (Point::<2>::new(4.0, 0.0), CurvedFacet(nodes));
            let foot = CurvedFoot::new(&x, &facet, &facet.closest(&x, &facet.on_parts(&x)));
            assert!(foot.normal.is_none() && foot.point.iter().all(|x| x.is_finite()), "{foot:?}");
        }
    }

    #[test]
    fn round_off_does_not_choose_between_facets_with_a_common_vertex() {
        let mut random = SplitMix64::seed_from_u64(4);
        for bulge in [0.0, 0.05] {
            let mut nodes = [[Point::<2>::zeros(); MAX_FACET_NODES]; 2];
            (nodes[0][0], nodes[0][2]) = (Point::<2>::new(-1.0, -0.3), Point::<2>::new(-0.5, -0.15 + bulge));
            (nodes[1][1], nodes[1][2]) = (Point::<2>::new(1.1, -0.4), Point::<2>::new(0.55, -0.2 + bulge));
            for noise in [0.0, 1e-17, 1e-16, 1e-15, 1e-14] {
                let x = Point::<2>::from_fn(|_, _| noise * random.random_range(-1.0..1.0));
                let found = closest_of(&x, nodes.map(CurvedFacet).into_iter().enumerate()).expect("two facets");
                assert!(found.0 == 0 && found.2.squared_distance < 1e-27, "{noise}: {found:?}");
            }
        }
    }
}
