//! Triangulations of convex polygons with triangles that follow a size field.

use spade::{DelaunayTriangulation, HierarchyHintGenerator, Point2, PositionInTriangulation, Triangulation};

use super::size::affordable;
use crate::{Error, Point, SimplexMesh, VertexId};

/// Largest ratio of the circumradius of a triangle to that of the equilateral triangle of the specified size.
const COARSE: f64 = 1.25;
/// Smallest distance of inserted points relative to the specified size.
const CLOSEST: f64 = 0.72;
/// Range of the mean edge length at a point, relative to the specified size. Below this range the point is removed,
/// above it a neighbour is added.
const LENGTHS: std::ops::Range<f64> = 0.84..1.19;
/// Triangles with smaller angles are repaired.
const GOOD_ANGLE: f64 = 30.0;
/// Largest number of rounds of balancing and of repair.
const ROUNDS: [usize; 2] = [8, 12];
/// Numbers of passes of smoothing after insertion, balancing and repair.
const PASSES: [usize; 3] = [20, 10, 15];

/// A Delaunay triangulation with fast location of points.
type Searchable = DelaunayTriangulation<Point2<f64>, (), (), (), HierarchyHintGenerator<f64>>;

/// Boundary points of a convex polygon, counter-clockwise.
#[derive(Default)]
pub(super) struct Outline {
    points: Vec<[f64; 2]>,
}

impl Outline {
    /// Appends a side without its last point, which is the first point of the next side.
    pub(super) fn side(&mut self, points: impl Iterator<Item = [f64; 2]>) {
        self.points.extend(points);
        self.points.pop();
    }
}

/// Triangulates a polygon with edges of length about `h`, a function of the position, without new points on its
/// boundary.
///
/// Inserts circumcentres of triangles that are too coarse, the worst first. Then moves points to the weighted centroids
/// of their neighbourhoods, and updates the Delaunay triangulation. Between these passes, removes points where edges
/// are too short, adds points where they are too long, and does both where angles are small. The result is
/// deterministic.
pub(super) fn filled<const D: usize>(outline: Outline, h: impl Fn([f64; 2]) -> f64) -> Result<SimplexMesh<D>, Error> {
    let n_fixed = outline.points.len();
    let mut points = outline.points;
    insert(&mut points, &h)?;
    let mut best = smoothed(&mut points, n_fixed, &h, PASSES[0])?;
    for _ in 0..ROUNDS[0] {
        if !balance(&mut points, &best.triangles, n_fixed, &h) {
            break;
        }
        best = smoothed(&mut points, n_fixed, &h, PASSES[1])?;
    }
    for _ in 0..ROUNDS[1] {
        if best.smallest_angle >= GOOD_ANGLE.to_radians() || !repair(&mut points, n_fixed, &h)? {
            break;
        }
        let candidate = smoothed(&mut points, n_fixed, &h, PASSES[2])?;
        if candidate.smallest_angle > best.smallest_angle {
            best = candidate;
        }
    }
    let vertices = best.points.iter().map(|p| Point::from_fn(|axis, _| p[axis])).collect();
    SimplexMesh::new(vertices, best.triangles.into_iter().flatten().map(VertexId::new).collect())
}

struct Triangulated {
    points: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    smallest_angle: f64,
}

fn smoothed(
    points: &mut [[f64; 2]],
    n_fixed: usize,
    h: &impl Fn([f64; 2]) -> f64,
    passes: usize,
) -> Result<Triangulated, Error> {
    for _ in 0..passes {
        smooth(points, n_fixed, h)?;
    }
    let triangles = triangles(points)?;
    let angle = |t: &[usize; 3]| smallest_angle(&t.map(|v| points[v]));
    let smallest_angle = triangles.iter().map(angle).fold(f64::INFINITY, f64::min);
    Ok(Triangulated { points: points.to_vec(), triangles, smallest_angle })
}

/// Removes points with short edges and adds points next to points with long edges. Returns whether points have changed.
fn balance(points: &mut Vec<[f64; 2]>, triangles: &[[usize; 3]], n_fixed: usize, h: &impl Fn([f64; 2]) -> f64) -> bool {
    let mut lengths = vec![(0.0, 0.0); points.len()];
    for triangle in triangles {
        for k in 0..3 {
            let (v, w) = (triangle[k], triangle[(k + 1) % 3]);
            let relative = distance(points[v], points[w]) / h(midpoint(points[v], points[w]));
            for end in [v, w] {
                lengths[end] = (lengths[end].0 + relative, lengths[end].1 + 1.0);
            }
        }
    }
    let mut touched = vec![false; points.len()];
    let mut removed = vec![false; points.len()];
    let mut added = Vec::new();
    for triangle in triangles {
        if triangle.iter().any(|&v| touched[v]) {
            continue;
        }
        let relative = triangle.map(|v| lengths[v].0 / lengths[v].1);
        if let Some(k) = (0..3).find(|&k| triangle[k] >= n_fixed && relative[k] < LENGTHS.start) {
            removed[triangle[k]] = true;
        } else if relative.iter().any(|&r| r > LENGTHS.end) {
            added.push(centroid(&triangle.map(|v| points[v])));
        } else {
            continue;
        }
        triangle.iter().for_each(|&v| touched[v] = true);
    }
    replace(points, &removed, added)
}

