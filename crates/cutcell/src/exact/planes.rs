//! Planes defined by points of the input, and corners defined by the planes that intersect there.
//!
//! Every plane is defined by `D` points with floating-point coordinates. Every corner of every piece of a cut is such a
//! point or the intersection of `D` planes, so the signed distance of a corner from a plane is a rational function of
//! the input. Its sign is computed with rounded numbers if they are certain, otherwise from vertices and edges that the
//! planes share, and otherwise with exact arithmetic. The stored coordinates of a corner are rounded.

use mesh::{Point, SimplexMesh, Vector};

use super::crossing::{cross_of_differences, determinant};
use super::integer::Exact;
use super::number::{Double, Number};
use super::plane::{HalfSpace, Plane, PlaneKind};
use super::solved::{Cache, Known, Solved};
use crate::surface::Facet;

/// A corner of a piece: a point of the input, or the rounded intersection of `D` planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner<const D: usize> {
    pub(crate) x: Point<D>,
    /// Bound of the error of the rounded point; zero for points of the input.
    error: f64,
    /// Planes that intersect here; only the first `D` are used.
    on: [Plane; 3],
    /// Index of the surface vertex at this corner, or [`NONE`].
    vertex: u32,
}

/// Index at corners without a surface vertex.
const NONE: u32 = u32::MAX;

impl<const D: usize> Corner<D> {
    /// Creates a corner at a vertex of the background.
    pub(crate) fn of_mesh(x: Point<D>, on: [Plane; 3]) -> Self {
        Self { x, error: 0.0, on, vertex: NONE }
    }

    /// Creates a corner at a vertex of a surface.
    pub(crate) fn of_surface(x: Point<D>, on: [Plane; 3], vertex: u32) -> Self {
        Self { x, error: 0.0, on, vertex }
    }
}

/// All planes of an overlay.
#[derive(Clone, Copy)]
pub(crate) struct Planes<'a, const D: usize> {
    pub(crate) background: &'a SimplexMesh<D>,
    pub(crate) facets: &'a [Facet<D>],
    /// Round-off of the coordinates of the background.
    pub(crate) resolution: f64,
}

