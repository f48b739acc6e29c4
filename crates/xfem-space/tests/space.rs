//! Dof counts, face jumps, boundary dofs and transfer on tiny meshes.

use cutcell::{CutMesh, OverlayOptions, PartId};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, CellId, Placed, Point, SimplexMesh, Vector, VertexId};
use xfem_space::{PartValues, Sources, XfemSpace, boundary_dofs, face_values, small_regions};

type P = Point<2>;

fn grid(n: usize) -> SimplexMesh<2> {
    structured_box::<2>([0.0, 0.0], [1.0, 1.0], [n, n]).expect("a box")
}

fn cut_by_rectangles(background: &SimplexMesh<2>, rectangles: &[[f64; 4]]) -> CutMesh<2> {
    let boundary = BoundaryMesh::<2>::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
    let positions: Vec<Vec<P>> = rectangles
        .iter()
        .map(|&[x0, y0, x1, y1]| vec![P::new(x0, y0), P::new(x1, y0), P::new(x1, y1), P::new(x0, y1)])
        .collect();
    let placed: Vec<_> = positions.iter().map(|x| Placed::new(&boundary, x)).collect();
    CutMesh::overlay(background, &placed, &OverlayOptions::new()).expect("rectangles")
}

fn n_dofs(background: &SimplexMesh<2>, rectangles: &[[f64; 4]]) -> usize {
    XfemSpace::new(background, &cut_by_rectangles(background, rectangles)).len()
}

#[test]
fn without_bodies_there_is_one_dof_per_vertex() {
    assert_eq!(n_dofs(&grid(2), &[]), 9);
    assert_eq!(n_dofs(&grid(5), &[]), 36);
}

#[test]
fn a_strip_through_the_mesh_doubles_the_dofs_of_the_cells_it_splits() {
    // Below the strip: 6 vertices of the lower row. Above: the same 6, and 3 on top.
    assert_eq!(n_dofs(&grid(2), &[[-0.5, 0.24, 1.5, 0.26]]), 15);
    // Two strips in the same row: the fluid between them has its own 6.
    assert_eq!(n_dofs(&grid(2), &[[-0.5, 0.14, 1.5, 0.16], [-0.5, 0.34, 1.5, 0.36]]), 21);
}

#[test]
fn without_the_film_between_two_bodies_the_cut_is_that_of_one_body() {
    // The film has the thickness 0.001 and fills at most 3/500 of a cell. In the second case the bodies cover the cells
    // at the bottom and on the right, and the film is the only fluid of the last cells.
    for [below, above, both] in [
        [[-0.5, 0.14, 1.5, 0.16], [-0.5, 0.161, 1.5, 0.3], [-0.5, 0.14, 1.5, 0.3]],
        [[-0.5, 0.14, 1.5, 0.66], [-0.5, 0.661, 1.5, 1.5], [-0.5, 0.14, 1.5, 1.5]],
    ] {
        let background = grid(2);
        let (cut, one) = (cut_by_rectangles(&background, &[below, above]), cut_by_rectangles(&background, &[both]));
        assert!(!small_regions(&background, &cut, 1e-3, |_| false).contains(&true));
        let is_film = small_regions(&background, &cut, 1e-2, |_| false);
        let of_film = cut.all_parts().find(|part| is_film[part.index()]);
        let kept_film = small_regions(&background, &cut, 1e-2, |part| Some(part) == of_film);
        assert!(!kept_film.contains(&true), "one part keeps its region");
        let n_film = cut.n_parts() - one.n_parts();
        assert_eq!(is_film.iter().filter(|is_film| **is_film).count(), n_film);
        let cut = cut.without_parts(&background, &is_film);
        let parts =
            |cut: &CutMesh<2>| -> Vec<Vec<_>> { background.cells().map(|cell| cut.parts(cell).collect()).collect() };
        assert_eq!(parts(&cut), parts(&one));
        for part in cut.all_parts() {
            assert_eq!(cut.part_cell(part), one.part_cell(part));
            let pieces: f64 = cut.part_pieces(part).map(|piece| piece.volume()).sum();
            assert!(cut.is_whole(part) || (pieces - cut.part_volume(part)).abs() < 1e-15, "{pieces}");
            assert!((cut.part_volume(part) - one.part_volume(part)).abs() < 1e-15);
        }
        let faces =
            |cut: &CutMesh<2>| -> Vec<_> { cut.part_faces().iter().map(|face| (face.facet, face.parts)).collect() };
        assert_eq!(faces(&cut), faces(&one));
        let wet =
            |cut: &CutMesh<2>| -> Vec<_> { cut.interface().iter().map(|piece| (piece.cell, piece.part)).collect() };
        assert_eq!(wet(&cut), wet(&one));
        let boundary = |cut: &CutMesh<2>| -> Vec<_> { cut.boundary().iter().map(|at| (at.facet, at.part)).collect() };
        assert_eq!(boundary(&cut), boundary(&one));
        let counts = |cut: &CutMesh<2>| (cut.report().max_parts, cut.report().n_slivers);
        assert_eq!(counts(&cut), counts(&one));
        assert!((cut.report().smallest_fraction - one.report().smallest_fraction).abs() < 1e-15);
        assert_eq!(cut.report().n_left_out, n_film);
    }
}

