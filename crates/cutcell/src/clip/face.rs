//! Overlap and difference of convex faces on one plane.

use mesh::{Point, Vector};

/// Computes the overlap of two convex faces (segments in 2D, polygons in 3D) on a plane with the given normal. Writes
/// it to `out` and returns its measure, or zero if the length or width of the overlap is below `tolerance`.
///
/// Where possible, points of the overlap are points of the two faces, so that coordinates in neighbours are equal.
pub(crate) fn face_overlap<const D: usize>(
    a: &[Point<D>],
    b: &[Point<D>],
    normal: &Vector<D>,
    tolerance: f64,
    out: &mut Vec<Point<D>>,
) -> f64 {
    out.clear();
    match D {
        2 => {
            let Some(line) = Line::through(a) else { return 0.0 };
            let (a, b) = (line.sorted(a), line.sorted(b));
            let low = if a[0].0 > b[0].0 { a[0] } else { b[0] };
            let high = if a[1].0 < b[1].0 { a[1] } else { b[1] };
            if high.0 - low.0 <= tolerance {
                return 0.0;
            }
            out.extend([low.1, high.1]);
            (high.1 - low.1).norm()
        }
        _ => {
            // The directions of the sides of a needle are round-off.
            let length = b.iter().map(|x| (x - b[0]).norm()).fold(0.0, f64::max);
            if polygon_area(b, normal) <= tolerance * length {
                return 0.0;
            }
            out.extend_from_slice(a);
            for_each_side(b, normal, tolerance, |origin, outward| clip(out, &origin, &outward));
            simplify(out, tolerance);
            let area = polygon_area(out, normal);
            if area <= tolerance * tolerance {
                out.clear();
                return 0.0;
            }
            area
        }
    }
}

/// Appends face `a` without face `b` to `out`, as convex faces.
pub(crate) fn face_difference<const D: usize>(
    a: &[Point<D>],
    b: &[Point<D>],
    normal: &Vector<D>,
    tolerance: f64,
    out: &mut Vec<Vec<Point<D>>>,
) {
    match D {
        2 => {
            let Some(line) = Line::through(a) else { return };
            let (a, b) = (line.sorted(a), line.sorted(b));
            for (low, high) in
                [(a[0], if b[0].0 < a[1].0 { b[0] } else { a[1] }), (if b[1].0 > a[0].0 { b[1] } else { a[0] }, a[1])]
            {
                if high.0 - low.0 > tolerance {
                    out.push(vec![low.1, high.1]);
                }
            }
        }
        _ => {
            let mut rest = a.to_vec();
            for_each_side(b, normal, tolerance, |origin, outward| {
                let mut beyond = rest.clone();
                clip(&mut beyond, &origin, &-outward);
                simplify(&mut beyond, tolerance);
                if polygon_area(&beyond, normal) > tolerance * tolerance {
                    out.push(beyond);
                }
                clip(&mut rest, &origin, &outward);
            });
        }
    }
}

/// A line with a coordinate along it.
struct Line<const D: usize> {
    origin: Point<D>,
    direction: Vector<D>,
}

impl<const D: usize> Line<D> {
    fn through(segment: &[Point<D>]) -> Option<Self> {
        let [a, b] = segment else { return None };
        let length = (b - a).norm();
        (length > 0.0).then(|| Self { origin: *a, direction: (b - a) / length })
    }

    fn sorted(&self, segment: &[Point<D>]) -> [(f64, Point<D>); 2] {
        let at = |x: &Point<D>| ((x - self.origin).dot(&self.direction), *x);
        let (a, b) = (at(&segment[0]), at(&segment[segment.len() - 1]));
        if a.0 <= b.0 { [a, b] } else { [b, a] }
    }
}

/// Calls `visit` with a point and the outward in-plane direction of each side of a convex polygon of any orientation.
fn for_each_side<const D: usize>(
    polygon: &[Point<D>],
    normal: &Vector<D>,
    tolerance: f64,
    mut visit: impl FnMut(Point<D>, Vector<D>),
) {
    let mut corners = polygon.to_vec();
    simplify(&mut corners, tolerance);
    let centre = mesh::mean(&corners);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let outward = cross(&(b - a), normal);
        let length = outward.norm();
        if length > 0.0 {
            let sign = if outward.dot(&(centre - a)) > 0.0 { -1.0 } else { 1.0 };
            visit(*a, outward * (sign / length));
        }
    }
}

/// Removes points within the tolerance of the line between their neighbours. The direction of a side between two points
/// that differ by round-off would be arbitrary.
fn simplify<const D: usize>(polygon: &mut Vec<Point<D>>, tolerance: f64) {
    let mut k = 0;
    while k < polygon.len() && polygon.len() > 3 {
        let n = polygon.len();
        let (before, after) = (polygon[(k + n - 1) % n], polygon[(k + 1) % n]);
        let along = after - before;
        let length = along.norm();
        let offset = polygon[k] - before;
        let distance = if length > tolerance {
            (offset - along * (offset.dot(&along) / (length * length))).norm()
        } else {
            // The neighbours coincide, so the corner between them has no area.
            0.0
        };
        if distance <= tolerance || offset.norm() <= tolerance {
            polygon.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
}

/// Clips a polygon to the half plane behind the line through `origin` with the given outward direction.
fn clip<const D: usize>(polygon: &mut Vec<Point<D>>, origin: &Point<D>, outward: &Vector<D>) {
    let distance = |x: &Point<D>| outward.dot(&(x - origin));
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (da, db) = (distance(a), distance(&b));
        if da <= 0.0 {
            kept.push(*a);
        }
        if da * db < 0.0 {
            kept.push(a + (b - a) * (da / (da - db)));
        }
    }
    *polygon = kept;
}

fn polygon_area<const D: usize>(polygon: &[Point<D>], normal: &Vector<D>) -> f64 {
    let mut twice = Vector::<D>::zeros();
    for k in 1..polygon.len().saturating_sub(1) {
        twice += cross(&(polygon[k] - polygon[0]), &(polygon[k + 1] - polygon[0]));
    }
    0.5 * twice.dot(normal).abs()
}

fn cross<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    let mut c = Vector::zeros();
    for k in 0..D {
        let (i, j) = ((k + 1) % D, (k + 2) % D);
        c[k] = a[i] * b[j] - a[j] * b[i];
    }
    c
}
