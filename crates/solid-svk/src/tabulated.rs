//! Shape functions at the points of quadrature rules.

use mesh::{Barycentric, Order, ShapeFunctions, SimplexRule};

/// Quadrature points of the reference simplex with the shape functions at these points. Weights sum to the measure of
/// the reference simplex, `1/n!`, or to the measure of one part.
#[derive(Clone, Debug)]
pub(crate) struct Tabulated {
    pub(crate) points: Vec<(f64, ShapeFunctions)>,
}

impl Tabulated {
    /// Tabulates a rule that is exact to a degree.
    pub(crate) fn of_degree(order: Order, dimension: usize, degree: usize) -> Self {
        let rule = SimplexRule::of_degree(dimension, degree);
        Self::of(order, dimension, rule.points().iter().copied().zip(rule.weights().iter().copied()))
    }

    /// Tabulates the vertices with equal weights, exact to degree 1.
    pub(crate) fn of_vertices(order: Order, dimension: usize) -> Self {
        let weight = 1.0 / (dimension + 1) as f64;
        Self::of(order, dimension, (0..=dimension).map(|vertex| (order.node(dimension, vertex), weight)))
    }

    /// Tabulates a rule that is exact to a degree on one part of a simplex.
    pub(crate) fn of_part(order: Order, dimension: usize, part: usize, degree: usize) -> Self {
        let rule = SimplexRule::of_degree(dimension, degree);
        let n_parts = order.parts(dimension).len() as f64;
        let in_part = |at: &Barycentric| order.in_part(dimension, part, at);
        Self::of(order, dimension, rule.points().iter().map(in_part).zip(rule.weights().iter().map(|w| w / n_parts)))
    }

    /// Tabulates points with weights, which are fractions of the measure.
    fn of(order: Order, dimension: usize, rule: impl Iterator<Item = (Barycentric, f64)>) -> Self {
        let measure = 1.0 / (1..=dimension).product::<usize>() as f64;
        Self { points: rule.map(|(at, weight)| (weight * measure, order.shape(dimension, &at))).collect() }
    }
}
