//! Films that end at edges of bodies: plates with flush edges, edges at lines of the mesh, and round plates in space.

use std::f64::consts::{PI, TAU};

use crate::fixture::*;
use solver::mesh::generate::structured_box;
use solver::mesh::{Point, SimplexMesh, Vector, VertexId};
use solver::{FluidBoundary, Setup};

/// Returns fluid with films in cells of size one. Fluid may leave through all sides but the lowest one, which is a wall
/// if `has_floor`.
fn open_box<const D: usize>(extents: [usize; D], has_floor: bool) -> Setup<D> {
    let background = structured_box::<D>([0.0; D], extents.map(|n| n as f64), extents).expect("a box");
    let mut setup = with_films(background);
    for side in &["left", "right", "bottom", "top", "front", "back"][..2 * D] {
        let is_floor = has_floor && *side == "bottom";
        on_sides(&mut setup, &[side], || if is_floor { FluidBoundary::NoSlip } else { open() });
    }
    setup
}

/// Adds a body that moves upwards with a velocity.
fn add<const D: usize>(setup: &mut Setup<D>, body: &SimplexMesh<D>, upwards: f64) {
    let mut velocity = Vector::zeros();
    velocity[D - 1] = upwards;
    setup.bodies.push(prescribed(body, |x, _| *x, move |_, _| velocity));
}

/// Returns a plate of ten cells that begins at a distance from the left side, with its lower and upper side at heights.
fn plate(begins: f64, heights: [f64; 2]) -> SimplexMesh<2> {
    structured_box([begins, heights[0]], [begins + 10.0, heights[1]], [1, 1]).expect("a plate")
}

/// Returns the force on a plate over a wall, over that of Reynolds' equation with the resistance of the open fluid. The
/// latter was computed on fine cells (`cargo xtask verify films`).
fn over_wall(gap: f64, begins: f64) -> f64 {
    let mut setup = open_box([18, 8], true);
    add(&mut setup, &plate(begins, [gap, gap + 2.0]), -1.0);
    let ratio = gap / 10.0;
    force(&setup)[1] * ratio.powi(3) / (1.0 + 3.8 * ratio + 10.0 * ratio * ratio)
}

/// Edges at lines of the mesh and beside them, where corners of cells with fluid are as small as round-off.
#[test]
fn edges_at_lines_of_the_mesh_are_ends_of_films() {
    for gap in [0.1, 0.5, 1.0] {
        for off in [0.0, 1e-12, -1e-12, 1e-6, -1e-6, -1e-5, -1e-4, 0.3] {
            // With the corner as a part of the film the force is 0.71.
            let found = over_wall(gap, 4.0 + off);
            assert!((found - 1.0).abs() < 0.08, "gap {gap}, {off:e} from a line: {found}");
        }
    }
}

/// Two equal plates that approach each other. The open fluid behind their edges resists as that on one side of a slit,
/// `ε = 4/(3π) δ`: the force is `1 + 6 ε/L + O(δ²/L²)` of that of Reynolds' equation.
#[test]
fn films_end_where_both_plates_end() {
    for (middle, bound) in [(4.5, 0.09), (4.6, 0.09), (5.0, 0.13)] {
        for gap in [0.02, 0.1, 0.3] {
            for begins in [5.05, 5.35, 5.65] {
                let mut setup = open_box([20, 10], false);
                add(&mut setup, &plate(begins, [middle - 0.5 * gap - 2.0, middle - 0.5 * gap]), 0.5);
                add(&mut setup, &plate(begins, [middle + 0.5 * gap, middle + 0.5 * gap + 2.0]), -0.5);
                let ratio = gap / 10.0;
                // Without edges of both plates the force is 0.4 to 0.6 with a line of the mesh outside of the film.
                let found = force(&setup)[1] * ratio.powi(3) / (1.0 + 8.0 / PI * ratio);
                assert!((found - 1.0).abs() < bound, "middle {middle}, gap {gap}, {begins}: {found}");
            }
        }
    }
}

/// A plate over a block that begins behind the edge of the plate, above a wall that is close enough for a film.
/// The film ends where the block begins.
#[test]
fn films_end_where_the_surface_is_another_one() {
    for gap in [0.02, 0.1] {
        for begins in [5.05, 5.35, 5.65] {
            let mut setup = open_box([24, 10], true);
            let starts = begins + 0.2 * gap;
            add(&mut setup, &structured_box([starts, -1.0], [begins + 13.0, 1.5], [1, 1]).expect("a block"), 0.0);
            add(&mut setup, &plate(begins, [1.5 + gap, 3.5 + gap]), -1.0);
            let length = 10.0 - 0.2 * gap;
            // With a film that continues to the wall the force is 0.65 to 0.81.
            let found = force(&setup)[1] * (gap / length).powi(3) / (1.0 + 3.2 * gap / length);
            assert!((found - 1.0).abs() < 0.08, "gap {gap}, {begins}: {found}");
        }
    }
}

/// Returns a prism over a regular polygon with a circumradius, turned by an angle.
fn prism(n: usize, centre: [f64; 2], radius: f64, turned_by: f64, heights: [f64; 2]) -> SimplexMesh<3> {
    let mut vertices: Vec<_> = heights.iter().map(|z| Point::from([centre[0], centre[1], *z])).collect();
    for k in 0..n {
        let (sine, cosine) = (turned_by + TAU * k as f64 / n as f64).sin_cos();
        vertices
            .extend(heights.iter().map(|z| Point::from([centre[0] + radius * cosine, centre[1] + radius * sine, *z])));
    }
    let cells = (0..n).flat_map(|k| {
        let (a, b) = (2 + 2 * k, 2 + 2 * ((k + 1) % n));
        [0, a, b, b + 1, 0, a, b + 1, a + 1, 0, a + 1, b + 1, 1]
    });
    SimplexMesh::new(vertices, cells.map(VertexId::new).collect()).expect("a prism")
}

/// Plates over a wall whose edges are oblique to the cells. Reynolds' equation has `3π/2 μ V R⁴/δ³` for a round plate
/// and `0.4217 μ V L⁴/δ³` for a square one; the open fluid adds 2.52 and 4.5 times the gap over the radius and the
/// length.
#[test]
fn films_end_at_oblique_edges() {
    let gap = 0.1;
    for (n, radius, centre, bound) in
        [(24, 3.0, [6.0, 6.0], 0.1), (24, 3.0, [6.13, 6.31], 0.1), (4, 4.0, [6.0, 6.0], 0.2), (4, 4.0, [6.5, 6.5], 0.2)]
    {
        let mut setup = open_box([12, 12, 5], true);
        add(&mut setup, &prism(n, centre, radius, 0.3 * TAU / n as f64, [gap, gap + 2.0]), -1.0);
        let angle = TAU / n as f64;
        let exact = if n == 4 {
            0.4217 * (2.0_f64.sqrt() * radius).powi(4) * (1.0 + 4.5 * gap / (2.0_f64.sqrt() * radius))
        } else {
            // The area of the polygon is less than that of the circle.
            1.5 * PI * radius.powi(4) * (angle.sin() / angle).powi(2) * (1.0 + 2.52 * gap / radius)
        };
        // With the ends of the film in the last cells before the edge: 0.2 to 0.3 for the round plate.
        let found = force(&setup)[2] * gap.powi(3) / exact;
        assert!((found - 1.0).abs() < bound, "{n} sides at {centre:?}: {found}");
    }
}
