//! Planes given by points of the input, and corners given by the planes that meet in them.
//!
//! Every plane goes through `D` points whose coordinates are floating-point numbers, every corner of every piece of
//! a cut is such a point itself or the point in which `D` planes meet. On which side of a plane a corner lies is
//! therefore a rational number of the input: it is computed with rounding as long as that is certain, from what the
//! planes are known to have in common where that suffices, and with exact arithmetic otherwise. The coordinates that a
//! corner carries are that point rounded.

use std::collections::HashMap;

use mesh::{FacetId, Point, SimplexMesh, Vector, facet_normal};

use super::crossing::{cross_of_differences, determinant};
use super::integer::Exact;
use super::number::{Double, Number};
use crate::surface::Facet;

/// Name of a plane.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Plane(u32);

/// What a plane goes through.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PlaneKind {
    /// A face of the background.
    Mesh(FacetId),
    /// A facet (index among all facets).
    Facet(u32),
    /// A rim of a facet, upright on it.
    Rim(u32, usize),
}

const MESH: u32 = 1 << 31;

impl Plane {
    pub(crate) fn mesh(facet: FacetId) -> Self {
        Self(facet.0 | MESH)
    }

    pub(crate) fn facet(facet: u32) -> Self {
        Self(4 * facet)
    }

    /// The plane through rim `local` of a facet and its normal; its front lies outside of the facet. Rim `k` of a
    /// triangle goes from corner `k` to the next one, that of a segment is its corner `k`.
    pub(crate) fn rim(facet: u32, local: usize) -> Self {
        Self(4 * facet + 1 + local as u32)
    }

    fn is_mesh(self) -> bool {
        self.0 & MESH != 0
    }

    pub(crate) fn kind(self) -> PlaneKind {
        match (self.0 & MESH, self.0 % 4) {
            (0, 0) => PlaneKind::Facet(self.0 / 4),
            (0, rim) => PlaneKind::Rim(self.0 / 4, rim as usize - 1),
            _ => PlaneKind::Mesh(FacetId(self.0 & !MESH)),
        }
    }
}

/// A plane with rounding: distances are correct up to `slack` times the distance from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace<const D: usize> {
    pub(crate) origin: Point<D>,
    /// Unit normal.
    pub(crate) normal: Vector<D>,
    slack: f64,
}

impl<const D: usize> HalfSpace<D> {
    /// Through `D` points that do not coincide (2D) or lie on a line (3D).
    pub(crate) fn through(points: &[Point<D>]) -> Self {
        if D == 2 {
            return Self { origin: points[0], normal: facet_normal(points), slack: 16.0 * f64::EPSILON };
        }
        // The two shortest sides give the normal with the least cancellation.
        let sides = [points[1] - points[0], points[2] - points[1], points[0] - points[2]];
        let squares = sides.map(|s| s.norm_squared());
        let longest = (0..3).fold(0, |l, k| if squares[k] > squares[l] { k } else { l });
        let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
        let mut n = Vector::<D>::zeros();
        for k in 0..3 {
            let (p, q) = ((k + 1) % 3, (k + 2) % 3);
            n[k] = sides[i][p] * sides[j][q] - sides[i][q] * sides[j][p];
        }
        let length = n.norm();
        let slack = f64::EPSILON * (8.0 * (squares[i] * squares[j]).sqrt() / length + 8.0);
        if slack < 1e-11 {
            return Self { origin: points[j], normal: n / length, slack };
        }
        // A needle: the round-off of its sides would turn the normal.
        let n = cross_of_differences([&points[1], &points[0]], [&points[2], &points[0]]);
        let n = Vector::<D>::from_fn(|k, _| n[k]);
        Self { origin: points[j], normal: n / n.norm(), slack: 16.0 * f64::EPSILON }
    }

    /// Distance of a point from the plane, positive in front of it, and how wrong it may be.
    #[inline]
    pub(crate) fn distance(&self, x: &Point<D>) -> (f64, f64) {
        let r = x - self.origin;
        (self.normal.dot(&r), self.slack * r.iter().map(|c| c.abs()).sum::<f64>())
    }
}

/// A corner of a piece: a point of the input, or the point in which `D` planes meet, rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner<const D: usize> {
    pub(crate) x: Point<D>,
    /// How far the rounded point may be off; zero for points of the input.
    error: f64,
    /// Planes that meet here; the first `D` count.
    on: [Plane; 3],
    /// Number of the vertex of a surface that this is, or `NONE`.
    vertex: u32,
}

const NONE: u32 = u32::MAX;

impl<const D: usize> Corner<D> {
    /// A vertex of the background on known planes.
    pub(crate) fn of_mesh(x: Point<D>, on: [Plane; 3]) -> Self {
        Self { x, error: 0.0, on, vertex: NONE }
    }

    /// A vertex of a surface on known planes.
    pub(crate) fn of_surface(x: Point<D>, on: [Plane; 3], vertex: u32) -> Self {
        Self { x, error: 0.0, on, vertex }
    }
}

/// What was computed beyond ordinary precision in the cell at hand: the same planes and corners come up again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// Signed distances of corners (by their planes, and their number as a vertex) from planes.
    sides: HashMap<([Plane; 3], u32, Plane), f64>,
    pub(super) double: Solved<Double>,
    pub(super) exact: Solved<Exact>,
}

impl Known {
    pub(crate) fn clear(&mut self) {
        self.sides.clear();
        self.double.clear();
        self.exact.clear();
    }
}

