//! A cut mesh: its fluid parts, the region covered by bodies, and the interface between them.

use cutcell::{CellState, CutMesh};
use mesh::{Point, SimplexMesh};

use super::{Grid, in_space, simplex_type};

/// Returns the grid of the fluid parts: uncut cells, and the convex pieces of cut cells (tetrahedra in 3D).
///
/// Fields of cells: `part`, `cell` of the background, `cut` (1 in cut cells).
pub fn fluid_grid<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut parts, mut cells, mut is_cut) = (Vec::new(), Vec::new(), Vec::new());
    for part in cut.all_parts() {
        let cell = cut.part_cell(part);
        if cut.is_whole(part) {
            push_simplex(&mut grid, background.simplex(cell).points());
        }
        cut.part_pieces(part).for_each(|piece| grid.push_piece(piece, Grid::push_point));
        parts.resize(grid.n_cells(), i64::from(part.0));
        cells.resize(grid.n_cells(), i64::from(cell.0));
        is_cut.resize(grid.n_cells(), i64::from(!cut.is_whole(part)));
    }
    grid.add_cell_ids("part", parts);
    grid.add_cell_ids("cell", cells);
    grid.add_cell_ids("cut", is_cut);
    grid
}

/// Returns the grid of the region that the bodies cover: whole cells, and convex pieces of cut cells (3D: tetrahedra).
///
/// Fields of cells: `cell` of the background, `cut` (1 in cut cells).
pub fn body_grid<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut cells, mut is_cut) = (Vec::new(), Vec::new());
    for cell in background.cells().filter(|&cell| cut.cell_state(cell) == CellState::Covered) {
        push_simplex(&mut grid, background.simplex(cell).points());
        cells.push(i64::from(cell.0));
    }
    is_cut.resize(grid.n_cells(), 0);
    for (cell, piece) in cut.covered_pieces() {
        grid.push_piece(piece, Grid::push_point);
        cells.resize(grid.n_cells(), i64::from(cell.0));
    }
    is_cut.resize(grid.n_cells(), 1);
    grid.add_cell_ids("cell", cells);
    grid.add_cell_ids("cut", is_cut);
    grid
}

/// Returns the grid of the interface, with one cell per piece.
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

fn push_simplex<const D: usize>(grid: &mut Grid, corners: &[Point<D>]) {
    let points: Vec<u64> = corners.iter().map(|x| grid.push_point(x)).collect();
    grid.push_cell(simplex_type(points.len()), points);
}
