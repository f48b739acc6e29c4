//! Check that surfaces are oriented outwards.

use std::f64::consts::PI;

use mesh::{BodyId, BoundaryMesh, FacetId, Placed, Point, VertexId};

use crate::Error;

/// Checks that a surface is oriented outwards, and that its parts that are oriented inwards are holes.
///
/// # Errors
/// [`Error::Inward`], or [`Error::InwardPart`].
pub(crate) fn check_orientation<const D: usize>(body: BodyId, surface: &Placed<'_, D>) -> Result<(), Error> {
    let volume = surface.enclosed().volume;
    if volume < 0.0 {
        let (facet, point) = outermost(surface);
        return Err(Error::Inward { body, facet, point, volume });
    }
    check_holes(body, surface)
}

/// Checks that each connected part of a surface that is oriented inwards lies in the region that its other parts
/// enclose.
///
/// # Errors
/// [`Error::InwardPart`] for the first part that does not.
fn check_holes<const D: usize>(body: BodyId, surface: &Placed<'_, D>) -> Result<(), Error> {
    let part_of = connected_parts(surface.boundary(), surface.positions().len());
    let mut numbers = part_of.clone();
    numbers.sort_unstable();
    numbers.dedup();
    if numbers.len() == 1 {
        return Ok(());
    }
    for part in numbers {
        let (of_part, others): (Vec<FacetId>, Vec<FacetId>) =
            surface.boundary().facets().partition(|facet| part_of[facet.index()] == part);
        let vertices = of_part.iter().flat_map(|facet| surface.boundary().facet(*facet)).copied().collect();
        let boundary = BoundaryMesh::from_facets(vertices);
        let alone = Placed::new(&boundary, surface.positions());
        let volume = alone.enclosed().volume;
        let on_part = surface.facet_points(of_part[0])[0];
        let times_enclosed =
            || others.iter().map(|facet| directions(&on_part, &surface.facet_points(*facet)[..D])).sum::<f64>();
        if volume < 0.0 && times_enclosed() < 0.5 {
            let (facet, point) = outermost(&alone);
            return Err(Error::InwardPart { body, facet: of_part[facet.index()], point, volume });
        }
    }
    Ok(())
}

/// Returns the vertex farthest along the first axis, and among its facets the one with the normal closest to that axis.
/// If the surface is oriented inwards, so is this facet.
fn outermost<const D: usize>(surface: &Placed<'_, D>) -> (FacetId, [f64; 3]) {
    let mut found = (FacetId(0), Point::<D>::repeat(f64::NEG_INFINITY), 0.0);
    for facet in surface.boundary().facets() {
        let steepness = surface.facet_normal(facet)[0].abs();
        for x in &surface.facet_points(facet)[..D] {
            if x[0] > found.1[0] || (x[0] == found.1[0] && steepness > found.2) {
                found = (facet, *x, steepness);
            }
        }
    }
    (found.0, in_space(&found.1))
}

/// Returns a point with three coordinates.
pub(crate) fn in_space<const D: usize>(x: &Point<D>) -> [f64; 3] {
    let mut point = [0.0; 3];
    point[..D].copy_from_slice(x.as_slice());
    point
}

/// Returns for each facet of a surface the number of its connected part, the smallest vertex in it.
fn connected_parts<const D: usize>(boundary: &BoundaryMesh<D>, n_vertices: usize) -> Vec<VertexId> {
    let mut joined: Vec<VertexId> = (0..n_vertices).map(VertexId::new).collect();
    fn root(joined: &mut [VertexId], mut vertex: VertexId) -> VertexId {
        while joined[vertex.index()] != vertex {
            joined[vertex.index()] = joined[joined[vertex.index()].index()];
            vertex = joined[vertex.index()];
        }
        vertex
    }
    for facet in boundary.facets() {
        for pair in boundary.facet(facet).windows(2) {
            let (a, b) = (root(&mut joined, pair[0]), root(&mut joined, pair[1]));
            joined[a.max(b).index()] = a.min(b);
        }
    }
    boundary.facets().map(|facet| root(&mut joined, boundary.facet(facet)[0])).collect()
}

/// Returns the fraction of all directions from a point in which a facet is, negative if its normal points to the point.
/// The sum over a closed surface is the number of times that it encloses the point.
///
/// Source of the solid angle: van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207.
fn directions<const D: usize>(from: &Point<D>, facet: &[Point<D>]) -> f64 {
    let arms: Vec<Point<D>> = facet.iter().map(|x| x - from).collect();
    if let [a, b] = &arms[..] {
        return (a[0] * b[1] - a[1] * b[0]).atan2(a.dot(b)) / (2.0 * PI);
    }
    let [a, b, c] = [&arms[0], &arms[1], &arms[2]];
    let [i, j, k] = [[1, 2], [2, 0], [0, 1]].map(|[m, n]| b[m] * c[n] - b[n] * c[m]);
    let triple = a[0] * i + a[1] * j + a[2] * k;
    let [r, s, t] = [a.norm(), b.norm(), c.norm()];
    triple.atan2(r * s * t + a.dot(b) * t + b.dot(c) * r + c.dot(a) * s) / (2.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_surface_has_all_directions_from_a_point_in_it() {
        let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point::from);
        let facets = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|facet| facet.map(|k: usize| x[k]));
        let sum = |from: [f64; 3]| facets.iter().map(|facet| directions(&Point::from(from), facet)).sum::<f64>();
        assert!((sum([0.1, 0.2, 0.3]) - 1.0).abs() < 1e-12 && sum([0.1, 0.2, -0.3]).abs() < 1e-12);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Point::from);
        let around = |from: [f64; 2]| {
            (0..3).map(|k| directions(&Point::from(from), &[corners[k], corners[(k + 1) % 3]])).sum::<f64>()
        };
        assert!((around([0.3, 0.3]) - 1.0).abs() < 1e-12 && around([0.8, 0.8]).abs() < 1e-12);
    }
}
