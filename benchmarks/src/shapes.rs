//! Surfaces of disks and spheres, and names of sides.

use mesh::{BoundaryMesh, Point, VertexId};

/// Names of the sides of a box.
pub(crate) const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];

/// Centre of disk and sphere, the same as in the scripts of the other codes (benchmarks/RESULTS.md).
pub const BODY_CENTRE: [f64; 3] = [0.041_421_356_237_309_5, 0.073_205_080_756_887_7, 0.023_606_797_749_979];

/// Returns a polygon with its corners on the circle around the first two coordinates of `centre`.
pub fn polygon(centre: [f64; 3], radius: f64, n_edges: u32) -> (Vec<Point<2>>, BoundaryMesh<2>) {
    let corner = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n_edges);
        Point::<2>::new(centre[0], centre[1]) + Point::<2>::new(angle.cos(), angle.sin()) * radius
    };
    let facets = (0..n_edges).flat_map(|k| [VertexId(k), VertexId((k + 1) % n_edges)]).collect();
    ((0..n_edges).map(corner).collect(), BoundaryMesh::from_facets(facets))
}

/// Returns a triangulated sphere: an octahedron with each triangle divided into n².
pub fn sphere(centre: [f64; 3], radius: f64, n: u32) -> (Vec<Point<3>>, BoundaryMesh<3>) {
    let mut numbers = std::collections::HashMap::new();
    let mut positions = Vec::new();
    let mut facets = Vec::new();
    for octant in 0..8 {
        let signs: [i64; 3] = std::array::from_fn(|k| if octant >> k & 1 == 0 { 1 } else { -1 });
        let mut vertex = |i: u32, j: u32| {
            let key = [i64::from(n - i - j) * signs[0], i64::from(i) * signs[1], i64::from(j) * signs[2]];
            *numbers.entry(key).or_insert_with(|| {
                positions.push(Point::<3>::from(centre) + Point::<3>::from(key.map(|c| c as f64)).normalize() * radius);
                VertexId::new(positions.len() - 1)
            })
        };
        let mut push = |[a, b, c]: [VertexId; 3]| {
            facets.extend(if signs.iter().product::<i64>() > 0 { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..n {
            for j in 0..n - i {
                push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    (positions, BoundaryMesh::from_facets(facets))
}
