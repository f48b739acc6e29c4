//! The surfaces of bodies that do not deform.

use solver::{Setup, State};

use super::{Grid, in_space, simplex_type};

/// Displacement and velocity of the surfaces of all rigid bodies, free or of prescribed motion, at the end of the step.
pub fn rigid_grid<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut displacement, mut velocity, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (body, now)) in setup.bodies.iter().zip(&state.bodies).enumerate() {
        if body.elastic().is_some() {
            continue;
        }
        let first = grid.n_points() as u64;
        for x in now.positions(body.reference()) {
            grid.push_point(&x);
        }
        displacement.extend(now.displacement.iter().flat_map(in_space));
        velocity.extend(now.velocity.iter().flat_map(in_space));
        let boundary = body.boundary();
        for facet in boundary.facets() {
            grid.push_cell(simplex_type(D), boundary.facet(facet).iter().map(|v| first + u64::from(v.0)));
            ids.push(index as i64);
        }
    }
    grid.add_point_data("displacement", 3, displacement);
    grid.add_point_data("velocity", 3, velocity);
    grid.add_cell_ids("body", ids);
    grid
}
