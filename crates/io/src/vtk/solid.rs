//! The bodies at their current positions.

use solid_svk::energy::CellStress;
use solver::{Setup, State};

use super::{Grid, in_space, simplex_type, tensor_in_space};

/// Displacement, velocity and stress of all elastic bodies, at the end of the step.
pub fn solid_grid<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Grid {
    let mut grid = Grid::default();
    let (mut displacement, mut velocity) = (Vec::new(), Vec::new());
    let (mut cauchy, mut von_mises, mut pressure, mut ids) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, (body, now)) in setup.bodies.iter().zip(&state.bodies).enumerate() {
        let Some(elastic) = body.elastic() else { continue };
        let first = grid.n_points() as u64;
        for x in now.positions(body.reference()) {
            grid.push_point(&x);
        }
        displacement.extend(now.displacement.iter().flat_map(in_space));
        velocity.extend(now.velocity.iter().flat_map(in_space));
        let mesh = elastic.solid.mesh();
        for cell in mesh.cells() {
            grid.push_cell(simplex_type(D + 1), mesh.cell(cell).iter().map(|v| first + u64::from(v.0)));
            let stress = CellStress::new(&elastic.solid, &elastic.form, cell, &now.displacement);
            cauchy.extend(tensor_in_space(&stress.cauchy, stress.out_of_plane));
            von_mises.push(stress.von_mises());
            pressure.push(stress.pressure());
            ids.push(index as i64);
        }
    }
    grid.add_point_data("displacement", 3, displacement);
    grid.add_point_data("velocity", 3, velocity);
    grid.add_cell_data("cauchy_stress", 9, cauchy);
    grid.add_cell_data("von_mises", 1, von_mises);
    grid.add_cell_data("pressure", 1, pressure);
    grid.add_cell_ids("body", ids);
    grid
}
