//! Crossings of segments and facets.
//!
//! Mesh vertices are shifted by an infinitesimal `(ε, ε², ...)`, so that predicates are consistent for vertices on a
//! surface and surface vertices on a mesh edge (simulation of simplicity).

use mesh::Point;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::integer::Exact;
use super::number::Number;

fn coord<const D: usize>(x: &Point<D>) -> Coord<f64> {
    Coord { x: x[0], y: x[1] }
}

/// Returns the determinant of a point relative to the plane of a facet: positive behind the facet, on the side of the
/// body. The sign is exact, and the value is accurate, since round-off in the normal of a small facet does not grow
/// with the distance.
pub(super) fn determinant<const D: usize>(facet: &[Point<D>], x: &Point<D>) -> f64 {
    match D {
        2 => orient2d(coord(&facet[0]), coord(&facet[1]), coord(x)),
        _ => orient3d(coord_3d(&facet[0]), coord_3d(&facet[1]), coord_3d(&facet[2]), coord_3d(x)),
    }
}

/// Returns the volume (area in 2D) of a simplex, negative if it is inverted. If the value is below `doubt`, the bound
/// of round-off, it is computed with an exact sign, so that needles of nearly coincident corners keep a volume.
pub(crate) fn signed_volume<const D: usize>(simplex: &[Point<D>], doubt: f64) -> f64 {
    let volume = mesh::Simplex::new(simplex).volume();
    if volume.abs() > doubt {
        return volume;
    }
    match D {
        2 => orient2d(coord(&simplex[1]), coord(&simplex[2]), coord(&simplex[0])) / 2.0,
        _ => {
            let [apex, a, b, c] = [0, 1, 2, 3].map(|k| coord_3d(&simplex[k]));
            orient3d(a, b, c, apex) / 6.0
        }
    }
}

fn sign(value: f64) -> i32 {
    i32::from(value > 0.0) - i32::from(value < 0.0)
}

fn first_nonzero(signs: [f64; 3]) -> i32 {
    signs.iter().map(|&s| sign(s)).find(|&s| s != 0).unwrap_or(1)
}

