//! The fluid-structure interface: its pieces with the traction of the fluid on the body.

use mesh::Vector;
use solver::interface_dg::InterfaceTraction;
use solver::{FluidState, StepReport};

use super::{Grid, in_space, simplex_type};

/// Returns the grid of the interface pieces of a step, on the geometry of the step, with tractions on the body,
/// velocity jump and normal out of the body. Tractions are zero before the first step.
pub fn interface_grid<const D: usize>(fluid: &FluidState<D>, report: Option<&StepReport<D>>) -> Grid {
    let mut grid = Grid::default();
    let pieces = fluid.cut.interface();
    for piece in pieces {
        let points: Vec<u64> = piece.points[..D].iter().map(|x| grid.push_point(x)).collect();
        grid.push_cell(simplex_type(D), points);
    }
    let tractions = report.and_then(|report| report.fluid.as_ref()).map(|fluid| &fluid.tractions);
    let of_pieces = |of: fn(&InterfaceTraction<D>) -> Vector<D>| {
        let vector = |k| tractions.and_then(|tractions| tractions.get(k)).map_or(Vector::zeros(), of);
        (0..pieces.len()).flat_map(|k| in_space(&vector(k))).collect()
    };
    grid.add_cell_data("traction", 3, of_pieces(|traction| traction.total()));
    grid.add_cell_data("fluid_traction", 3, of_pieces(|traction| traction.fluid));
    grid.add_cell_data("velocity_jump", 3, of_pieces(|traction| traction.jump));
    grid.add_cell_data("normal", 3, pieces.iter().flat_map(|piece| in_space(&piece.normal)).collect());
    grid.add_cell_ids("body", pieces.iter().map(|piece| i64::from(piece.body.0)).collect());
    grid
}
