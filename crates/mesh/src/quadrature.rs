//! Quadrature on simplices: tabulated rules in barycentric coordinates, and rules in physical space.

use std::sync::OnceLock;

use crate::{MAX_CELL_VERTICES, Point, simplex_measure};

/// Largest degree of the rules of [`SimplexRule::of_degree`].
const MAX_DEGREE: usize = 5;

/// A quadrature rule on the reference simplex of dimension 0 to 3, in barycentric coordinates. Weights sum to one.
#[derive(Clone, Debug, PartialEq)]
pub struct SimplexRule {
    dimension: usize,
    points: Vec<[f64; MAX_CELL_VERTICES]>,
    weights: Vec<f64>,
}

impl SimplexRule {
    /// Returns a rule with positive weights and points inside the simplex of dimension 0 (point) to 3 (tetrahedron),
    /// exact for polynomials up to `degree` (clamped to 5). Each rule is computed once.
    ///
    /// Sources: Gauss-Legendre; Strang-Fix 1973 (triangle, degree 2, 4 and 5, by orbits); Keast 1986,
    /// DOI 10.1016/0045-7825(86)90059-9, and conical products where the tabulated rule has a negative weight.
    pub fn of_degree(dimension: usize, degree: usize) -> &'static Self {
        static RULES: [[OnceLock<SimplexRule>; MAX_DEGREE + 1]; MAX_CELL_VERTICES] =
            [const { [const { OnceLock::new() }; MAX_DEGREE + 1] }; MAX_CELL_VERTICES];
        let degree = degree.min(MAX_DEGREE);
        RULES[dimension][degree].get_or_init(|| Self::computed(dimension, degree))
    }

    fn computed(dimension: usize, degree: usize) -> Self {
        match (dimension, degree) {
            (0, _) => Self { dimension, points: vec![[1.0, 0.0, 0.0, 0.0]], weights: vec![1.0] },
            (_, 0 | 1) => {
                let mut point = [0.0; MAX_CELL_VERTICES];
                point[..=dimension].fill(1.0 / (dimension + 1) as f64);
                Self { dimension, points: vec![point], weights: vec![1.0] }
            }
            (1, 2 | 3) => Self::gauss_segment(2),
            (1, _) => Self::gauss_segment(3),
            (2, 2) => Self::empty(2).orbit([2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 0.0], 1.0 / 3.0),
            (2, 5) => {
                let root = 15.0_f64.sqrt();
                let [near, far] = [-root, root].map(|root| ((6.0 + root) / 21.0, (155.0 + root) / 1200.0));
                let around = |rule: Self, (a, weight): (f64, f64)| rule.orbit([1.0 - 2.0 * a, a, a, 0.0], weight);
                let third = 1.0 / 3.0;
                around(around(Self::empty(2).orbit([third, third, third, 0.0], 0.225), near), far)
            }
            (2, _) => Self::empty(2)
                .orbit(
                    [1.0 - 2.0 * 0.445_948_490_915_965, 0.445_948_490_915_965, 0.445_948_490_915_965, 0.0],
                    0.223_381_589_678_011,
                )
                .orbit(
                    [1.0 - 2.0 * 0.091_576_213_509_771, 0.091_576_213_509_771, 0.091_576_213_509_771, 0.0],
                    0.109_951_743_655_322,
                ),
            (3, 2) => {
                let a = (5.0 - 5.0_f64.sqrt()) / 20.0;
                Self::empty(3).orbit([1.0 - 3.0 * a, a, a, a], 0.25)
            }
            _ => Self::conical_tetrahedron(),
        }
        .normalised()
    }

    /// Returns the Gauss-Lobatto rule with four points on a segment, including its ends; exact to degree 5.
    pub fn lobatto_segment() -> Self {
        let near = 0.5 * (1.0 - (0.2_f64).sqrt());
        Self::on_segment([(0.0, 1.0 / 12.0), (near, 5.0 / 12.0), (1.0 - near, 5.0 / 12.0), (1.0, 1.0 / 12.0)])
    }

    /// Returns the Gauss-Lobatto-Jacobi rule with four points on a segment, including its ends, for means with the
    /// distance from the first end as their weight; exact to degree 5.
    ///
    /// In axisymmetric coordinates it integrates over a segment whose first end is on the axis. This end has a positive
    /// weight in the rule.
    ///
    /// Source: Bernardi, Dauge and Maday 1999, Spectral Methods for Axisymmetric Domains.
    pub fn lobatto_segment_from_axis() -> Self {
        let root = 2.0_f64.sqrt();
        let [near, far] = [-root, root].map(|root| ((4.0 + root) / 7.0, 17.0 / 40.0 + root / 12.0));
        Self::on_segment([(0.0, 1.0 / 60.0), near, far, (1.0, 2.0 / 15.0)])
    }

    fn on_segment(points: [(f64, f64); 4]) -> Self {
        let mut rule = Self::empty(1);
        for (x, weight) in points {
            rule.points.push([1.0 - x, x, 0.0, 0.0]);
            rule.weights.push(weight);
        }
        rule
    }

    /// Returns a rule on a facet with points at its vertices: Gauss-Lobatto on a segment; vertices, edge midpoints and
    /// centroid of a triangle (exact to degree 3).
    pub fn with_vertices(dimension: usize) -> Self {
        if dimension == 1 {
            return Self::lobatto_segment();
        }
        Self::empty(2)
            .orbit([1.0, 0.0, 0.0, 0.0], 1.0 / 20.0)
            .orbit([0.0, 0.5, 0.5, 0.0], 2.0 / 15.0)
            .orbit([1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0], 9.0 / 20.0)
    }

    /// Returns the barycentric coordinates of the points; only the first `dimension + 1` are used.
    pub fn points(&self) -> &[[f64; MAX_CELL_VERTICES]] {
        &self.points
    }

    /// Returns the weights, as fractions of the measure of the simplex.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Calls `visit` with point and weight of the rule mapped to the simplex with the given points.
    #[inline]
    pub fn for_each_point<const D: usize>(&self, points: &[Point<D>], mut visit: impl FnMut(Point<D>, f64)) {
        debug_assert_eq!(points.len(), self.dimension + 1);
        let measure = simplex_measure(points);
        for (barycentric, weight) in self.points.iter().zip(&self.weights) {
            visit(points.iter().zip(barycentric).map(|(x, l)| x * *l).sum(), weight * measure);
        }
    }

    fn empty(dimension: usize) -> Self {
        Self { dimension, points: Vec::new(), weights: Vec::new() }
    }

    fn normalised(mut self) -> Self {
        let sum: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|w| *w /= sum);
        self
    }

    /// Adds all distinct permutations of a point, with equal weights.
    fn orbit(mut self, point: [f64; MAX_CELL_VERTICES], weight: f64) -> Self {
        let n = self.dimension + 1;
        let first = self.points.len();
        let mut add = |p: [f64; MAX_CELL_VERTICES]| {
            if !self.points[first..].contains(&p) {
                self.points.push(p);
                self.weights.push(weight);
            }
        };
        permutations(point, n, 0, &mut add);
        self
    }

    fn gauss_segment(n: usize) -> Self {
        let mut rule = Self::empty(1);
        for (x, w) in gauss_legendre(n) {
            rule.points.push([1.0 - x, x, 0.0, 0.0]);
            rule.weights.push(w);
        }
        rule
    }

    /// Returns a conical product of Gauss-Legendre rules on the tetrahedron: positive weights, points inside, degree 5.
    fn conical_tetrahedron() -> Self {
        let gauss = gauss_legendre(4);
        let mut rule = Self::empty(3);
        for &(a, wa) in &gauss {
            for &(b, wb) in &gauss {
                for &(c, wc) in &gauss {
                    let (x, y, z) = (a, (1.0 - a) * b, (1.0 - a) * (1.0 - b) * c);
                    rule.points.push([1.0 - x - y - z, x, y, z]);
                    rule.weights.push(wa * wb * wc * (1.0 - a).powi(2) * (1.0 - b));
                }
            }
        }
        rule
    }
}