impl<const D: usize> Planes<'_, D> {
    /// Returns a plane in rounded numbers.
    pub(crate) fn half_space(&self, plane: Plane) -> HalfSpace<D> {
        match plane.kind() {
            PlaneKind::Mesh(_) => HalfSpace::through(&self.points(plane)[..D]),
            PlaneKind::Facet(f) => self.facets[f as usize].plane,
            PlaneKind::Rim(f, local) => self.facets[f as usize].rims[local],
        }
    }

    /// Returns the points that define a plane; only the first `D` are used.
    fn points(&self, plane: Plane) -> [Point<D>; 3] {
        match plane.kind() {
            PlaneKind::Mesh(facet) => self.background.facet_points(facet),
            PlaneKind::Facet(f) => {
                let mut points = [Point::zeros(); 3];
                points[..D].copy_from_slice(self.facets[f as usize].points());
                points
            }
            PlaneKind::Rim(f, local) => self.facets[f as usize].rim_points(local),
        }
    }

    /// Returns the surface vertices on a plane that follow from its definition, and their number.
    fn vertices(&self, plane: Plane) -> ([u32; 3], usize) {
        match plane.kind() {
            PlaneKind::Mesh(_) => ([0; 3], 0),
            PlaneKind::Facet(f) => (self.facets[f as usize].vertices, D),
            PlaneKind::Rim(f, local) => {
                let v = &self.facets[f as usize].vertices;
                ([v[local], v[(local + 1) % D], 0], D - 1)
            }
        }
    }

    /// Returns the signed distance of a corner from a plane, positive in front of it, with exact sign.
    #[inline(always)]
    pub(crate) fn side(&self, corner: &Corner<D>, plane: Plane, half_space: &HalfSpace<D>, known: &mut Known) -> f64 {
        let (distance, doubt) = half_space.distance(&corner.x);
        if distance.abs() > doubt + corner.error { distance } else { self.side_in_doubt(corner, plane, known) }
    }

    /// Computes the signed distance if rounded coordinates are not sufficient.
    #[inline(never)]
    fn side_in_doubt(&self, corner: &Corner<D>, plane: Plane, known: &mut Known) -> f64 {
        if corner.on[..D].contains(&plane) || self.meet_known(corner, plane) {
            0.0
        } else {
            self.exact_side(corner, plane, known)
        }
    }

    /// Returns whether a facet lies on a plane.
    pub(crate) fn lies_on(&self, facet: u32, plane: Plane) -> bool {
        let (of, half_space, on) = (&self.facets[facet as usize], self.half_space(plane), [Plane::facet(facet); 3]);
        let mut known = Known::default();
        let corner = |k: usize| Corner::of_surface(of.points()[k], on, of.vertices[k]);
        (0..D).all(|k| self.side(&corner(k), plane, &half_space, &mut known) == 0.0)
    }

    /// Returns whether the corner lies on the plane because both contain the same vertex or edge of a surface.
    fn meet_known(&self, corner: &Corner<D>, plane: Plane) -> bool {
        let (vertices, n) = self.vertices(plane);
        let vertices = &vertices[..n];
        if n == 0 {
            return false;
        }
        if corner.vertex != NONE && vertices.contains(&corner.vertex) {
            return true;
        }
        let others = corner.on.map(|other| self.vertices(other));
        let contains = |i: usize, v: &u32| others[i].0[..others[i].1].contains(v);
        let common = |i: usize, j: usize| vertices.iter().filter(|v| contains(i, v) && contains(j, v)).count();
        (0..D).any(|i| (0..i).any(|j| common(i, j) >= D - 1))
    }

    #[cold]
    fn exact_side(&self, corner: &Corner<D>, plane: Plane, known: &mut Known) -> f64 {
        let key = (corner.on, corner.vertex, plane);
        if let Some(&side) = known.sides.get(&key) {
            return side;
        }
        let points = self.points(plane);
        let side = if corner.error == 0.0 {
            -determinant(&points[..D], &corner.x) / normal_length(&points[..D])
        } else {
            let ratio = self.ratio::<Double>(&corner.on, plane, known);
            ratio
                .or_else(|| self.ratio::<Exact>(&corner.on, plane, known))
                .map_or(0.0, |[ratio, sign]| sign * (ratio / normal_length(&points[..D])).abs().max(f64::MIN_POSITIVE))
        };
        known.sides.insert(key, side);
        side
    }

    /// Returns `n · (x - p)` and its sign, for the intersection `x` of planes and another plane with the normal `n`
    /// through the point `p`. `None` if the sign is uncertain or zero.
    fn ratio<N: Number>(&self, on: &[Plane; 3], plane: Plane, known: &mut impl Cache<N>) -> Option<[f64; 2]> {
        let solved = known.solved();
        self.solve_corner(on, solved);
        self.solve_plane(plane, solved);
        let ((x, w), (normal, offset)) = (&solved.corners[on], &solved.planes[&plane]);
        let terms =
            [(true, offset, w), (false, &normal[0], &x[0]), (false, &normal[1], &x[1]), (false, &normal[2], &x[2])];
        let sum = N::sum_of_products(&terms[..=D]);
        let (numerator, denominator) = (sum.certain()?, w.certain()?);
        (numerator != 0.0 && denominator != 0.0).then(|| [sum.over(w), numerator.signum() * denominator.signum()])
    }

    fn solve_plane<N: Number>(&self, plane: Plane, solved: &mut Solved<N>) {
        solved.planes.entry(plane).or_insert_with(|| coefficients::<N, D>(&self.points(plane)));
    }

    fn solve_corner<N: Number>(&self, on: &[Plane; 3], solved: &mut Solved<N>) {
        if !solved.corners.contains_key(on) {
            on.iter().for_each(|&plane| self.solve_plane(plane, solved));
            let corner = meet::<N, D>(on.map(|plane| &solved.planes[&plane]));
            solved.corners.insert(*on, corner);
        }
    }

    /// Computes the corner in which the edge between two corners crosses a plane. `ends` are the two corners with their
    /// distances from the plane, of opposite signs; `on` are the `D` planes through the corner, the crossed one last.
    pub(crate) fn crossing(
        &self,
        ends: [(&Corner<D>, f64); 2],
        on: [Plane; 3],
        half_space: &HalfSpace<D>,
        known: &mut Known,
    ) -> Corner<D> {
        if let Some(corner) = self.common_vertex(on) {
            return corner;
        }
        let [(a, at_a), (b, at_b)] = ends;
        let along = b.x - a.x;
        let x = a.x + along * (at_a / (at_a - at_b));
        let off = a.error.max(b.error);
        let doubt = off + half_space.distance(&a.x).1.max(half_space.distance(&b.x).1);
        // An upper bound of the length of the edge.
        let length: f64 = along.iter().map(|c| c.abs()).sum();
        let error = off + self.resolution + length * doubt / (at_a - at_b).abs();
        let good = |error: f64| error <= 1024.0 * self.resolution;
        if good(error) {
            return Corner { x, error, on, vertex: NONE };
        }
        // If planes intersect at small angles, errors accumulate from corner to corner; errors of the planes do not.
        match self.on_planes(&x, &on) {
            Some((x, error)) if good(error) => Corner { x, error, on, vertex: NONE },
            _ => self.exact_crossing(on, x, error, known),
        }
    }

    /// Computes the intersection of planes near `x` by one step of Newton's method, and the bound of its error.
    fn on_planes(&self, x: &Point<D>, on: &[Plane; 3]) -> Option<(Point<D>, f64)> {
        let half_spaces = on.map(|plane| self.half_space(plane));
        let n = half_spaces.map(|half_space| half_space.normal);
        // Columns of the inverse of the matrix of normals, times its determinant.
        let columns: [Vector<D>; 3] = std::array::from_fn(|k| {
            if D == 2 {
                let other = n[1 - k.min(1)];
                let sign = if k == 0 { 1.0 } else { -1.0 };
                return Vector::from_fn(|i, _| if i == 0 { sign * other[1] } else { -sign * other[0] });
            }
            let (a, b) = (n[(k + 1) % 3], n[(k + 2) % 3]);
            Vector::from_fn(|i, _| a[(i + 1) % D] * b[(i + 2) % D] - a[(i + 2) % D] * b[(i + 1) % D])
        });
        let determinant = n[0].dot(&columns[0]);
        if determinant.abs() < 1e-6 {
            return None;
        }
        let mut step = Vector::<D>::zeros();
        let mut error = 4.0 * self.resolution;
        for (half_space, column) in half_spaces.iter().zip(&columns).take(D) {
            let (distance, doubt) = half_space.distance(x);
            let column = column / determinant;
            step -= column * distance;
            error += 2.0 * column.norm() * doubt;
        }
        // Error of the step due to the errors of the normals and the determinant.
        let slack = half_spaces.iter().fold(16.0 * f64::EPSILON, |slack, half_space| slack.max(half_space.slack));
        Some((x + step, error + 6.0 * slack / determinant.abs() * step.norm()))
    }

    /// Returns the surface vertex in which the planes intersect, if it follows from their definitions.
    fn common_vertex(&self, on: [Plane; 3]) -> Option<Corner<D>> {
        if on[..D].iter().any(|plane| plane.is_mesh()) {
            return None;
        }
        let vertices = on.map(|plane| self.vertices(plane));
        let (own, n) = vertices[D - 1];
        let vertex = own[..n].iter().find(|&v| vertices[..D - 1].iter().all(|(others, m)| others[..*m].contains(v)))?;
        let (PlaneKind::Facet(f) | PlaneKind::Rim(f, _)) = on[D - 1].kind() else { return None };
        let facet = &self.facets[f as usize];
        let k = facet.vertices[..D].iter().position(|v| v == vertex)?;
        Some(Corner::of_surface(facet.points()[k], on, *vertex))
    }

    #[cold]
    fn exact_crossing(&self, on: [Plane; 3], rounded: Point<D>, error: f64, known: &mut Known) -> Corner<D> {
        let rounded = Corner { x: rounded, error, on, vertex: NONE };
        let good = |corner: &Corner<D>| corner.error <= 8.0 * self.resolution;
        let double = self.coordinates::<Double>(&rounded, known).filter(good);
        double.or_else(|| self.coordinates::<Exact>(&rounded, known)).unwrap_or(rounded)
    }

    /// Recomputes the coordinates of a corner with numbers of kind `N`.
    fn coordinates<N: Number>(&self, corner: &Corner<D>, known: &mut impl Cache<N>) -> Option<Corner<D>> {
        let solved = known.solved();
        self.solve_corner(&corner.on, solved);
        let (numerators, denominator) = &solved.corners[&corner.on];
        let w = denominator.certain().filter(|w| *w != 0.0)?;
        let mut x = corner.x;
        let mut doubt = f64::MIN_POSITIVE;
        for k in 0..D {
            x[k] = numerators[k].over(denominator);
            doubt += (numerators[k].doubt() + denominator.doubt() * x[k].abs()) / w.abs();
        }
        Some(Corner { x, error: 4.0 * f64::EPSILON * x.amax() + doubt, ..*corner })
    }
}

