//! Tetrahedra of a ball, by division of an icosahedron.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::size::affordable;
use crate::{Error, Point, Simplex, SimplexMesh, Vector, VertexId};

/// Index of the centre among the corners; the corners of the icosahedron follow.
const CENTRE: usize = 0;
/// Mean length of the edges times the number of edges along a radius, relative to the radius. It is 1.21 to 1.28 for 2
/// to 17 edges along a radius.
const MEAN_EDGE: f64 = 1.26;

/// Generates a ball of unit radius about the origin, for a given ratio of the radius to the mean length of the edges.
///
/// Each tetrahedron between the centre and a face is divided into `n³`, and each vertex is moved along its ray so that
/// each layer is a sphere.
pub(super) fn divided_icosahedron<const D: usize>(radius_over_size: f64) -> Result<SimplexMesh<D>, Error> {
    let n = (MEAN_EDGE * radius_over_size).round().max(1.0);
    affordable(20.0 * n.powi(3))?;
    let n = n as usize;
    let corners = corners();
    // A vertex lies on the ray of a weighted mean of corners. Keys: these corners with their positive weights.
    let mut numbers: HashMap<[(usize, usize); 4], VertexId> = HashMap::new();
    let (mut vertices, mut cells) = (Vec::new(), Vec::new());
    let parts = divided_simplex(n);
    for tetrahedron in tetrahedra() {
        for part in &parts {
            let mut cell = part.map(|weights| {
                let mut key = [(CENTRE, 0); 4];
                let used = tetrahedron.into_iter().zip(weights).filter(|(_, weight)| *weight > 0);
                key.iter_mut().zip(used).for_each(|(slot, found)| *slot = found);
                *numbers.entry(key).or_insert_with(|| {
                    let along = |axis: usize| key.iter().map(|&(k, weight)| corners[k][axis] * weight as f64).sum();
                    let ray = Vector::<D>::from_fn(|axis, _| along(axis));
                    let level = (n - weights[0]) as f64 / n as f64;
                    vertices.push(ray.try_normalize(0.0).map_or(ray, |ray| ray * level));
                    VertexId::new(vertices.len() - 1)
                })
            });
            let points: Vec<Point<D>> = cell.iter().map(|vertex| vertices[vertex.index()]).collect();
            if Simplex::new(&points).volume() < 0.0 {
                cell.swap(2, 3);
            }
            cells.extend(cell);
        }
    }
    SimplexMesh::new(vertices, cells)
}

/// Returns the centre and the corners of the icosahedron: the poles, the upper ring, the lower ring.
fn corners() -> Vec<[f64; 3]> {
    let (height, radius) = (1.0 / 5.0_f64.sqrt(), 2.0 / 5.0_f64.sqrt());
    let ring = |height: f64, first: f64| {
        (0..5).map(move |k| {
            let angle = 2.0 * PI * (f64::from(k) + first) / 5.0;
            [radius * angle.cos(), radius * angle.sin(), height]
        })
    };
    let poles = [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    poles.into_iter().chain(ring(height, 0.0)).chain(ring(-height, 0.5)).collect()
}

/// Returns the centre and a face of the icosahedron, 20 times, in ascending order of the corners.
fn tetrahedra() -> impl Iterator<Item = [usize; 4]> {
    let (upper, lower) = (|k: usize| 3 + k % 5, |k: usize| 8 + k % 5);
    let faces = move |k: usize| {
        [
            [1, upper(k), upper(k + 1)],
            [upper(k), upper(k + 1), lower(k)],
            [upper(k + 1), lower(k), lower(k + 1)],
            [2, lower(k), lower(k + 1)],
        ]
    };
    (0..5).flat_map(faces).map(|mut face| {
        face.sort_unstable();
        [CENTRE, face[0], face[1], face[2]]
    })
}

/// Divides a tetrahedron into `n³`. Each corner of a part is given by the weights of the four corners, with the sum
/// `n`.
///
/// The division of a face depends only on the order of its corners, so that the divisions of neighbours match.
///
/// Source: Freudenthal's division of a simplex, Bey 2000, Numer. Math. 85, doi:10.1007/s002110050475.
fn divided_simplex(n: usize) -> Vec<[[usize; 4]; 4]> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let cubes = (0..n).flat_map(|x| (0..=x).flat_map(move |y| (0..=y).map(move |z| [x, y, z])));
    let path = |cube: [usize; 3], order: [usize; 3]| {
        let mut at = cube;
        let mut corners = [at; 4];
        for (corner, axis) in corners[1..].iter_mut().zip(order) {
            at[axis] += 1;
            *corner = at;
        }
        corners
    };
    let parts = cubes.flat_map(|cube| ORDERS.into_iter().map(move |order| path(cube, order)));
    let is_inside = |[x, y, z]: &[usize; 3]| *x <= n && y <= x && z <= y;
    let inside = parts.filter(|part| part.iter().all(is_inside));
    inside.map(|part| part.map(|[x, y, z]| [n - x, x - y, y - z, z])).collect()
}
