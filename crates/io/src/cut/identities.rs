//! Identities that hold for every exact cut, and the errors in them.

use cutcell::{CellState, CutMesh, FaceLabel, PartId};
use mesh::{
    Aabb, FacetId, MAX_CELL_VERTICES, Point, QuadratureRule, SimplexMesh, SimplexRule, Vector, facet_normal,
    simplex_measure,
};

use crate::Error;

/// Largest distance of interface on a face of the background from the face, relative to the size of the cell.
const ON_FACE: f64 = 1e-9;

/// Largest relative errors of a cut. They are zero up to round-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CutErrors {
    /// `|parts + covered - |K|| / |K|`, the largest over all cells `K`.
    pub partition: f64,
    /// `|∫ n| / area` over the wet interface. If bodies reach out of the background, the interface is closed by the
    /// covered part of the boundary of the background.
    pub normals: f64,
    /// `|∫ div F - ∮ F·n| / ∫ div F` over the fluid, the larger for a linear and a quadratic `F`, with
    /// `F_a = r_a` and `F_a = r_a²`, `r` from the lowest corner of the background.
    pub divergence: f64,
    /// Area of a fluid part on a face of its cell that is not shared with parts on the other side, relative to the
    /// measure of the face; the largest over all faces of all parts. Interface that lies on the face is not shared.
    pub adjacency: f64,
    /// Largest error of a correct cut by round-off of the coordinates, relative to the size of the cells.
    pub round_off: f64,
}

/// Largest error of a correct cut, divided by the round-off of a coordinate relative to the size of its cell.
const ROUND_OFF: f64 = 64.0;

impl CutErrors {
    /// Returns an error if an identity is violated by more than round-off.
    ///
    /// # Errors
    /// [`Error::Violated`].
    pub fn check(&self) -> Result<(), Error> {
        /// Tolerance. Errors of wrong cuts are larger.
        const LARGEST: f64 = 1e-8;
        let Self { partition, normals, divergence, adjacency, round_off } = *self;
        let named =
            [("partition", partition), ("normals", normals), ("divergence", divergence), ("adjacency", adjacency)];
        let (identity, by) =
            named.into_iter().fold(named[0], |worst, next| if next.1 <= worst.1 { worst } else { next });
        if by <= LARGEST.max(round_off) { Ok(()) } else { Err(Error::Violated { identity, by }) }
    }
}

/// Measures the errors of all identities of a cut. `moment` is the value of [`quadratic_moment`].
pub(super) fn check<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, moment: f64) -> CutErrors {
    CutErrors {
        partition: partition(background, cut),
        normals: normals(background, cut),
        divergence: divergence(background, cut, moment),
        adjacency: adjacency(background, cut),
        round_off: round_off(background),
    }
}

fn round_off<const D: usize>(background: &SimplexMesh<D>) -> f64 {
    let Aabb { low, high } = Aabb::of_points(background.vertices());
    let farthest = low.amax().max(high.amax());
    let smallest = background.cells().map(|cell| background.simplex(cell).diameter()).fold(f64::INFINITY, f64::min);
    ROUND_OFF * f64::EPSILON * farthest / smallest
}

/// Returns an error relative to its scale; zero if one of them is zero.
fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 || scale == 0.0 { 0.0 } else { error / scale }
}

/// Returns the larger of two errors. NaN is larger than all numbers.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a >= b { a } else { b }
}

fn partition<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> f64 {
    let is_covered = |cell| cut.cell_state(cell) == CellState::Covered;
    let volume = |cell| if is_covered(cell) { 0.0 } else { background.cell_volume(cell) };
    let mut missing: Vec<f64> = background.cells().map(volume).collect();
    for part in cut.all_parts() {
        missing[cut.part_cell(part).index()] -= cut.part_volume(part);
    }
    for (cell, piece) in cut.covered_pieces() {
        missing[cell.index()] -= piece.volume();
    }
    let errors = background.cells().map(|cell| missing[cell.index()].abs() / background.cell_volume(cell));
    errors.fold(0.0, larger)
}

fn normals<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> f64 {
    let mut wet = vec![0.0; background.n_facets()];
    for piece in cut.boundary() {
        wet[piece.facet.index()] += piece.measure;
    }
    let mut sum = Vector::<D>::zeros();
    for facet in background.facets().filter(|&facet| background.is_boundary(facet)) {
        let covered = background.facet_measure(facet) - wet[facet.index()];
        sum += face_normal(background, facet) * covered;
    }
    sum += cut.interface().iter().map(|piece| piece.normal * piece.measure).sum::<Vector<D>>();
    relative(sum.norm(), cut.interface().iter().map(|piece| piece.measure).sum())
}