/// Returns the length of the normal of a plane through points: the ratio of a determinant to the distance.
fn normal_length<const D: usize>(points: &[Point<D>]) -> f64 {
    let measure = mesh::simplex_measure(points);
    if D == 2 {
        return measure;
    }
    let sides = [points[1] - points[0], points[2] - points[0]];
    // The rounded measure of a needle would be inaccurate.
    if measure > 1e-6 * sides[0].norm_squared().max(sides[1].norm_squared()) {
        2.0 * measure
    } else {
        Vector::<3>::from(cross_of_differences([&points[1], &points[0]], [&points[2], &points[0]])).norm()
    }
}

/// Computes the intersection of planes: numerators of the coordinates, and their common denominator.
fn meet<N: Number, const D: usize>(planes: [&([N; 3], N); 3]) -> ([N; 3], N) {
    let [(a, p), (b, q), (c, r)] = planes;
    if D == 2 {
        let minor = |p: &N, q: &N, r: &N, s: &N| N::sum_of_products(&[(false, p, s), (true, q, r)]);
        let numerators = [minor(p, q, &a[1], &b[1]), minor(q, p, &b[0], &a[0]), N::default()];
        return (numerators, minor(&a[0], &a[1], &b[0], &b[1]));
    }
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let x = std::array::from_fn(|k| N::sum_of_products(&[(false, p, &bc[k]), (false, q, &ca[k]), (false, r, &ab[k])]));
    (x, N::sum_of_products(&[(false, &a[0], &bc[0]), (false, &a[1], &bc[1]), (false, &a[2], &bc[2])]))
}

/// Computes the normal of the plane through points, and its scalar product with the points of the plane.
fn coefficients<N: Number, const D: usize>(points: &[Point<D>; 3]) -> ([N; 3], N) {
    let difference = |p: usize| -> [N; 3] {
        std::array::from_fn(|k| if k < D { N::difference(points[p][k], points[0][k]) } else { N::default() })
    };
    let a = difference(1);
    let normal = if D == 2 {
        let [_, y, zero] = a;
        [y, N::difference(points[0][0], points[1][0]), zero]
    } else {
        cross(&a, &difference(2))
    };
    let x: [N; 3] = std::array::from_fn(|k| if k < D { N::of(points[0][k]) } else { N::default() });
    let terms = [(false, &normal[0], &x[0]), (false, &normal[1], &x[1]), (false, &normal[2], &x[2])];
    let offset = N::sum_of_products(&terms[..D]);
    (normal, offset)
}

fn cross<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        N::sum_of_products(&[(false, &a[i], &b[j]), (true, &a[j], &b[i])])
    })
}
