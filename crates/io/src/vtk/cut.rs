//! A cut mesh: its fluid parts, the region covered by bodies, and the interface between them.

use cutcell::{CellState, CutMesh, Polytope};
use mesh::{CellId, Point, SimplexMesh};
use vtkio::model::CellType;

use super::{Grid, in_space, simplex_type};

/// The fluid parts: uncut cells, and the convex pieces of cut ones (divided into tetrahedra in 3D).
///
/// Fields of cells: `part`, `cell` of the background, `cut` (1 in cut cells).
pub fn fluid_grid<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut parts, mut cells, mut is_cut) = (Vec::new(), Vec::new(), Vec::new());
    for part in cut.all_parts() {
        let cell = cut.part_cell(part);
        if cut.is_whole(part) {
            push_whole(&mut grid, background, cell);
        } else {
            cut.part_pieces(part).for_each(|piece| push_piece(&mut grid, piece));
        }
        parts.resize(grid.n_cells(), i64::from(part.0));
        cells.resize(grid.n_cells(), i64::from(cell.0));
        is_cut.resize(grid.n_cells(), i64::from(!cut.is_whole(part)));
    }
    grid.add_cell_ids("part", parts);
    grid.add_cell_ids("cell", cells);
    grid.add_cell_ids("cut", is_cut);
    grid
}

/// The region that the bodies cover: whole cells, and the convex pieces of cut ones (divided into tetrahedra in 3D).
///
/// Fields of cells: `cell` of the background, `cut` (1 in cut cells).
pub fn body_grid<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut cells, mut is_cut) = (Vec::new(), Vec::new());
    for cell in background.cells().filter(|&cell| cut.cell_state(cell) == CellState::Covered) {
        push_whole(&mut grid, background, cell);
        cells.push(i64::from(cell.0));
    }
    is_cut.resize(grid.n_cells(), 0);
    for (cell, piece) in cut.covered_pieces() {
        push_piece(&mut grid, piece);
        cells.resize(grid.n_cells(), i64::from(cell.0));
    }
    is_cut.resize(grid.n_cells(), 1);
    grid.add_cell_ids("cell", cells);
    grid.add_cell_ids("cut", is_cut);
    grid
}

/// The interface: its pieces.
///
/// Fields of cells: `body`, `facet` of its surface, fluid `part`, unit `normal` out of the body.
pub fn interface_grid<const D: usize>(cut: &CutMesh<D>) -> Grid {
    let mut grid = Grid::default();
    for piece in cut.interface() {
        push_simplex(&mut grid, &piece.points[..D]);
    }
    let ids = |id: fn(&cutcell::InterfacePiece<D>) -> u32| cut.interface().iter().map(|p| i64::from(id(p))).collect();
    grid.add_cell_ids("body", ids(|piece| piece.body.0));
    grid.add_cell_ids("facet", ids(|piece| piece.facet.0));
    grid.add_cell_ids("part", ids(|piece| piece.part.0));
    grid.add_cell_data("normal", 3, cut.interface().iter().flat_map(|piece| in_space(&piece.normal)).collect());
    grid
}

fn push_whole<const D: usize>(grid: &mut Grid, background: &SimplexMesh<D>, cell: CellId) {
    push_simplex(grid, background.simplex(cell).points());
}

fn push_simplex<const D: usize>(grid: &mut Grid, corners: &[Point<D>]) {
    let points: Vec<u64> = corners.iter().map(|x| grid.push_point(x)).collect();
    grid.push_cell(simplex_type(points.len()), points);
}

fn push_piece<const D: usize>(grid: &mut Grid, piece: Polytope<'_, D>) {
    if D == 2 {
        let points: Vec<u64> = ring(piece).iter().map(|x| grid.push_point(x)).collect();
        grid.push_cell(CellType::Polygon, points);
    } else {
        piece.for_each_simplex(|corners| push_simplex(grid, corners));
    }
}

/// Corners of a convex polygon, counter-clockwise.
pub(crate) fn ring<const D: usize>(piece: Polytope<'_, D>) -> Vec<Point<D>> {
    let n = piece.n_faces();
    let edges: Vec<(u32, u32)> = piece.faces().map(|(_, corners)| (corners[0], corners[1])).collect();
    let mut corners = Vec::with_capacity(n);
    let mut at = edges.first().map_or(0, |edge| edge.0);
    for _ in 0..n {
        corners.push(piece.points()[at as usize]);
        at = edges.iter().find(|edge| edge.0 == at).map_or(at, |edge| edge.1);
    }
    corners
}