/// Removes and adds points. Returns whether points have changed.
fn replace(points: &mut Vec<[f64; 2]>, removed: &[bool], added: Vec<[f64; 2]>) -> bool {
    let before = points.len();
    let mut keep = removed.iter().map(|r| !r);
    points.retain(|_| keep.next().unwrap_or(true));
    let changed = points.len() < before || !added.is_empty();
    points.extend(added);
    changed
}

/// Removes a point at each triangle with a small angle if its edges are too short, or adds one if they are too long.
/// Returns whether points have changed.
fn repair(points: &mut Vec<[f64; 2]>, n_fixed: usize, h: &impl Fn([f64; 2]) -> f64) -> Result<bool, Error> {
    let mut touched = vec![false; points.len()];
    let mut removed = vec![false; points.len()];
    let mut added = Vec::new();
    for triangle in triangles(points)? {
        let corners = triangle.map(|v| points[v]);
        if smallest_angle(&corners) >= GOOD_ANGLE.to_radians() || triangle.iter().any(|&v| touched[v]) {
            continue;
        }
        let relative = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            distance(a, b) / h(midpoint(a, b))
        };
        let (mut shortest, mut longest) = (0, 0);
        for k in 1..3 {
            if relative(k) < relative(shortest) {
                shortest = k;
            }
            if relative(k) > relative(longest) {
                longest = k;
            }
        }
        let short = [triangle[shortest], triangle[(shortest + 1) % 3]];
        let long = [triangle[longest], triangle[(longest + 1) % 3]];
        let last = short[0].max(short[1]);
        if last >= n_fixed && relative(shortest) * relative(longest) < 1.0 {
            removed[last] = true;
        } else if long[0].max(long[1]) >= n_fixed {
            added.push(midpoint(corners[longest], corners[(longest + 1) % 3]));
        } else {
            continue;
        }
        triangle.iter().for_each(|&v| touched[v] = true);
    }
    Ok(replace(points, &removed, added))
}

/// Adds circumcentres until no triangle is too coarse.
fn insert(points: &mut Vec<[f64; 2]>, h: &impl Fn([f64; 2]) -> f64) -> Result<(), Error> {
    let positions = points.iter().map(|p| Point2::new(p[0], p[1])).collect();
    let mut delaunay = Searchable::bulk_load_stable(positions).map_err(failed)?;
    loop {
        let mut coarse: Vec<(f64, [f64; 2])> = Vec::new();
        for face in delaunay.inner_faces() {
            let corners = face.positions().map(|p| [p.x, p.y]);
            let (circumcentre, radius_squared) = face.circumcircle();
            let centroid = centroid(&corners);
            let excess = (3.0 * radius_squared).sqrt() / h(centroid);
            if excess > COARSE {
                let inside = matches!(delaunay.locate(circumcentre), PositionInTriangulation::OnFace(_));
                coarse.push((excess, if inside { [circumcentre.x, circumcentre.y] } else { centroid }));
            }
        }
        coarse.sort_by(|a, b| b.0.total_cmp(&a.0));
        let before = points.len();
        for (_, x) in coarse {
            let position = Point2::new(x[0], x[1]);
            let Some(nearest) = delaunay.nearest_neighbor(position) else { break };
            let nearest = nearest.position();
            if distance([nearest.x, nearest.y], x) >= CLOSEST * h(x) {
                delaunay.insert(position).map_err(failed)?;
                points.push(x);
            }
        }
        affordable(2.0 * points.len() as f64)?;
        if points.len() == before {
            return Ok(());
        }
    }
}

/// Moves every free point to the mean of the centroids of its triangles, with the weights area over `h³`.
fn smooth(points: &mut [[f64; 2]], n_fixed: usize, h: &impl Fn([f64; 2]) -> f64) -> Result<(), Error> {
    let mut sums = vec![[0.0; 3]; points.len()];
    for triangle in triangles(points)? {
        let corners = triangle.map(|v| points[v]);
        let x = centroid(&corners);
        let weight = area(&corners) * h(x).powi(-3);
        for v in triangle {
            let sum = &mut sums[v];
            *sum = [sum[0] + weight, sum[1] + weight * x[0], sum[2] + weight * x[1]];
        }
    }
    for (point, [weight, x, y]) in points.iter_mut().zip(sums).skip(n_fixed) {
        *point = [x / weight, y / weight];
    }
    Ok(())
}

/// Returns the Delaunay triangles of the points, counter-clockwise.
fn triangles(points: &[[f64; 2]]) -> Result<Vec<[usize; 3]>, Error> {
    let positions = points.iter().map(|p| Point2::new(p[0], p[1])).collect();
    let delaunay = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(positions).map_err(failed)?;
    Ok(delaunay.inner_faces().map(|face| face.vertices().map(|v| v.index())).collect())
}

fn failed(error: spade::InsertionError) -> Error {
    Error::Triangulation { reason: error.to_string() }
}

pub(super) fn centroid(corners: &[[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|axis| (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3.0)
}

pub(super) fn area([a, b, c]: &[[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
}

pub(super) fn smallest_angle(corners: &[[f64; 2]; 3]) -> f64 {
    let angle = |k: usize| {
        let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1])
    };
    angle(0).min(angle(1)).min(angle(2))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

fn midpoint(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}
