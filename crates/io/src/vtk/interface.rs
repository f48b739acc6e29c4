//! The fluid-structure interface: its pieces with the traction that crosses them.

use mesh::Vector;
use solver::{FluidState, StepReport};

use super::{Grid, in_space, simplex_type};

/// Tractions on the body, velocity jump and normal on the interface pieces of a step, on the geometry at its start;
/// tractions are zero before the first step.
pub fn interface_grid<const D: usize>(fluid: &FluidState<D>, report: Option<&StepReport<D>>) -> Grid {
    let mut grid = Grid::default();
    let (mut total, mut of_fluid, mut jump) = (Vec::new(), Vec::new(), Vec::new());
    let (mut normal, mut ids) = (Vec::new(), Vec::new());
    for (k, piece) in fluid.cut.interface().iter().enumerate() {
        let corners: [u64; 3] = std::array::from_fn(|c| if c < D { grid.push_point(&piece.points[c]) } else { 0 });
        grid.push_cell(simplex_type(D), corners[..D].iter().copied());
        let traction = report.and_then(|report| report.fluid.as_ref()?.tractions.get(k));
        let zero = Vector::zeros();
        total.extend(in_space(&traction.map_or(zero, |t| t.total())));
        of_fluid.extend(in_space(&traction.map_or(zero, |t| t.fluid)));
        jump.extend(in_space(&traction.map_or(zero, |t| t.jump)));
        normal.extend(in_space(&piece.normal));
        ids.push(i64::from(piece.body.0));
    }
    grid.add_cell_data("traction", 3, total);
    grid.add_cell_data("fluid_traction", 3, of_fluid);
    grid.add_cell_data("velocity_jump", 3, jump);
    grid.add_cell_data("normal", 3, normal);
    grid.add_cell_ids("body", ids);
    grid
}