/// End of a segment: a point, or a mesh vertex that is shifted by an infinitesimal.
#[derive(Clone, Copy)]
pub(crate) enum End<'a, const D: usize> {
    /// A point inside a convex piece.
    Point(&'a Point<D>),
    /// A mesh vertex.
    Vertex(&'a Point<D>),
}

/// Returns the change of the number of surrounding bodies along the segment from `from` to `to` due to a facet, exact:
/// +1 into the body, -1 out of it, 0 if the segment does not cross the facet. `from` is a mesh vertex.
pub(crate) fn crossing<const D: usize>(from: &Point<D>, to: End<'_, D>, facet: &[Point<D>]) -> i32 {
    match D {
        2 => crossing_2d(from, to, &facet[0], &facet[1]),
        _ => crossing_3d(from, to, [&facet[0], &facet[1], &facet[2]]),
    }
}

fn crossing_2d<const D: usize>(from: &Point<D>, to: End<'_, D>, a: &Point<D>, b: &Point<D>) -> i32 {
    let (q, to_is_vertex) = match to {
        End::Point(x) => (x, false),
        End::Vertex(x) => (x, true),
    };
    // Side of a mesh vertex relative to the line a -> b.
    let side_of_vertex =
        |x: &Point<D>| first_nonzero([orient2d(coord(a), coord(b), coord(x)), a[1] - b[1], b[0] - a[0]]);
    let side_from = side_of_vertex(from);
    let side_to = if to_is_vertex {
        side_of_vertex(q)
    } else {
        first_nonzero([orient2d(coord(a), coord(b), coord(q)), 0.0, 0.0])
    };
    if side_from == side_to {
        return 0;
    }
    // Side of a facet vertex relative to the line from -> q, whose vertices move by (ε, ε²).
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

fn coord_3d<const D: usize>(x: &Point<D>) -> Coord3D<f64> {
    Coord3D { x: x[0], y: x[1], z: x[2] }
}

/// Returns whether the corners of a facet coincide (2D) or lie on a line (3D), exactly.
pub(crate) fn is_degenerate<const D: usize>(facet: &[Point<D>]) -> bool {
    if D == 2 { facet[0] == facet[1] } else { normal([&facet[0], &facet[1], &facet[2]]) == [0.0; 3] }
}

/// Computes the components of the normal `(b - a) × (c - a)`, with exact signs.
fn normal<const D: usize>([a, b, c]: [&Point<D>; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let along = |x: &Point<D>| Coord { x: x[(k + 1) % 3], y: x[(k + 2) % 3] };
        orient2d(along(a), along(b), along(c))
    })
}

/// Computes the components of `(x - y) × (p - q)`, rounded from exact values, since the two vectors may be nearly
/// parallel.
pub(super) fn cross_of_differences<const D: usize>([x, y]: [&Point<D>; 2], [p, q]: [&Point<D>; 2]) -> [f64; 3] {
    let difference = |a: &Point<D>, b: &Point<D>, k: usize| Exact::difference(a[k % 3], b[k % 3]);
    std::array::from_fn(|k| {
        let first = (difference(x, y, k + 1), difference(p, q, k + 2));
        let second = (difference(x, y, k + 2), difference(p, q, k + 1));
        Exact::sum_of_products(&[(false, &first.0, &first.1), (true, &second.0, &second.1)]).value()
    })
}

fn crossing_3d<const D: usize>(from: &Point<D>, to: End<'_, D>, facet: [&Point<D>; 3]) -> i32 {
    let (q, to_is_vertex) = match to {
        End::Point(x) => (x, false),
        End::Vertex(x) => (x, true),
    };
    let [a, b, c] = facet.map(coord_3d);
    // Positive behind the facet, on the side of the body.
    let side = |x: &Point<D>, is_vertex: bool| {
        let exact = sign(orient3d(a, b, c, coord_3d(x)));
        if exact == 0 && is_vertex { first_nonzero(normal(facet).map(|n| -n)) } else { exact }
    };
    let (side_from, side_to) = (side(from, true), side(q, to_is_vertex));
    if side_from == side_to || side_to == 0 {
        return 0;
    }
    // Side of an edge of the facet on which the line passes.
    let passes = |x: &Point<D>, y: &Point<D>| {
        let exact = sign(orient3d(coord_3d(from), coord_3d(q), coord_3d(x), coord_3d(y)));
        if exact != 0 {
            exact
        } else if to_is_vertex {
            first_nonzero(cross_of_differences([x, y], [from, q]))
        } else {
            first_nonzero(normal([q, x, y]))
        }
    };
    let [a, b, c] = facet;
    let (ab, bc, ca) = (passes(a, b), passes(b, c), passes(c, a));
    if ab == bc && bc == ca { side_to } else { 0 }
}

/// Returns whether the segment from `a` to `b` crosses the interior of a facet, strictly from one side to the other.
/// Exact.
pub(crate) fn pierces<const D: usize>(a: &Point<D>, b: &Point<D>, facet: &[Point<D>]) -> bool {
    let opposite = |p: f64, q: f64| sign(p) * sign(q) < 0;
    if !opposite(determinant(facet, a), determinant(facet, b)) {
        return false;
    }
    match D {
        2 => {
            let side = |x: &Point<D>| orient2d(coord(a), coord(b), coord(x));
            opposite(side(&facet[0]), side(&facet[1]))
        }
        _ => {
            let passes =
                |x: &Point<D>, y: &Point<D>| sign(orient3d(coord_3d(a), coord_3d(b), coord_3d(x), coord_3d(y)));
            let first = passes(&facet[0], &facet[1]);
            first != 0 && first == passes(&facet[1], &facet[2]) && first == passes(&facet[2], &facet[0])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type P = Point<2>;

    /// Returns the number of times that a counter-clockwise polygon surrounds a point, by the crossings on a segment
    /// from a far vertex.
    fn depth(polygon: &[P], to: End<'_, 2>) -> i32 {
        let far = P::new(17.0, 0.3);
        (0..polygon.len()).map(|k| crossing(&far, to, &[polygon[k], polygon[(k + 1) % polygon.len()]])).sum()
    }

    #[test]
    fn depth_in_a_cube_is_zero_or_one_even_on_its_faces_edges_and_corners() {
        type Q = Point<3>;
        let corner = |k: usize| Q::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64);
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets: Vec<[Q; 3]> = squares
            .iter()
            .flat_map(|&[a, b, c, d]| [[corner(a), corner(b), corner(c)], [corner(a), corner(c), corner(d)]])
            .collect();
        for far in [Q::new(7.0, 0.5, 0.5), Q::new(5.0, 4.0, 3.0), Q::new(4.0, 4.0, 4.0)] {
            let depth = |to: End<'_, 3>| facets.iter().map(|f| crossing(&far, to, f)).sum::<i32>();
            for index in 0..7 * 7 * 7 {
                let i = [index % 7, index / 7 % 7, index / 49];
                let x = Q::from_fn(|k, _| 0.25 * (i[k] as f64 - 1.0));
                let inside = i.iter().all(|i| (1..5).contains(i));
                assert_eq!(depth(End::Vertex(&x)), i32::from(inside), "{x}");
            }
            assert_eq!(depth(End::Point(&Q::new(0.5, 0.25, 0.25))), 1);
            assert_eq!(depth(End::Point(&Q::new(0.5, 0.5, 0.5))), 1);
            assert_eq!(depth(End::Point(&Q::new(1.5, 0.5, 0.5))), 0);
        }
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