fn permutations(
    mut point: [f64; MAX_CELL_VERTICES],
    n: usize,
    from: usize,
    visit: &mut impl FnMut([f64; MAX_CELL_VERTICES]),
) {
    if from == n {
        visit(point);
        return;
    }
    for k in from..n {
        point.swap(from, k);
        permutations(point, n, from + 1, visit);
        point.swap(from, k);
    }
}

/// Returns the Gauss-Legendre points and weights on (0, 1).
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let symmetric: Vec<(f64, f64)> = match n {
        2 => vec![((1.0_f64 / 3.0).sqrt(), 1.0)],
        3 => vec![(0.0, 8.0 / 9.0), ((0.6_f64).sqrt(), 5.0 / 9.0)],
        _ => {
            let r = 2.0 / 7.0 * (1.2_f64).sqrt();
            let w = (30.0_f64).sqrt();
            vec![((3.0 / 7.0 - r).sqrt(), (18.0 + w) / 36.0), ((3.0 / 7.0 + r).sqrt(), (18.0 - w) / 36.0)]
        }
    };
    let mut rule = Vec::with_capacity(n);
    for (x, w) in symmetric {
        rule.push((0.5 - 0.5 * x, 0.5 * w));
        if x > 0.0 {
            rule.push((0.5 + 0.5 * x, 0.5 * w));
        }
    }
    rule
}