/// Planes and points with numbers of one kind.
#[derive(Clone, Debug, Default)]
pub(super) struct Solved<N> {
    /// Normal of a plane, and its product with each point of the plane.
    planes: HashMap<Plane, ([N; 3], N)>,
    /// The point in which planes meet: numerators of the coordinates, and their common denominator.
    corners: HashMap<[Plane; 3], ([N; 3], N)>,
}

impl<N> Solved<N> {
    fn clear(&mut self) {
        self.planes.clear();
        self.corners.clear();
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
    /// The plane with rounding.
    pub(crate) fn half_space(&self, plane: Plane) -> HalfSpace<D> {
        match plane.kind() {
            PlaneKind::Mesh(_) => HalfSpace::through(&self.points(plane)[..D]),
            PlaneKind::Facet(f) => self.facets[f as usize].plane,
            PlaneKind::Rim(f, local) => self.facets[f as usize].rims[local],
        }
    }

    /// The points that a plane goes through; the first `D` count.
    fn points(&self, plane: Plane) -> [Point<D>; 3] {
        let mut points = [Point::zeros(); 3];
        match plane.kind() {
            PlaneKind::Mesh(facet) => {
                for (slot, &v) in points.iter_mut().zip(self.background.facet(facet)) {
                    *slot = self.background.vertex(v);
                }
            }
            PlaneKind::Facet(f) => points[..D].copy_from_slice(self.facets[f as usize].points()),
            PlaneKind::Rim(f, local) => points = self.facets[f as usize].rim_points(local),
        }
        points
    }

    /// Vertices of surfaces that a plane goes through.
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

    /// Signed distance of a corner from a plane, positive in front of it; its sign is exact.
    #[inline(always)]
    pub(crate) fn side(&self, corner: &Corner<D>, plane: Plane, half_space: &HalfSpace<D>, known: &mut Known) -> f64 {
        let (distance, doubt) = half_space.distance(&corner.x);
        if distance.abs() > doubt + corner.error { distance } else { self.side_in_doubt(corner, plane, known) }
    }

    /// The same where rounded coordinates do not tell.
    #[inline(never)]
    fn side_in_doubt(&self, corner: &Corner<D>, plane: Plane, known: &mut Known) -> f64 {
        if corner.on[..D].contains(&plane) || self.meet_known(corner, plane) {
            0.0
        } else {
            self.exact_side(corner, plane, known)
        }
    }

    /// Whether a facet lies on a plane.
    pub(crate) fn lies_on(&self, facet: u32, plane: Plane) -> bool {
        let (of, half_space, on) = (&self.facets[facet as usize], self.half_space(plane), [Plane::facet(facet); 3]);
        let mut known = Known::default();
        let corner = |k: usize| Corner::of_surface(of.points()[k], on, of.vertices[k]);
        (0..D).all(|k| self.side(&corner(k), plane, &half_space, &mut known) == 0.0)
    }

    /// Whether the plane goes through the corner because both contain the same vertex or edge of a surface.
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
        let question = (corner.on, corner.vertex, plane);
        if let Some(&side) = known.sides.get(&question) {
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
        known.sides.insert(question, side);
        side
    }

    /// The product of a point in which planes meet with the normal of another plane, less that of the plane itself, and
    /// its sign. `None` if the sign is not certain, or zero.
    fn ratio<N: Number>(&self, on: &[Plane; 3], plane: Plane, known: &mut Known) -> Option<[f64; 2]> {
        let solved = N::solved(known);
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

    /// The corner in which the edge between `a` and `b` meets a plane, with their distances of opposite signs from
    /// the plane, and the `D` planes (that one the last) that meet there.
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
        // No less than the length of the edge.
        let length: f64 = along.iter().map(|c| c.abs()).sum();
        let error = off + self.resolution + length * doubt / (at_a - at_b).abs();
        let good = |error: f64| error <= 1024.0 * self.resolution;
        if good(error) {
            return Corner { x, error, on, vertex: NONE };
        }
        // Errors grow from corner to corner where planes meet at small angles; those of the planes themselves do not.
        match self.on_planes(&x, &on) {
            Some((x, error)) if good(error) => Corner { x, error, on, vertex: NONE },
            _ => self.exact_crossing(on, x, error, known),
        }
    }

    /// The point in which planes meet near `x`, by one step of Newton's method, and how far it may be off.
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
        // What the step is wrong by with its normals and its determinant.
        let slack = half_spaces.iter().fold(16.0 * f64::EPSILON, |slack, half_space| slack.max(half_space.slack));
        Some((x + step, error + 6.0 * slack / determinant.abs() * step.norm()))
    }

    /// A vertex of a surface, if that is where the planes meet.
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

    /// The same corner with coordinates that are as good as their numbers.
    fn coordinates<N: Number>(&self, corner: &Corner<D>, known: &mut Known) -> Option<Corner<D>> {
        let solved = N::solved(known);
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

/// Length of the normal of a plane through points: what a determinant is to be divided by.
fn normal_length<const D: usize>(points: &[Point<D>]) -> f64 {
    let measure = mesh::simplex_measure(points);
    if D == 2 {
        return measure;
    }
    let sides = [points[1] - points[0], points[2] - points[0]];
    // The measure of a needle would be round-off.
    if measure > 1e-6 * sides[0].norm_squared().max(sides[1].norm_squared()) {
        2.0 * measure
    } else {
        Vector::<3>::from(cross_of_differences([&points[1], &points[0]], [&points[2], &points[0]])).norm()
    }
}

/// The point in which planes meet: numerators of the coordinates, and their common denominator.
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

/// Normal of the plane through points, and its product with each point of the plane.
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
