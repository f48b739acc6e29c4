//! The fluid: uncut cells, and the fluid parts of cut cells.

use cutcell::{CutMesh, PartId};
use mesh::{CellId, Point, SimplexMesh, Vector};
use solver::FluidState;

use super::{Grid, in_space, ring, simplex_type};

/// Returns the grid of the fluid domain of a state with velocity, pressure and vorticity.
///
/// Cut cells are written as the convex pieces of their fluid parts, with the values of the dofs of the part. Uncut
/// cells share the points of common dofs; pieces have points of their own. The geometry is that of the step.
pub fn fluid_grid<const D: usize>(background: &SimplexMesh<D>, fluid: &FluidState<D>) -> Grid {
    let FluidState { cut, space, .. } = fluid;
    let mut grid = Grid::default();
    let (mut velocity, mut pressure) = (Vec::new(), Vec::new());
    let mut push = |grid: &mut Grid, x: &Point<D>, u: &Vector<D>, p: f64| {
        velocity.extend(in_space(u));
        pressure.push(p);
        grid.push_point(x)
    };
    // Points of dofs of uncut cells.
    let mut dof_to_point: Vec<Option<u64>> = vec![None; space.len()];
    let mut parts: Vec<PartId> = Vec::new();
    for part in cut.all_parts() {
        let (simplex, dofs) = (background.simplex(cut.part_cell(part)), space.dofs(part));
        if cut.is_whole(part) {
            let point = |&dof: &u32| {
                let (k, x) = (dof as usize, background.vertex(space.vertex(dof)));
                let number = dof_to_point[k];
                number.unwrap_or_else(|| push(&mut grid, &x, &fluid.velocity[k], fluid.pressure[k]))
            };
            let points: Vec<u64> = dofs.iter().map(point).collect();
            for (&dof, &number) in dofs.iter().zip(&points) {
                dof_to_point[dof as usize] = Some(number);
            }
            grid.push_cell(simplex_type(D + 1), points);
        }
        for piece in cut.part_pieces(part) {
            grid.push_piece(piece, |grid, x| {
                let (velocity, pressure) = fluid.at(part, &simplex.barycentric(x).unwrap_or_default());
                push(grid, x, &velocity, pressure)
            });
        }
        parts.resize(grid.n_cells(), part);
    }
    grid.add_point_data("velocity", 3, velocity);
    grid.add_point_data("pressure", 1, pressure);
    let vorticity = parts.iter().map(|part| curl(background, fluid, *part, cut.part_cell(*part)));
    if D == 2 {
        grid.add_cell_data("vorticity", 1, vorticity.map(|w| w[2]).collect());
    } else {
        grid.add_cell_data("vorticity", 3, vorticity.flatten().collect());
    }
    grid.add_cell_ids("part", parts.iter().map(|part| i64::from(part.0)).collect());
    grid.add_cell_ids("cut", parts.iter().map(|part| i64::from(!cut.is_whole(*part))).collect());
    grid
}

/// Returns the curl of the velocity on a part, which is constant. In 2D only the third component is not zero.
pub fn curl<const D: usize>(
    background: &SimplexMesh<D>,
    fluid: &FluidState<D>,
    part: PartId,
    cell: CellId,
) -> [f64; 3] {
    let Some(gradients) = background.simplex(cell).barycentric_gradients() else { return [0.0; 3] };
    let mut curl = [0.0; 3];
    for (&dof, gradient) in fluid.space.dofs(part).iter().zip(&gradients) {
        let (u, g) = (in_space(&fluid.velocity[dof as usize]), in_space(gradient));
        for (k, component) in curl.iter_mut().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            *component += g[i] * u[j] - g[j] * u[i];
        }
    }
    curl
}

/// Returns the polygons of the fluid in 2D, each with its part: the corners of uncut cells, and of the convex pieces of
/// cut cells.
pub fn fluid_polygons<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Vec<(PartId, Vec<Point<D>>)> {
    let mut polygons = Vec::new();
    for part in cut.all_parts() {
        if cut.is_whole(part) {
            polygons.push((part, background.simplex(cut.part_cell(part)).points().to_vec()));
        } else {
            polygons.extend(cut.part_pieces(part).map(|piece| (part, ring(piece))));
        }
    }
    polygons
}
