//! Exact predicates: on which side, and how a segment crosses a facet.
//!
//! Mesh vertices count as shifted by an infinitesimal `(ε, ε², ...)`, so that a vertex on a surface, or a surface
//! vertex on a mesh edge, has an answer that is the same wherever it is asked (simulation of simplicity).

use mesh::Point;
use robust::{Coord, orient2d};

fn coord<const D: usize>(x: &Point<D>) -> Coord<f64> {
    Coord { x: x[0], y: x[1] }
}

fn sign(value: f64) -> i32 {
    i32::from(value > 0.0) - i32::from(value < 0.0)
}

fn first_nonzero(signs: [f64; 3]) -> i32 {
    signs.iter().map(|&s| sign(s)).find(|&s| s != 0).unwrap_or(1)
}

/// End of a segment: a point as it is, or a mesh vertex that counts as shifted by an infinitesimal.
#[derive(Clone, Copy)]
pub(crate) enum End<'a, const D: usize> {
    /// A point in the inside of a convex piece.
    Point(&'a Point<D>),
    /// A mesh vertex.
    Vertex(&'a Point<D>),
}

/// How the number of bodies around changes on the way from `from` to `to` through a facet: +1 into the body, -1
/// out of it, 0 where the segment misses the facet. Exact.
pub(crate) fn crossing<const D: usize>(from: &Point<D>, to: End<'_, D>, facet: &[Point<D>]) -> i32 {
    match D {
        2 => crossing_2d(from, to, &facet[0], &facet[1]),
        _ => 0,
    }
}

/// `from` is a mesh vertex.
fn crossing_2d<const D: usize>(from: &Point<D>, to: End<'_, D>, a: &Point<D>, b: &Point<D>) -> i32 {
    let (q, to_is_vertex) = match to {
        End::Point(x) => (x, false),
        End::Vertex(x) => (x, true),
    };
    // Side of a mesh vertex with respect to the line a -> b.
    let side_of_vertex = |x: &Point<D>| first_nonzero([orient2d(coord(a), coord(b), coord(x)), a[1] - b[1], b[0] - a[0]]);
    let side_from = side_of_vertex(from);
    let side_to = if to_is_vertex { side_of_vertex(q) } else { first_nonzero([orient2d(coord(a), coord(b), coord(q)), 0.0, 0.0]) };
    if side_from == side_to {
        return 0;
    }
    // Side of a facet vertex with respect to the line from -> q, whose vertices move by (ε, ε²).
    let side = |x: &Point<D>| {
        let exact = orient2d(coord(from), coord(q), coord(x));
        if to_is_vertex {
            first_nonzero([exact, q[1] - from[1], from[0] - q[0]])
        } else {
            first_nonzero([exact, q[1] - x[1], x[0] - q[0]])
        }
    };
    if side(a) == side(b) { 0 } else { side_to }
}

#[cfg(test)]
mod tests {
    use super::*;

    type P = Point<2>;

    /// Depth of a point with respect to a counter-clockwise polygon, from a far vertex.
    fn depth(polygon: &[P], to: End<'_, 2>) -> i32 {
        let far = P::new(17.0, 0.3);
        (0..polygon.len()).map(|k| crossing(&far, to, &[polygon[k], polygon[(k + 1) % polygon.len()]])).sum()
    }

    #[test]
    fn depth_is_zero_or_one_even_on_the_boundary() {
        let square = [P::new(0.0, 0.0), P::new(1.0, 0.0), P::new(1.0, 1.0), P::new(0.0, 1.0)];
        for i in -2..=6 {
            for j in -2..=6 {
                let x = P::new(0.25 * f64::from(i), 0.25 * f64::from(j));
                // Shifted by (ε, ε²): the left and bottom sides belong to the inside, the right and top do not.
                let inside = (0..4).contains(&i) && (0..4).contains(&j);
                assert_eq!(depth(&square, End::Vertex(&x)), i32::from(inside), "{x}");
            }
        }
        assert_eq!(depth(&square, End::Point(&P::new(0.5, 0.3))), 1);
        assert_eq!(depth(&square, End::Point(&P::new(0.5, 1.5))), 0);
    }
}