#[test]
fn a_film_that_is_open_to_other_fluid_is_no_small_region() {
    let background = grid(2);
    let cut = cut_by_rectangles(&background, &[[-0.5, 0.14, 1.5, 0.16], [-0.5, 0.161, 0.9, 0.3]]);
    assert!(!small_regions(&background, &cut, 1e-2, |_| false).contains(&true));
}

#[test]
fn a_strip_that_ends_inside_a_cell_doubles_only_what_it_separates() {
    // The strip ends in the triangle (0.5, 0), (1, 0.5), (0.5, 0.5). The two triangles to its left have two parts
    // each. Around the tip both parts meet in the vertices (0.5, 0) and (0.5, 0.5); only (0, 0) and (0, 0.5) are
    // doubled.
    let background = grid(2);
    let cut = cut_by_rectangles(&background, &[[-0.5, 0.24, 0.6, 0.26]]);
    let space = XfemSpace::new(&background, &cut);
    assert_eq!(space.len(), 11);
    let split: Vec<CellId> = background.cells().filter(|&c| cut.parts(c).len() == 2).collect();
    assert_eq!(split.len(), 2);
    for cell in split {
        let parts: Vec<PartId> = cut.parts(cell).collect();
        for (local, vertex) in background.cell(cell).iter().enumerate() {
            let is_shared = space.dofs(parts[0])[local] == space.dofs(parts[1])[local];
            assert_eq!(is_shared, background.vertex(*vertex)[0] == 0.5, "cell {cell}, vertex {vertex}");
        }
    }
}

#[test]
fn a_body_over_whole_cells_leaves_no_dofs_inside() {
    // Three by three vertices lie inside the body. Only the cells of the centre are all covered.
    assert_eq!(n_dofs(&grid(4), &[[0.2, 0.2, 0.8, 0.8]]), 24);
    // A body over everything leaves nothing.
    assert_eq!(n_dofs(&grid(4), &[[-0.2, -0.2, 1.2, 1.2]]), 0);
    // A body inside one cell changes nothing.
    assert_eq!(n_dofs(&grid(1), &[[0.6, 0.2, 0.7, 0.3]]), 4);
}

