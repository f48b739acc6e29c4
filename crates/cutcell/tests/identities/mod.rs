//! Identities of a cut that hold for any input, in 2D and 3D.

use cutcell::{CellState, CutMesh};
use mesh::{FacetId, Point, QuadratureRule, SimplexMesh, SimplexRule, Vector, equilateral_side, facet_normal};

/// Checks all identities; errors are relative to the size of the background.
///
/// # Panics
/// If an identity does not hold.
pub(crate) fn check_identities<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) {
    let size = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
    check_partition(background, cut, size);
    let area = size.powi(D as i32 - 1);
    let uncovered = cut.report().uncovered_measure;
    assert!(uncovered < 1e-11 * area, "uncovered {uncovered:e}");
    check_closure(background, cut, 1e-11 * area);
    check_divergence(background, cut, 1e-10 * (2.0 * size).powi(D as i32));
}

/// Checks that volumes of parts and covered pieces add up to that of the cell, up to the round-off of its coordinates.
fn check_partition<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, size: f64) {
    let mut volume = vec![0.0; background.n_cells()];
    for part in cut.all_parts() {
        volume[cut.part_cell(part).index()] += cut.part_volume(part);
    }
    for (cell, piece) in cut.covered_pieces() {
        volume[cell.index()] += piece.volume();
    }
    for cell in background.cells() {
        let exact = background.cell_volume(cell);
        let sum = volume[cell.index()];
        match cut.cell_state(cell) {
            CellState::Covered => assert_eq!(cut.parts(cell).len(), 0),
            CellState::Fluid => assert_eq!(cut.parts(cell).len(), 1),
            CellState::Cut => {}
        }
        if cut.cell_state(cell) != CellState::Covered {
            let round_off = 8.0 * f64::EPSILON * size * equilateral_side::<D>(exact).powi(D as i32 - 1);
            assert!((sum - exact).abs() <= 1e-12 * exact + round_off, "cell {cell}: {sum} is not {exact}");
        }
    }
}

/// Checks that every part is closed: faces shared with neighbours, interface and boundary have no gap.
fn check_closure<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, tolerance: f64) {
    let mut area = vec![Vector::<D>::zeros(); cut.n_parts()];
    for face in cut.part_faces() {
        let normal = face_normal(background, face.facet) * face.measure;
        area[face.parts[0].index()] += normal;
        area[face.parts[1].index()] -= normal;
    }
    for piece in cut.boundary() {
        area[piece.part.index()] += face_normal(background, piece.facet) * piece.measure;
    }
    for piece in cut.interface() {
        assert!(piece.measure > 0.0);
        assert_eq!(cut.part_cell(piece.part), piece.cell);
        area[piece.part.index()] -= piece.normal * piece.measure;
    }
    for part in cut.all_parts() {
        let gap = area[part.index()].norm();
        assert!(gap < tolerance, "part {part:?} in cell {} is open by {gap:e}", cut.part_cell(part));
    }
}

/// Checks the divergence theorem for x and for x |x|²/(D + 2), whose divergence is |x|².
fn check_divergence<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, tolerance: f64) {
    let rule = SimplexRule::of_degree(D, 2);
    let on_faces = SimplexRule::of_degree(D - 1, 3);
    let mut inside = QuadratureRule::default();
    for part in cut.all_parts() {
        cut.part_quadrature(background, part, rule, &mut inside);
    }
    assert!(inside.weights.iter().all(|&w| w > 0.0));
    let mut linear = -(D as f64) * cut.fluid_volume();
    let mut quadratic = -inside.integrate(|x| x.norm_squared());
    let mut flux = |points: &[Point<D>], normal: Vector<D>| {
        let mut face = QuadratureRule::default();
        face.push_simplex(on_faces, points);
        linear += face.integrate(|x| x.dot(&normal));
        quadratic += face.integrate(|x| x.norm_squared() * x.dot(&normal) / (D as f64 + 2.0));
    };
    for piece in cut.boundary() {
        flux(&piece.points[..D], face_normal(background, piece.facet));
    }
    for piece in cut.interface() {
        flux(&piece.points[..D], -piece.normal);
    }
    let size = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
    assert!(linear.abs() < tolerance, "divergence theorem, linear: {linear:e}");
    assert!(quadratic.abs() < tolerance * size * size, "divergence theorem, quadratic: {quadratic:e}");
}

/// Returns the unit normal of a face, out of its first cell.
fn face_normal<const D: usize>(background: &SimplexMesh<D>, facet: FacetId) -> Vector<D> {
    facet_normal(&background.facet_points(facet)[..D])
}
