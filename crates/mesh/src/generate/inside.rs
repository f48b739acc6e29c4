//! Triangulations of plane regions between closed lines.

use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use super::closed_line::ClosedLine;
use super::region::Region;
use super::size::{MEAN_EDGE, Size, affordable};
use super::triangulate::{area, centroid, smallest_angle};
use crate::{Aabb, Error, Point, SimplexMesh, VertexId, positive};

/// Smallest angle at which refinement aims, degrees. Smoothing may make larger angles smaller, down to this one.
const GOOD_ANGLE: f64 = 28.0;
/// Largest area of a triangle, relative to that of the equilateral triangle with the mean edge. With this ratio mean
/// edges are as long as in other generators.
const LARGEST: f64 = 1.55;
/// Largest number of inserted points per given point and per triangle of the largest area.
const SPARE: f64 = 10.0;
/// Number of passes of smoothing.
const PASSES: usize = 15;
/// Largest relative difference of areas that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Generates triangles in the inside of the first line without the insides of the others, which are holes.
///
/// The segments of the lines are the boundary facets, with their names as tags; their points are the first vertices, in
/// order. The mean diameter of the cells is about `size`. Angles are at least 20 degrees where neither the angles nor
/// the distances of the lines demand smaller ones.
///
/// Source: Delaunay refinement, Ruppert 1995, J. Algorithms 18(3), doi:10.1006/jagm.1995.1021; then every free vertex
/// moves to the centroid of its triangles as long as no angle becomes bad.
///
/// # Errors
/// [`Error::Parameter`]: the size is not positive, or there are too many cells. [`Error::Triangulation`]: lines that
/// cross or touch, or holes outside. [`Error::Dimension`]: `D` is not 2.
pub fn inside<const D: usize>(lines: &[ClosedLine], size: f64) -> Result<SimplexMesh<D>, Error> {
    refined_inside(lines, size, &[])
}

/// Generates triangles as [`inside`] does, with finer cells near regions: the smallest of all sizes at a point is used.
///
/// The segments of the lines are not divided. [`ClosedLine::graded_polygon`] and [`ClosedLine::graded_smooth`] create
/// lines with segments that follow the size.
///
/// # Errors
/// As [`inside`] and [`Region::check`] with the box around the lines.
pub fn refined_inside<const D: usize>(
    lines: &[ClosedLine],
    size: f64,
    regions: &[Region<D>],
) -> Result<SimplexMesh<D>, Error> {
    if D != 2 {
        return Err(Error::Dimension { shape: "a region between lines", dimension: D });
    }
    positive("size", size)?;
    let areas: Vec<f64> = lines.iter().map(|line| line.area().abs()).collect();
    let expected = areas.iter().take(1).sum::<f64>() - areas.iter().skip(1).sum::<f64>();
    let largest = |h: f64| LARGEST * 0.25 * 3.0_f64.sqrt() * (MEAN_EDGE * h).powi(2);
    affordable(2.0 * expected / largest(size))?;
    let at = |x: [f64; 2]| Point::<D>::from_fn(|axis, _| x[axis]);
    let bounds = Aabb::of_points(&lines.iter().flat_map(|line| &line.points).map(|x| at(*x)).collect::<Vec<_>>());
    for region in regions {
        region.check(bounds.low.into(), bounds.high.into(), &Size::uniform(size))?;
    }
    let near = |x: [f64; 2]| regions.iter().map(|region| region.at(&at(x))).fold(size, f64::min);

    let given: Vec<[f64; 2]> = lines.iter().flat_map(|line| line.points.iter().copied()).collect();
    let n_fixed = given.len();
    let segments = segments(lines);
    let (mut points, triangles) = refined(given, segments.clone(), largest(size), expected, |corners| {
        !regions.is_empty() && area(corners) > largest(near(centroid(corners)))
    })?;
    let found: f64 = triangles.iter().map(|t| area(&t.map(|v| points[v]))).sum();
    if (found - expected).abs() > ROUND_OFF * areas.iter().sum::<f64>() {
        return Err(failed("a hole is not inside the outer line, or inside another hole"));
    }
    smooth(&mut points, &triangles, n_fixed, |corners| {
        area(corners) * if regions.is_empty() { 1.0 } else { near(centroid(corners)).powi(-3) }
    });
    let vertices = points.iter().map(|x| at(*x)).collect();
    let mesh = SimplexMesh::new(vertices, triangles.into_iter().flatten().map(VertexId::new).collect())?;
    let names: Vec<&str> = lines.iter().flat_map(|line| &line.names).map(String::as_str).collect();
    // Segment `k` begins at point `k`.
    let named = |[a, b]: [usize; 2]| segments.get(a).filter(|segment| segment[1] == b).map(|_| names[a]);
    let of_facet = |facet| {
        let [a, b] = [0, 1].map(|k| mesh.facet(facet)[k].index());
        named([a, b]).or_else(|| named([b, a]))
    };
    let of_facet: Vec<Option<&str>> = mesh.facets().map(of_facet).collect();
    Ok(mesh.with_facet_tags(|facet| of_facet[facet.index()]))
}

/// Returns the indices of the ends of all segments; segment `k` begins at point `k`.
fn segments(lines: &[ClosedLine]) -> Vec<[usize; 2]> {
    let mut first = 0;
    let mut segments = Vec::new();
    for line in lines {
        let n = line.points.len();
        segments.extend((0..n).map(|k| [first + k, first + (k + 1) % n]));
        first += n;
    }
    segments
}