#[test]
fn jumps_vanish_on_linear_functions_and_shapes_sum_to_one() {
    let background = grid(4);
    let cut = cut_by_rectangles(&background, &[[0.13, 0.22, 0.61, 0.71]]);
    let space = XfemSpace::new(&background, &cut);
    let parts = PartValues::new(&background, &cut);
    let faces = face_values(&background, &cut, &space, &parts);
    let linear = |v: VertexId| 1.0 + 2.0 * background.vertex(v)[0] - 3.0 * background.vertex(v)[1];
    for face in &faces {
        let jump: f64 = face.dofs().iter().zip(face.jumps()).map(|(&k, j)| j * linear(space.vertex(k))).sum();
        assert!(jump.abs() < 1e-12);
        assert!(face.jumps().iter().any(|j| j.abs() > 1.0), "a hat function has a jump");
    }
    let (mut volume, mut of_moments, mut integral) = (0.0, 0.0, 0.0);
    for part in cut.all_parts() {
        let mut moments = [[0.0; 3]; 3];
        parts.for_each_point(&background, &cut, part, 2, |_, weight, shape| {
            assert!((shape[..3].iter().sum::<f64>() - 1.0).abs() < 1e-12);
            volume += weight;
            integral +=
                weight * space.dofs(part).iter().zip(shape).map(|(&k, n)| n * linear(space.vertex(k))).sum::<f64>();
            for (row, n_i) in moments.iter_mut().zip(shape) {
                row.iter_mut().zip(shape).for_each(|(entry, n_j)| *entry += weight * n_i * n_j);
            }
        });
        for (i, row) in moments.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((parts.moments(part).at(i, j) - entry).abs() < 1e-15, "moment of part {part:?}");
            }
        }
        of_moments += parts.moments(part).volume();
    }
    assert!((volume - cut.fluid_volume()).abs() < 1e-13);
    assert!((of_moments - cut.fluid_volume()).abs() < 1e-13);
    // The integral of 1 + 2 x - 3 y over the square without the rectangle.
    let rectangle = 0.48 * 0.49 * (1.0 + 2.0 * 0.37 - 3.0 * 0.465);
    assert!((integral - (0.5 - rectangle)).abs() < 1e-13, "{integral}");
}

#[test]
fn the_boundary_binds_only_dofs_that_touch_it() {
    // A plate on the bottom covers its vertices: no dof is bound there.
    let background = grid(4);
    let cut = cut_by_rectangles(&background, &[[0.0, 0.0, 1.0, 0.1]]);
    let space = XfemSpace::new(&background, &cut);
    let dofs = |name| boundary_dofs(&background, &cut, &space, background.tag(name).expect("a side"));
    assert_eq!(dofs("bottom").len(), 0);
    assert_eq!(dofs("top").len(), 5);
    // The left side is wet from y = 0.1 on: the cut cell at the bottom binds its vertex at y = 0 too.
    assert_eq!(dofs("left").len(), 5);
}

#[test]
fn transfer_keeps_values() {
    let background = grid(8);
    let old_cut = cut_by_rectangles(&background, &[[0.3, 0.3, 0.6, 0.6]]);
    let new_cut = cut_by_rectangles(&background, &[[0.33, 0.33, 0.63, 0.63]]);
    let (old_space, new_space) = (XfemSpace::new(&background, &old_cut), XfemSpace::new(&background, &new_cut));
    let linear = |x: &P| Vector::<2>::new(1.0 + x[0] - x[1], 2.0 * x[1]);
    let values: Vec<_> = old_space.vertices().iter().map(|&v| linear(&background.vertex(v))).collect();
    let moved = Sources::between(&background, &old_cut, &old_space, &new_cut, &new_space);
    for (dof, value) in moved.carry(&values).iter().enumerate() {
        assert_eq!(*value, linear(&background.vertex(new_space.vertex(dof as u32))));
    }
    let same = Sources::between(&background, &old_cut, &old_space, &old_cut, &old_space);
    assert_eq!(same.carry(&values), values);
    assert_eq!(same.n_uncovered(), 0);
}

#[test]
fn a_body_that_moves_far_uncovers_its_old_place() {
    let background = grid(10);
    let old_cut = cut_by_rectangles(&background, &[[0.12, 0.12, 0.48, 0.48]]);
    let new_cut = cut_by_rectangles(&background, &[[0.52, 0.52, 0.88, 0.88]]);
    let (old_space, new_space) = (XfemSpace::new(&background, &old_cut), XfemSpace::new(&background, &new_cut));
    let values = vec![Vector::<2>::new(1.0, 2.0); old_space.len()];
    let moved = Sources::between(&background, &old_cut, &old_space, &new_cut, &new_space);
    let carried = moved.carry(&values);
    // Vertices at 0.2, 0.3, 0.4 were in the body. Only those whose cells were all covered are uncovered.
    let uncovered: Vec<P> = (0..new_space.len())
        .filter(|&k| moved.earlier_dofs()[k].is_none())
        .map(|k| background.vertex(new_space.vertex(k as u32)))
        .collect();
    assert!(!uncovered.is_empty());
    assert_eq!(uncovered.len(), moved.n_uncovered());
    assert!(uncovered.iter().all(|x| (0.15..0.45).contains(&x[0]) && (0.15..0.45).contains(&x[1])), "{uncovered:?}");
    for (value, source) in carried.iter().zip(moved.earlier_dofs()) {
        assert_eq!(value[0], if source.is_none() { 0.0 } else { 1.0 });
    }
}