/// Integrates `Σ_a 2 r_a` over the fluid by quadrature of degree two on every part.
pub(super) fn quadratic_moment<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> f64 {
    let origin = Aabb::of_points(background.vertices()).low;
    let rule = SimplexRule::of_degree(D, 2);
    let mut inside = QuadratureRule::default();
    let moments = cut.all_parts().map(|part| {
        inside.points.clear();
        inside.weights.clear();
        cut.part_quadrature(background, part, rule, &mut inside);
        inside.integrate(|x| 2.0 * (x - origin).sum())
    });
    moments.sum()
}

fn divergence<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, moment: f64) -> f64 {
    let origin = Aabb::of_points(background.vertices()).low;
    let rule = SimplexRule::of_degree(D - 1, 2);
    let (mut linear, mut quadratic) = (0.0, 0.0);
    let mut face = QuadratureRule::default();
    let mut flux = |points: &[Point<D>], normal: Vector<D>| {
        face.points.clear();
        face.weights.clear();
        face.push_simplex(rule, points);
        linear += face.integrate(|x| (x - origin).dot(&normal));
        quadratic += face.integrate(|x| (x - origin).map(|r| r * r).dot(&normal));
    };
    for piece in cut.boundary() {
        flux(&piece.points[..D], face_normal(background, piece.facet));
    }
    for piece in cut.interface() {
        flux(&piece.points[..D], -piece.normal);
    }
    let error = |inside: f64, flux: f64| relative((inside - flux).abs(), inside);
    larger(error(D as f64 * cut.fluid_volume(), linear), error(moment, quadratic))
}

fn adjacency<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> f64 {
    // Unshared area, and area of interface on the facet, by part and local facet of its cell.
    let mut unshared = vec![[0.0; MAX_CELL_VERTICES]; cut.n_parts()];
    let mut aligned = unshared.clone();
    for part in cut.all_parts() {
        add_faces(background, cut, part, &mut unshared[part.index()]);
    }
    let shared = cut.part_faces().iter().flat_map(|face| face.parts.map(|part| (part, face.facet, face.measure)));
    let on_boundary = cut.boundary().iter().map(|piece| (piece.part, piece.facet, piece.measure));
    for (part, facet, measure) in shared.chain(on_boundary) {
        let facets = background.cell_to_facet(cut.part_cell(part));
        if let Some(local) = facets.iter().position(|&f| f == facet) {
            unshared[part.index()][local] -= measure;
        }
    }
    for piece in cut.interface() {
        let near = ON_FACE * background.simplex(piece.cell).diameter();
        for (local, &facet) in background.cell_to_facet(piece.cell).iter().enumerate() {
            let (normal, origin) = (face_normal(background, facet), background.vertex(background.facet(facet)[0]));
            if piece.points[..D].iter().all(|x| normal.dot(&(x - origin)).abs() <= near) {
                aligned[piece.part.index()][local] += piece.measure;
            }
        }
    }
    let mut largest = 0.0_f64;
    for part in cut.all_parts() {
        let (unshared, aligned) = (unshared[part.index()], aligned[part.index()]);
        for (local, &facet) in background.cell_to_facet(cut.part_cell(part)).iter().enumerate() {
            let outside = larger(0.0, larger(-unshared[local], unshared[local] - aligned[local]));
            largest = larger(largest, outside / background.facet_measure(facet));
        }
    }
    largest
}

/// Adds the area of a part on each face of its cell.
fn add_faces<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, part: PartId, on_face: &mut [f64]) {
    if cut.is_whole(part) {
        for (sum, &facet) in on_face.iter_mut().zip(background.cell_to_facet(cut.part_cell(part))) {
            *sum += background.facet_measure(facet);
        }
        return;
    }
    for piece in cut.part_pieces(part) {
        for (face, (label, _)) in piece.faces().enumerate() {
            if let FaceLabel::Cell(local) = label {
                let polygon: Vec<Point<D>> = piece.face_points(face).collect();
                on_face[usize::from(local)] += polygon_measure(&polygon);
            }
        }
    }
}

/// Returns the measure of a convex face, by a fan of simplices.
fn polygon_measure<const D: usize>(polygon: &[Point<D>]) -> f64 {
    let Some((&apex, rest)) = polygon.split_first() else { return 0.0 };
    let mut corners = [apex; MAX_CELL_VERTICES];
    rest.windows(D - 1)
        .map(|opposite| {
            corners[1..D].copy_from_slice(opposite);
            simplex_measure(&corners[..D])
        })
        .sum()
}

/// Returns the unit normal of a face of the background, out of its first cell.
fn face_normal<const D: usize>(background: &SimplexMesh<D>, facet: FacetId) -> Vector<D> {
    let points: Vec<Point<D>> = background.facet(facet).iter().map(|vertex| background.vertex(*vertex)).collect();
    facet_normal(&points)
}