/// Points and triangles.
type Triangles = (Vec<[f64; 2]>, Vec<[usize; 3]>);

/// Triangulates the region between segments, of area `expected`, with triangles of area `largest` at most of which none
/// is too coarse. The given points come first.
///
/// In each round, inserts the centroids of triangles that are too coarse and do not touch each other, and refines
/// again.
fn refined(
    points: Vec<[f64; 2]>,
    segments: Vec<[usize; 2]>,
    largest: f64,
    expected: f64,
    is_coarse: impl Fn(&[[f64; 2]; 3]) -> bool,
) -> Result<Triangles, Error> {
    let mut crossing = None;
    let positions = points.iter().map(|x| Point2::new(x[0], x[1])).collect();
    let found = |segment: [usize; 2]| crossing = Some(segment);
    let loaded = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(positions, segments, found);
    let mut cdt = loaded.map_err(|error| failed(error.to_string()))?;
    if cdt.num_vertices() != points.len() {
        return Err(failed("the lines touch each other, or themselves: two of their points coincide"));
    }
    // A segment that passes through another point is split into two constraints.
    if crossing.is_some() || cdt.num_constraints() != points.len() {
        let near = crossing.map(|[begin, _]| format!(" near {:?}", points[begin])).unwrap_or_default();
        return Err(failed(format!("the lines cross or touch each other{near}")));
    }
    loop {
        let most = SPARE * (expected / largest + cdt.num_vertices() as f64);
        let parameters = RefinementParameters::new()
            .keep_constraint_edges()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(GOOD_ANGLE))
            .with_max_allowed_area(largest)
            .with_max_additional_vertices(most as usize);
        let refinement = cdt.refine(parameters);
        if !refinement.refinement_complete {
            return Err(failed(
                "the lines are too near to each other, or meet at too small an angle, for triangles of this size",
            ));
        }
        let mut is_outside = vec![false; cdt.num_all_faces()];
        refinement.excluded_faces.iter().for_each(|face| is_outside[face.index()] = true);
        let faces = cdt.inner_faces().filter(|face| !is_outside[face.fix().index()]);
        let triangles: Vec<[usize; 3]> = faces.map(|face| face.vertices().map(|vertex| vertex.fix().index())).collect();
        let points: Vec<[f64; 2]> = cdt.vertices().map(|vertex| [vertex.position().x, vertex.position().y]).collect();
        affordable(2.0 * points.len() as f64)?;
        let centroids = coarse_centroids(&points, &triangles, &is_coarse);
        if centroids.is_empty() {
            return Ok((points, triangles));
        }
        for [x, y] in centroids {
            cdt.insert(Point2::new(x, y)).map_err(|error| failed(error.to_string()))?;
        }
    }
}

/// Returns the centroids of triangles that are too coarse and do not touch each other, the largest ones first.
fn coarse_centroids(
    points: &[[f64; 2]],
    triangles: &[[usize; 3]],
    is_coarse: impl Fn(&[[f64; 2]; 3]) -> bool,
) -> Vec<[f64; 2]> {
    let corners = |triangle: &[usize; 3]| triangle.map(|v| points[v]);
    let mut coarse: Vec<&[usize; 3]> = triangles.iter().filter(|triangle| is_coarse(&corners(triangle))).collect();
    coarse.sort_by(|a, b| area(&corners(b)).total_cmp(&area(&corners(a))));
    let mut is_touched = vec![false; points.len()];
    coarse.retain(|triangle| {
        let is_free = triangle.iter().all(|v| !is_touched[*v]);
        if is_free {
            triangle.iter().for_each(|v| is_touched[*v] = true);
        }
        is_free
    });
    coarse.into_iter().map(|triangle| centroid(&corners(triangle))).collect()
}

/// Moves each free point to the weighted centroid of its triangles, unless an angle that is not good becomes smaller.
fn smooth(points: &mut [[f64; 2]], triangles: &[[usize; 3]], n_fixed: usize, weight: impl Fn(&[[f64; 2]; 3]) -> f64) {
    let mut stars = vec![Vec::new(); points.len()];
    for triangle in triangles {
        triangle.iter().for_each(|&v| stars[v].push(*triangle));
    }
    let good = GOOD_ANGLE.to_radians();
    for _ in 0..PASSES {
        for v in n_fixed..points.len() {
            let corners = |points: &[[f64; 2]]| stars[v].iter().map(|t| t.map(|w| points[w])).collect::<Vec<_>>();
            let worst = |corners: &[[[f64; 2]; 3]]| corners.iter().map(smallest_angle).fold(good, f64::min);
            let before = corners(points);
            let sum = before.iter().fold([0.0; 3], |sum, corners| {
                let (weight, x) = (weight(corners), centroid(corners));
                [sum[0] + weight, sum[1] + weight * x[0], sum[2] + weight * x[1]]
            });
            let place = std::mem::replace(&mut points[v], [sum[1] / sum[0], sum[2] / sum[0]]);
            if worst(&corners(points)) < worst(&before) {
                points[v] = place;
            }
        }
    }
}

fn failed(reason: impl Into<String>) -> Error {
    Error::Triangulation { reason: reason.into() }
}