#[test]
fn a_dof_takes_the_value_of_the_side_it_overlaps_most() {
    // A strip through the lower row of cells, with -1 below it and +1 above it. It moves by less than its own height
    // and by more. The largest overlap of the fluid below it is then with the fluid that was below it, and likewise
    // above.
    let background = grid(2);
    let strip = |y: f64| cut_by_rectangles(&background, &[[-0.5, y, 1.5, y + 0.02]]);
    let side = |cut: &CutMesh<2>, y: f64, part: PartId| {
        let mut pieces = cut.part_pieces(part);
        if pieces.len() > 0 && pieces.all(|piece| piece.points().iter().all(|x| x[1] < y + 0.01)) { -1.0 } else { 1.0 }
    };
    let values = |cut: &CutMesh<2>, space: &XfemSpace<2>, y: f64| {
        let mut values = vec![Vector::<2>::new(1.0, 0.0); space.len()];
        for part in cut.all_parts() {
            for &dof in space.dofs(part) {
                values[dof as usize][0] = side(cut, y, part);
            }
        }
        values
    };
    let old_cut = strip(0.24);
    let old_space = XfemSpace::new(&background, &old_cut);
    let old_values = values(&old_cut, &old_space, 0.24);
    assert!(old_values.iter().any(|v| v[0] < 0.0) && old_values.iter().any(|v| v[0] > 0.0));
    for y in [0.25, 0.30, 0.20] {
        let cut = strip(y);
        let space = XfemSpace::new(&background, &cut);
        let moved = Sources::between(&background, &old_cut, &old_space, &cut, &space);
        assert_eq!(moved.n_uncovered(), 0, "every part overlaps an earlier one");
        assert_eq!(moved.carry(&old_values), values(&cut, &space, y), "strip at {y}");
    }
    // Four cells wide, so that volumes have to be summed over the class: at the vertex between a cell in which the
    // lower part was small and one in which it was large, the sum decides.
    let fine = grid(4);
    let wedge = |a: f64, b: f64| {
        let boundary = BoundaryMesh::<2>::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
        let x = vec![P::new(-0.1, a), P::new(1.1, b), P::new(1.1, b + 0.01), P::new(-0.1, a + 0.01)];
        CutMesh::overlay(&fine, &[Placed::new(&boundary, &x)], &OverlayOptions::new()).expect("a wedge")
    };
    let (old_cut, new_cut) = (wedge(0.3, 0.7), wedge(0.33, 0.73));
    let (old_space, new_space) = (XfemSpace::new(&fine, &old_cut), XfemSpace::new(&fine, &new_cut));
    let moved = Sources::between(&fine, &old_cut, &old_space, &new_cut, &new_space);
    for new_dof in 0..new_space.len() as u32 {
        // By brute force over all pairs of parts, from the lowest dof on.
        let mut best = (None, 0.0);
        for old_dof in 0..old_space.len() as u32 {
            let mut volume = 0.0;
            for part in new_cut.all_parts() {
                for old_part in old_cut.parts(new_cut.part_cell(part)) {
                    let pairs = new_space.dofs(part).iter().zip(old_space.dofs(old_part));
                    if pairs.clone().any(|(&a, &b)| (a, b) == (new_dof, old_dof)) {
                        volume += new_cut.overlap_volume(&fine, part, &old_cut, old_part);
                    }
                }
            }
            if volume > best.1 {
                best = (Some(old_dof), volume);
            }
        }
        assert_eq!(moved.earlier_dofs()[new_dof as usize], best.0);
    }
}
