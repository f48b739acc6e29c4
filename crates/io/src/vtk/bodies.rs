//! The bodies at their positions at the end of a step.

use solver::{Setup, State};

use super::{Grid, in_space, simplex_type};

/// The part of bodies that a grid shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The cells of bodies that deform, with their stress.
    Cells,
    /// The surfaces of all other bodies.
    Surfaces,
}

/// Returns the grid of bodies with displacement and velocity of their vertices, and stress of their cells; `None` if
/// there is no such body.
pub fn bodies_grid<const D: usize>(setup: &Setup<D>, state: &State<D>, shown: Shown) -> Option<Grid> {
    let mut grid = Grid::default();
    let (mut displacement, mut velocity, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    let (mut cauchy, mut principal, mut von_mises, mut pressure) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, (body, now)) in setup.bodies.iter().zip(&state.bodies).enumerate() {
        let deformable = body.cells(now);
        if deformable.is_some() != (shown == Shown::Cells) {
            continue;
        }
        let first = grid.n_points() as u64;
        for x in now.positions(body.reference()) {
            grid.push_point(&x);
        }
        displacement.extend(now.displacement().iter().flat_map(in_space));
        velocity.extend(now.velocity().iter().flat_map(in_space));
        let before = grid.n_cells();
        if let Some(output) = deformable {
            for (cell, stress) in output.cells().zip(&output.stress) {
                grid.push_cell(simplex_type(D + 1), cell.iter().map(|v| first + u64::from(v.0)));
                cauchy.extend(stress.spatial());
                principal.extend(stress.principal());
                von_mises.push(stress.von_mises());
                pressure.push(stress.pressure());
            }
        } else {
            let boundary = body.surface();
            for facet in boundary.facets() {
                grid.push_cell(simplex_type(D), boundary.facet(facet).iter().map(|v| first + u64::from(v.0)));
            }
        }
        ids.resize(ids.len() + grid.n_cells() - before, index as i64);
    }
    if ids.is_empty() {
        return None;
    }
    grid.add_point_data("displacement", 3, displacement);
    grid.add_point_data("velocity", 3, velocity);
    if shown == Shown::Cells {
        grid.add_cell_data("cauchy_stress", 9, cauchy);
        grid.add_cell_data("principal_stress", 3, principal);
        grid.add_cell_data("von_mises", 1, von_mises);
        grid.add_cell_data("pressure", 1, pressure);
    }
    grid.add_cell_ids("body", ids);
    Some(grid)
}