/// Quadrature points and weights in physical space; may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadratureRule<const D: usize> {
    /// Points.
    pub points: Vec<Point<D>>,
    /// Weights; their sum is the measure of the domain.
    pub weights: Vec<f64>,
}

impl<const D: usize> QuadratureRule<D> {
    /// Appends a rule, mapped to the simplex with the given points.
    pub fn push_simplex(&mut self, rule: &SimplexRule, points: &[Point<D>]) {
        rule.for_each_point(points, |x, weight| {
            self.points.push(x);
            self.weights.push(weight);
        });
    }

    /// Integrates a function.
    pub fn integrate(&self, mut f: impl FnMut(&Point<D>) -> f64) -> f64 {
        self.points.iter().zip(&self.weights).map(|(x, w)| w * f(x)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the integral of `Π l_i^{k_i}` over a simplex of measure one: `d! Π k_i! / (d + Σ k_i)!`.
    fn exact(powers: &[usize]) -> f64 {
        let d = powers.len() - 1;
        let f = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        f(d) * powers.iter().map(|&k| f(k)).product::<f64>() / f(d + powers.iter().sum::<usize>())
    }

    fn check_rule(rule: &SimplexRule, degree: usize) {
        let n = rule.dimension + 1;
        assert!(rule.weights().iter().all(|&w| w > 0.0));
        assert!(rule.points().iter().all(|p| p[..n].iter().all(|&l| (0.0..=1.0).contains(&l))));
        let mut powers = vec![0_usize; n];
        loop {
            if powers.iter().sum::<usize>() <= degree {
                let computed: f64 = rule
                    .points()
                    .iter()
                    .zip(rule.weights())
                    .map(|(p, w)| w * powers.iter().zip(p).map(|(&k, l)| l.powi(k as i32)).product::<f64>())
                    .sum();
                assert!((computed - exact(&powers)).abs() < 1e-13, "{powers:?}: {computed} {}", exact(&powers));
            }
            let Some(slot) = powers.iter().position(|&k| k < degree) else { break };
            powers[..slot].fill(0);
            powers[slot] += 1;
        }
    }

    #[test]
    fn rules_are_exact_to_their_degree() {
        for dimension in 1..=3 {
            for degree in 1..=MAX_DEGREE {
                check_rule(SimplexRule::of_degree(dimension, degree), degree);
            }
        }
        check_rule(&SimplexRule::lobatto_segment(), 5);
        check_rule(&SimplexRule::with_vertices(2), 3);
    }

    #[test]
    fn the_rule_from_the_axis_is_exact_with_the_radius_as_a_factor() {
        let rule = SimplexRule::lobatto_segment_from_axis();
        for degree in 0..=5 {
            let computed: f64 = rule.points().iter().zip(rule.weights()).map(|(p, w)| w * p[1].powi(degree)).sum();
            let exact = 2.0 / f64::from(degree + 2);
            assert!((computed - exact).abs() < 1e-15, "{degree}: {computed} {exact}");
        }
        assert!(rule.weights().iter().all(|weight| *weight > 0.0));
    }
}
